"""Tests the options about time: ranges in seconds, `--fps` and `--slow-motion` of `measure` and `solve`, start time.

Each is compared with the same selection in frames, or with the same times given to `measure`.
"""
import csv
import json
import shutil
import subprocess

from runs import insist, run, simulate, start

program, work, _ = start()
FPS = 10
simulate(program, work / "run", "small-travel-5", 12, "--set", "marker.mid.dy.scale=0")
frames, site = work / "run/frames", work / "run/site.toml"


def measure(name, *options):
    run([program, "measure", frames, "--site", site, "--quiet", "-o", work / name, *options])


def solve(name, of, *options):
    run([program, "solve", work / of, "--quiet", "-o", work / name, *options])


def same(a, b, *files):
    for file in files:
        insist((work / a / file).read_bytes() == (work / b / file).read_bytes(), f"{a}/{file} is not {b}/{file}")


def refused(part, *words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    lines = done.stderr.splitlines()
    insist(done.returncode == 2 and len(lines) == 1 and part in lines[0], f"exit {done.returncode}: {words}\n{done.stderr}")


def times(name):
    with open(work / name / "displacement.csv", newline="") as file:
        return [float(row["time_s"]) for row in csv.DictReader(file)]


def facts(name):
    return json.loads((work / name / "run.json").read_text())


# Seconds select the frames that lie in them.
measure("whole", "--fps", FPS)
measure("by-frame", "--fps", FPS, "--frames", "3:8:2", "--rest", "0:6", "--reference-frame", 0)
measure("by-time", "--fps", FPS, "--frames", "0.3s:0.8s:2", "--rest", "0:600ms", "--reference-frame", 0)
same("by-frame", "by-time", "displacement.csv", "site.toml")
insist(facts("by-time")["config"]["frames"] == {"first": 3, "end": 8, "step": 2, "first_s": 0.3, "end_s": 0.8}, "config.frames")
insist(facts("by-time")["config"]["rest"]["end"] == 6, "config.rest")
solve("rested-later", "whole", "--rest", "0s:0.6s")
solve("rested-by-frame", "whole", "--rest", "0:6")
same("rested-later", "rested-by-frame", "displacement.csv")
for selection in (["--frames", "0.3s:0.8s"], ["--time", "0.3:0.8"], ["--frames", "3:8"]):
    rows = run([program, "export", work / "whole", "-o", "-", *selection]).stdout.splitlines()
    insist([row.split(",")[0] for row in rows[1:]] == list("34567"), f"export {selection} gives {rows}")

# Times given later are those given at once.
measure("timeless")
insist(facts("timeless")["input"]["fps"] is None and all(t != t for t in times("timeless")), "times without --fps")
solve("timed-later", "timeless", "--fps", FPS)
same("timed-later", "whole", "displacement.csv", "run.json", "site.toml")
measure("slow", "--fps", FPS, "--slow-motion", 8)
solve("slow-later", "whole", "--slow-motion", 8)
solve("slow-at-once", "timeless", "--fps", FPS, "--slow-motion", 8)
for name in ("slow-later", "slow-at-once"):
    same(name, "slow", "displacement.csv", "run.json", "site.toml")
insist(times("slow") == [n / FPS / 8 for n in range(12)], f"slow motion: {times('slow')}")
insist(facts("slow")["input"]["fps"] == 8 * FPS and facts("slow")["input"]["slow_motion"] == 8, "input.slow_motion")
solve("as-filmed", "slow", "--slow-motion", 1)
same("as-filmed", "whole", "displacement.csv", "run.json")

# Without times, or without frames in the range, nothing is measured.
plain = [program, "measure", frames, "--site", site, "--quiet", "-o", work / "refused"]
refused("have no times: --frames 0.3s:0.8s: give --fps", *plain, "--frames", "0.3s:0.8s")
refused("have no times: --rest 0s:1s: give --fps", *plain, "--rest", "0s:1s")
refused("have no times: --slow-motion 8: give --fps", *plain, "--slow-motion", "8")
refused("have no times: --rest 0s:1s: give --fps", program, "solve", work / "timeless", "--rest", "0s:1s")
refused("does not exist: --frames 5s:6s of", *plain, "--fps", FPS, "--frames", "5s:6s")
refused("none of the measured frames is in the range: --rest 5s:6s", *plain, "--fps", FPS, "--rest", "5s:6s")
insist(not (work / "refused").exists(), "results were written")

# The start time is stated as the file has it.
video = work / "clip.mkv"
run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", FPS, "-i", frames / "%06d.png", "-frames:v", 3, "-c:v", "ffv1",
     "-metadata", "creation_time=2026-05-04T09:12:33.25Z", video])
run([program, "measure", video, "--site", site, "--quiet", "-o", work / "dated"])
insist(facts("dated")["input"]["start_utc"] == "2026-05-04T09:12:33.25Z", f"start_utc: {facts('dated')['input']}")
insist(facts("whole")["input"]["start_utc"] is None, "images without a date have none")
shutil.rmtree(work)
