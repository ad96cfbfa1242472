#!/usr/bin/python3
"""Checks `derive`: values and u of single targets are those of displacement.csv, and mistakes are named with their column."""
import csv
import subprocess

from runs import insist, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-1xyz", 10)


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)


done = run("measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "-o", work / "out", "--quiet")
insist(done.returncode == 0, done.stderr)
before = {path.name: path.read_bytes() for path in (work / "out").iterdir()}


def derived(*words):
    done = run("derive", work / "out", *words)
    insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
    with open(work / "out/derived.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


# One target alone: the values and the u of displacement.csv, to its six decimals.
rows = derived("--channel", "x = mid.dx", "--channel", "y = mid.dy", "--channel", "twice = 2 * y", "--channel", "r=mid.rotation")
with open(work / "out/displacement.csv", encoding="utf-8") as file:
    samples = list(csv.DictReader(file))
insist(len(rows) == len(samples) == 10, f"{len(rows)} rows")
for row, sample in zip(rows, samples):
    insist(row["frame"] == sample["frame"] and row["time_s"] == sample["time_s"], f"another frame: {row}")
    for column, expected in [("x_mm", "dx_mm"), ("y_mm", "dy_mm"), ("u_x_mm", "u_dx_mm"), ("u_y_mm", "u_dy_mm")]:
        insist(abs(float(row[column]) - float(sample[expected])) <= 0.51e-6, f"{column}: {row} {sample}")
    insist(row["y_status"] == sample["status"], f"another status: {row}")
    insist(abs(float(row["u_twice_mm"]) - 2 * float(row["u_y_mm"])) < 1e-9, f"u of a double: {row}")
    insist(abs(float(row["r_mrad"])) < 5 * float(row["u_r_mrad"]) + 1e-12, f"the print does not turn: {row}")
# The run's own files are unchanged.
for name, content in before.items():
    insist((work / "out" / name).read_bytes() == content, f"{name} has changed")

for words, exit_code, text in [
    (("--channel", "s = mid.dz"), 2, "--channel 's = mid.dz', column 9: use dx, dy or rotation"),
    (("--channel", "s = top.dy"), 2, "use one of mid"),
    (("--channel", "s = mid.dy * mid.dy"), 2, "not linear"),
    (("--channel", "a = mid.dy", "--channel", "a = mid.dx"), 2, "already exists"),
    ((), 2, "--channel"),
    (("--channel", "y = mid.dy", "--rest", "0:1"), 2, "repeat here the options of `solve`"),
    (("--channel", "y = mid.dy", "-o", work / "no/such/folder.csv"), 6, "-o"),
]:
    done = run("derive", work / "out", *words)
    insist(done.returncode == exit_code, f"exit {done.returncode}, not {exit_code}: {words} {done.stderr}")
    insist(text in done.stderr and done.stderr.count("error: ") == 1, f"{words}: {done.stderr}")

# A method that does not know the errors that targets share.
done = run("solve", work / "out", "--method", "two-stage", "-o", work / "two-stage", "--quiet")
done = run("derive", work / "two-stage", "--channel", "y = mid.dy")
insist(done.returncode == 2, f"exit {done.returncode}: {done.stderr}")
