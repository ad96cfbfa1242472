#!/usr/bin/python3
"""Checks `derive --modes`: the shape of three targets on one vibration, in modes.csv, modes.json and the universal file."""
import cmath
import csv
import json
import math
import pathlib
import subprocess
import sys

from runs import insist, start

sys.path.insert(0, str(pathlib.Path(__file__).parent / "export"))
import universal_file

program, work, _ = start()
FREQUENCY_HZ, FRAMES = 1.3, 48
TARGETS = {"mid": (0.4, 30.0), "W": (0.25, 75.0), "E": (0.1, -120.0)}  # amplitude in mm, phase in deg


def run(*words, code=0):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    insist(done.returncode == code, f"exit {done.returncode}: {words}\n{done.stderr}")
    return done


settings = ["--set", "marker.NE.dy.scale=0"]
for name, (amplitude, phase) in TARGETS.items():
    for key, value in [("amplitude", amplitude), ("frequency_hz", FREQUENCY_HZ), ("phase_deg", phase), ("scale", 0)]:
        settings += ["--set", f"marker.{name}.dy.{key}={value}"]
run("simulate", "small-six-slip", "--frames", FRAMES, "--markers-only", "-o", work / "run", *settings)
run("measure", work / "run/frames", "--site", work / "run/site.toml", "--targets", "mid,W,E", "--fps", 10, "-o", work / "out", "--quiet")
done = run("derive", work / "out", "--modes")
insist(done.stdout.startswith("mode 1: 1.") and "largest in mid.dy" in done.stdout, done.stdout)
insist(not (work / "out/derived.csv").exists(), "a table without channels")

modes = json.loads((work / "out/modes.json").read_text())["modes"]
insist(len(modes) == 1 and modes[0]["reference"] == {"target": "mid", "axis": "y"}, f"{modes}")
insist(abs(modes[0]["frequency_hz"] - FREQUENCY_HZ) < 4 * modes[0]["u"]["frequency_hz"], f"{modes[0]}")
shape = {(entry["target"], entry["axis"]): entry for entry in modes[0]["shape"]}
insist(len(shape) == 6, f"{list(shape)}")
for name, (amplitude, phase) in TARGETS.items():
    entry, u = shape[name, "y"], shape[name, "y"]["u"]
    expected = amplitude / TARGETS["mid"][0]
    turn = math.remainder(entry["phase_deg"] - (phase - TARGETS["mid"][1]), 360)
    # Four u: once in 16 000. The reference has no u.
    insist(abs(entry["ratio"] - expected) <= 4 * u["ratio"] + 1e-12, f"{name}: {entry}, not {expected}")
    insist(abs(turn) <= 4 * u["phase_deg"] + 1e-9, f"{name}: {entry}")
    insist(u["ratio"] < 0.02, f"u of {name}: {u}")
    insist(shape[name, "x"]["ratio"] < 5 * shape[name, "x"]["u"]["ratio"], f"{name} moves along x: {shape[name, 'x']}")
with open(work / "out/modes.csv", encoding="utf-8") as file:
    table = list(csv.DictReader(file))
insist([(row["target"], row["axis"]) for row in table] == list(shape), f"{table}")
for row in table:
    insist(abs(float(row["ratio"]) - shape[row["target"], row["axis"]]["ratio"]) < 1e-8, f"{row}")

# The universal file is read by the columns of its specification.
sets = universal_file.datasets((work / "out/modes.uff").read_text())
insist([number for number, _ in sets] == [164, 15] + 6 * [58], f"{[number for number, _ in sets]}")
names = {"mid": None, "W": None, "E": None}
for number, lines in sets[2:]:
    function = universal_file.function(lines)
    name, axis = function["ids"][0].split(":")[0].split(" ")
    insist(function["type"] == 12 and function["precision"] == 6 and function["direction"] == "xy".index(axis[1]) + 1, f"{function}")
    insist(function["abscissa"]["kind"] == 18 and function["ordinate"]["unit"] == "mm", f"{function}")
    entry = shape[name, axis[1]]
    expected = modes[0]["amplitude_mm"] * cmath.rect(entry["ratio"], math.radians(entry["phase_deg"]))
    insist(abs(function["y"][0] - expected) < 1e-9, f"{name} {axis}: {function['y']}, not {expected}")
    insist(abs(function["t"][0] - modes[0]["frequency_hz"]) < 1e-5, f"{function['t']}")

# With channels, both are written. Without a peak there is no shape, and no universal file of other modes stays.
run("derive", work / "out", "--modes", "--channel", "d = mid.dy - W.dy", "-o", work / "d.csv")
insist((work / "d.csv").exists() and (work / "modes.uff").exists(), "files next to the table")
run("measure", work / "run/frames", "--site", work / "run/site.toml", "--targets", "mid,W,E", "--fps", 10, "--frames", "0:12", "-o", work / "short", "--quiet")
done = run("derive", work / "short", "--modes")
insist("no mode shape" in done.stderr and not (work / "short/modes.uff").exists(), done.stderr)

# Without --targets, W and E are references. Both move, and the exclusion of one does not make the rest right.
done = run("measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "--frames", "0:12", "-o", work / "two-move", code=4)
insist("moves, and without it another one still seems to. Remedy: fasten the references" in done.stdout + done.stderr, done.stderr)

run("solve", work / "out", "--method", "two-stage", "-o", work / "two-stage", "--quiet")
done = run("derive", work / "two-stage", "--modes", code=2)
insist("measure with --method precise" in done.stderr, done.stderr)
