#!/usr/bin/python3
"""Checks `compare` with a simulated LVDT: its clock, unit and sign are found or applied, files appear as a whole, mistakes are named."""
import csv
import json
import math
import random
import subprocess

from runs import insist, start

program, work, _ = start()
OFFSET_S, RATE_HZ, NOISE_MM, FRAMES = 0.4372, 100, 0.002, 60
KNOTS = [(0, 0), (1, 0.6), (2, -0.5), (3, 0.9), (4, -0.8), (5, 0.3), (6, 0)]


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)


def must(*words):
    done = run(*words)
    insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
    return done


must("simulate", "small-1xyz", "--frames", FRAMES, "--markers-only", "--set", f"marker.mid.dy.knots={[list(k) for k in KNOTS]}",
     "-o", work / "run")
must("measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "-o", work / "out", "--quiet")
before = {path.name: path.read_bytes() for path in (work / "out").iterdir() if path.name != "report.html"}
with open(work / "run/truth.csv", encoding="utf-8") as file:
    truth = [(float(row["time_s"]), float(row["dy_mm"])) for row in csv.DictReader(file)]


def movement(t):
    """Returns the true movement in mm, linear between the frames."""
    if t <= truth[0][0]:
        return truth[0][1]
    for (t0, y0), (t1, y1) in zip(truth, truth[1:]):
        if t <= t1:
            return y0 + (y1 - y0) * (t - t0) / (t1 - t0)
    return truth[-1][1]


# An LVDT in um with the opposite sign, a decimal comma, and a clock that shows OFFSET_S more.
rng = random.Random(1)
lines = ["# logger", "t;load;defl"]
for n in range(-2 * RATE_HZ, 8 * RATE_HZ):
    t = n / RATE_HZ
    value = -1000 * (movement(t) + 3.0 + rng.gauss(0, NOISE_MM))
    lines.append(f"{t + OFFSET_S:.4f};1;{value:.2f}".replace(".", ","))
(work / "lvdt.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
options = ("--time-column", "t", "--column", "defl", "--unit", "um", "--sign", -1, "--channel", "mid.dy")
done = must("compare", work / "out", work / "lvdt.csv", *options)
insist("time offset" in done.stdout and "coverage of U" in done.stdout, done.stdout)
found = json.loads((work / "out/comparison/comparison.json").read_text(encoding="utf-8"))
offset = found["offset_s"]
# Four u, and the linear interpolation of the truth between frames, which moves knots by less than 1 ms.
insist(abs(offset["value"] - OFFSET_S) < 4 * offset["u"] + 0.001, f"offset: {offset}")
insist(abs(found["slope"]["value"] - 1) < 0.01, f"slope: {found['slope']}")
insist(abs(found["bias"]["value"] + 3.0) < 0.02, f"bias: {found['bias']}")
with open(work / "out/comparison/comparison.csv", encoding="utf-8") as file:
    rows = list(csv.DictReader(file))
insist(len(rows) == found["rows"] == FRAMES, f"{len(rows)} rows")
for row in rows:
    gap = float(row["moiregauge"]) - float(row["reference"]) - float(row["difference"])
    insist(abs(gap) < 1e-8, f"{row}")
    insist((abs(float(row["difference"])) <= 2 * float(row["u"])) == (row["in_U"] == "1"), f"{row}")
rms = math.sqrt(sum(float(row["difference"]) ** 2 for row in rows) / len(rows))
insist(abs(rms - found["rms_difference"]) < 1e-6, f"rms {rms}")
files = sorted(path.name for path in (work / "out/comparison").iterdir())
insist(files == sorted(["comparison.csv", "comparison.json"] + [f"{name}.{kind}" for name in ("series", "difference", "bland-altman")
                                                              for kind in ("svg", "png")]), f"{files}")
for name, content in before.items():
    insist((work / "out" / name).read_bytes() == content, f"{name} has changed")
# The same command gives the same bytes, in place of the earlier files.
first = {path.name: path.read_bytes() for path in (work / "out/comparison").iterdir()}
must("compare", work / "out", work / "lvdt.csv", *options, "--quiet")
insist(first == {path.name: path.read_bytes() for path in (work / "out/comparison").iterdir()}, "other bytes")

(work / "still.csv").write_text("".join(f"{n / 10},5\n" for n in range(60)), encoding="utf-8")
(work / "short.csv").write_text("".join(f"{n / 10},{n * n}\n" for n in range(9)), encoding="utf-8")
(work / "foreign").mkdir()
(work / "foreign/thesis.docx").write_text("precious", encoding="utf-8")
lvdt = (work / "lvdt.csv", "--time-column", "t", "--column", "defl", "--channel", "mid.dy")
for words, exit_code, text in [
    ((work / "lvdt.csv", *options[:6], "--channel", "mid.dy"), 3, "--sign -1"),
    ((work / "still.csv", "--channel", "mid.dy"), 3, "no common movement"),
    ((work / "short.csv", "--channel", "mid.dy"), 3, "20 are needed"),
    ((*lvdt, "--sign", -1, "--offset", 500), 3, "in common"),
    ((*lvdt, "--unit", "parsec"), 2, "use mm, cm, m, um or in"),
    ((work / "lvdt.csv", "--channel", "mid.dy"), 3, "no common movement"),
    ((*lvdt[:5], "--channel", "mid.dz"), 2, "use dx, dy or rotation"),
    ((*lvdt[:5], "--channel", "mid.rotation", "--unit", "mm"), 2, "--scale"),
    ((*lvdt, "--sign", -1, "-o", work / "foreign"), 2, "-o"),
]:
    done = run("compare", work / "out", *words)
    insist(done.returncode == exit_code, f"exit {done.returncode}, not {exit_code}: {words} {done.stderr}")
    insist(text in done.stderr and done.stderr.count("error: ") == 1, f"{words}: {done.stderr}")
    insist(first == {path.name: path.read_bytes() for path in (work / "out/comparison").iterdir()}, f"changed: {words}")
