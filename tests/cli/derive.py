#!/usr/bin/python3
"""Checks `derive`: values and u of single targets are those of displacement.csv, and mistakes are named with their column."""
import csv
import json
import re
import subprocess

from runs import insist, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-1xyz", 24)


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)


done = run("measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "-o", work / "out", "--quiet")
insist(done.returncode == 0, done.stderr)
before = {path.name: path.read_bytes() for path in (work / "out").iterdir() if path.name != "report.html"}


def derived(*words):
    done = run("derive", work / "out", *words)
    insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
    with open(work / "out/derived.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


# One target alone: the values and the u of displacement.csv, to its six decimals.
rows = derived("--channel", "x = mid.dx", "--channel", "y = mid.dy", "--channel", "twice = 2 * y", "--channel", "r=mid.rotation")
with open(work / "out/displacement.csv", encoding="utf-8") as file:
    samples = list(csv.DictReader(file))
insist(len(rows) == len(samples) == 24, f"{len(rows)} rows")
for row, sample in zip(rows, samples):
    insist(row["frame"] == sample["frame"] and row["time_s"] == sample["time_s"], f"another frame: {row}")
    for column, expected in [("x_mm", "dx_mm"), ("y_mm", "dy_mm"), ("u_x_mm", "u_dx_mm"), ("u_y_mm", "u_dy_mm")]:
        insist(abs(float(row[column]) - float(sample[expected])) <= 0.51e-6, f"{column}: {row} {sample}")
    insist(row["y_status"] == sample["status"], f"another status: {row}")
    insist(abs(float(row["u_twice_mm"]) - 2 * float(row["u_y_mm"])) < 1e-9, f"u of a double: {row}")
    insist(abs(float(row["r_mrad"])) < 5 * float(row["u_r_mrad"]) + 1e-12, f"the print does not turn: {row}")
# The run's own files are unchanged, except the report, which shows the channels (report/channels.py).
for name, content in before.items():
    insist((work / "out" / name).read_bytes() == content, f"{name} has changed")

# Only results in the run's folder are shown in its report. A folder without a report gets none.
report = (work / "out/report.html").read_bytes()
insist(b'id="derived"' in report, "the report does not show the channels")
done = run("derive", work / "out", "--channel", "y = mid.dy", "-o", work / "elsewhere.csv")
insist(done.returncode == 0 and "shown in" not in done.stdout, f"{done.stdout}{done.stderr}")
insist((work / "out/report.html").read_bytes() == report, "the report shows results of another place")
(work / "out/report.html").unlink()
done = run("derive", work / "out", "--channel", "y = mid.dy")
insist(done.returncode == 0 and "note: the report does not show" in done.stderr and "solve" in done.stderr, f"{done.stderr}")
insist(not (work / "out/report.html").exists(), "a report out of nothing")
(work / "out/report.html").write_text("<html></html>")
done = run("derive", work / "out", "--channel", "y = mid.dy")
insist(done.returncode == 0 and "is not a report of moiregauge" in done.stderr, f"{done.stderr}")
insist((work / "out/report.html").read_text() == "<html></html>", "another file was replaced")
(work / "out/report.html").write_bytes(report)

for words, exit_code, text in [
    (("--channel", "s = mid.dz"), 2, "--channel 's = mid.dz', column 9: use dx, dy or rotation"),
    (("--channel", "s = top.dy"), 2, "use one of mid"),
    (("--channel", "s = mid.dy * mid.dy"), 2, "not linear"),
    (("--channel", "a = mid.dy", "--channel", "a = mid.dx"), 2, "already exists"),
    ((), 2, "or [[channel]] to the site file"),
    (("--channel", "y = mid.dy", "--rest", "0:1"), 2, "run `moiregauge solve` again"),
    (("--channel", "y = mid.dy", "-o", work / "no/such/folder.csv"), 6, "-o"),
]:
    done = run("derive", work / "out", *words)
    insist(done.returncode == exit_code, f"exit {done.returncode}, not {exit_code}: {words} {done.stderr}")
    insist(text in done.stderr and done.stderr.count("error: ") == 1, f"{words}: {done.stderr}")

# Layers: a zero over frames or seconds, a line, a median, a filter; what was done is in derived.json.
def column(words, name):
    return [float(row[name]) for row in derived("--channel", "y = mid.dy", *words)]


zeroed = column(["--zero", "0:6"], "y_mm")
insist(abs(sum(zeroed[:6])) < 1e-8, f"the mean over the zero is not zero: {zeroed}")
insist(zeroed == column(["--zero", "0s:0.6s"], "y_mm"), "another zero in seconds")
u_alone, u_zeroed = column([], "u_y_mm"), column(["--zero", "0:6"], "u_y_mm")
insist(max(u_zeroed[6:]) < 0.9 * max(u_alone[6:]), f"u does not fall: {u_alone} {u_zeroed}")
column(["--median", "3", "--detrend", "--velocity", "4.5Hz"], "y_mm_per_s")
about = json.loads((work / "out/derived.json").read_text())
insist(about["layers"] == ["median 3", "detrend", "velocity 4.5Hz"], f"{about['layers']}")
insist(about["u_is_bound"] is True and about["channels"][0]["unit"] == "mm/s", f"{about}")
insist(about["channels"][0]["peak_to_peak"]["u"] > 0, f"{about}")
for words, text in [
    (("--filter", "lowpass:1"), "write lowpass:5Hz"),
    (("--filter", "lowpass:7Hz"), "half the frame rate"),
    (("--filter", "lowpass:0.5Hz"), "give a higher frequency"),
    (("--median", "4"), "odd number"),
    (("--zero", "50:60"), "choose other frames"),
    (("--zero", "6"), "write frames A:B"),
    (("--resample", "fast"), "e.g. 5Hz"),
]:
    done = run("derive", work / "out", "--channel", "y = mid.dy", *words)
    insist(done.returncode == 2 and text in done.stderr, f"{words}: exit {done.returncode} {done.stderr}")

# The same zero for the run itself: the samples are those of the channel.
done = run("measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "-o", work / "zero", "--quiet",
           "--zero", "0:6")
insist(done.returncode == 0, done.stderr)
insist(json.loads((work / "zero/run.json").read_text())["config"]["zero"]["end"] == 6, "run.json does not state the zero")
with open(work / "zero/displacement.csv", encoding="utf-8") as file:
    samples = list(csv.DictReader(file))
for n, sample in enumerate(samples):
    insist(abs(float(sample["dy_mm"]) - zeroed[n]) < 0.51e-6, f"another zero: {sample} {zeroed[n]}")
    insist(abs(float(sample["u_dy_mm"]) - u_zeroed[n]) < 0.51e-6, f"another u of the zero: {sample} {u_zeroed[n]}")
done = run("derive", work / "zero", "--channel", "y = mid.dy")
insist(done.returncode == 0, done.stderr)
with open(work / "zero/derived.csv", encoding="utf-8") as file:
    insist([float(row["y_mm"]) for row in csv.DictReader(file)] == zeroed, "derive forgets the run's zero")
for name, words in [("again", ()), ("none", ("--zero", "none"))]:
    done = run("solve", work / "zero", "-o", work / name, "--quiet", *words)
    insist(done.returncode == 0, done.stderr)
    same = work / ("zero" if name == "again" else "out")
    insist((work / name / "displacement.csv").read_bytes() == (same / "displacement.csv").read_bytes(), f"solve: {name}")
done = run("solve", work / "out", "-o", work / "wrong", "--zero", "90:95")
insist(done.returncode == 2 and "--zero 90:95" in done.stderr, f"exit {done.returncode}: {done.stderr}")
insist(not (work / "wrong").exists(), "results of a wrong zero")

# Channels of the site file: they follow new names, may be named, and are omitted if a target is not measured.
site = (work / "run/site.toml").read_text(encoding="utf-8")
(work / "channels.toml").write_text(site + '\n[[channel]]\nname = "rise"\nexpression = "mid.dy"\n[[channel]]\nname = "both"\n'
                                    'unit = "um"\nexpression = "1000 * (rise + mid.dx)"\n', encoding="utf-8")
done = run("measure", work / "run/frames", "--site", work / "channels.toml", "--fps", 10, "-o", work / "kept", "--quiet", "--name",
           "mid=midspan")
insist(done.returncode == 0, done.stderr)


def kept(*words):
    done = run("derive", work / "kept", *words)
    insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
    with open(work / "kept/derived.csv", encoding="utf-8") as file:
        return done.stdout, list(csv.DictReader(file))


shown, rows = kept()
insist(list(rows[0])[2::3] == ["rise_mm", "both_um"], f"{list(rows[0])}")
insist("rise = midspan.dy, in mm" in shown and shown.count(" ok\n") == 2, shown)
with open(work / "kept/displacement.csv", encoding="utf-8") as file:
    samples = list(csv.DictReader(file))
for row, sample in zip(rows, samples):
    expected = 1000 * (float(sample["dx_mm"]) + float(sample["dy_mm"]))
    insist(abs(float(row["both_um"]) - expected) < 0.002, f"{row} {sample}")
# Statistics have two significant digits of U, three if the second one is rounded up, or all digits before the point.
for expanded in re.findall(r"U ([\d.]+)", shown):
    insist(2 <= len(expanded.replace(".", "").lstrip("0")) <= 3, f"digits of {expanded}: {shown}")
insist(list(kept("--channel", "half = rise / 2")[1][0])[2::3] == ["half_mm"], "a typed channel replaces those of the file")
insist([row["rise_mm"] for row in kept("--channel", "rise = midspan.dx")[1]] != [row["rise_mm"] for row in rows], "rise")
channels = json.loads((work / "kept/run.json").read_text())["config"]["channels"]
insist(channels[1] == {"name": "both", "unit": "um", "expression": "1000 * (rise + midspan.dx)"}, f"{channels}")
insist('expression = "midspan.dy"' in (work / "kept/site.toml").read_text(encoding="utf-8"), "site.toml of the run")

# What `solve` chooses holds for `derive` and `compare` as well.
done = run("solve", work / "kept", "--quiet", "--name", "midspan=m2", "--zero", "0:6", "--slow-motion", 2)
insist(done.returncode == 0, done.stderr)
shown, rows = kept()
insist("rise = m2.dy" in shown and float(rows[1]["time_s"]) == 0.05, f"{shown} {rows[1]}")
insist(abs(sum(float(row["rise_mm"]) for row in rows[:6])) < 1e-8, "the zero of solve")

# A method that does not know the errors that targets share.
done = run("solve", work / "out", "--method", "two-stage", "-o", work / "two-stage", "--quiet")
insist(done.returncode == 0, done.stderr)
for words, exit_code in [(("--channel", "y = mid.dy", "--zero", "0:6"), 0), (("--channel", "d = mid.dy - mid.dx"), 2)]:
    done = run("derive", work / "two-stage", *words)
    insist(done.returncode == exit_code, f"exit {done.returncode}: {done.stderr}")
insist("measure with --method precise" in done.stderr, done.stderr)
