#!/usr/bin/python3
"""Tests `moiregauge live` with a recording as the camera.

    live.py MOIREGAUGE WORK SOURCE
"""
import csv
import json
import random
import resource
import signal
import subprocess
import time

from runs import insist, rows, run, simulate, start

program, work, _ = start()
FRAMES, FPS = 120, 10
simulate(program, work / "scene", "small-1x", FRAMES)
scene, site = work / "scene/frames", work / "scene/site.toml"
ENDLESS = ["--site", site, "--fps", FPS]
run([program, "measure", scene, *ENDLESS, "-o", work / "measured", "--quiet"])
with open(work / "scene/truth.csv", newline="") as file:
    TRUTH = {(int(row["frame"]), row["marker"]): row for row in csv.DictReader(file)}


def live(out, pace, *more):
    return [str(word) for word in [program, "live", scene, *ENDLESS, "--pace", pace, "-o", work / out, *more]]


def insist_true(samples, limit):
    """Every ok row is within `limit` u of the truth, and at least half of all rows are ok."""
    ok = [row for row in samples if row["status"] == "ok" and float(row["u_dy_mm"]) > 0]
    insist(2 * len(ok) >= len(samples), f"{len(ok)} of {len(samples)} rows are ok")
    for row in ok:
        for axis in "dx_mm", "dy_mm":
            error = float(row[axis]) - float(TRUTH[int(row["frame"]), row["marker"]][axis])
            insist(abs(error) < limit * float(row["u_" + axis]), f"{axis} off by {error} mm: {row}")


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def facts(out):
    return json.loads((work / out / "live.json").read_text())


# Without lost frames the run directory is that of `measure`, and `solve` gives it again.
run([*live("same", "max"), "--quiet"])
for name in "displacement.csv", "run.mgj", "run.json", "overlay.png":
    insist((work / "same" / name).read_bytes() == (work / "measured" / name).read_bytes(), f"{name} is not that of measure")
run([program, "solve", work / "same", "-o", work / "again", "--quiet"])
insist((work / "again/displacement.csv").read_bytes() == (work / "measured/displacement.csv").read_bytes(), "solve")
insist((work / "again/live.csv").exists() and (work / "again/live.json").exists(), "solve drops the files of live")
published = table(work / "same/live.csv")
insist([int(row["frame"]) for row in published] == list(range(FRAMES)), "a row is missing in live.csv")
insist(facts("same")["lost_frames"] == {"queue_full": 0, "incomplete": 0, "in_camera": 0, "starting": 0}, "lost frames")

# A camera that is too fast loses frames. All are counted, and the others keep their numbers.
done = run(live("fast", 60))
kept = [int(row["frame"]) for row in table(work / "fast/live.csv")]
lost = sum(facts("fast")["lost_frames"].values())
insist(len(kept) + lost == FRAMES and lost > 0, f"{len(kept)} kept and {lost} lost of {FRAMES}")
insist(kept == sorted(set(kept)) and kept[0] == 0, "numbers of frames")
insist(f"warning: {lost} of {FRAMES} frames were not measured" in done.stderr, done.stderr)
insist([int(row[0]) for row in rows(work / "fast")] == kept, "final rows are not those of the published frames")
insist_true(table(work / "fast/displacement.csv"), 5)

# JSON lines, and the end of an endless run by --for and by a signal.
done = run([*live("lines", "max", "--json", "--for", "4s")])
lines = [json.loads(line) for line in done.stdout.splitlines()]
insist(lines[-1] == {"type": "end", "exit_code": 0, "folder": str(work / "lines")}, done.stdout)
insist(len(lines) > 1 and all(line["type"] == "frame" for line in lines[:-1]) and lines[-2]["rows"], done.stdout)
insist([int(row["frame"]) for row in table(work / "lines/live.csv")] == list(range(4 * FPS)), "--for")

process = subprocess.Popen(live("ended", 4, "--quiet"))
while not (work / "ended.unfinished/overlay.png").exists():
    time.sleep(0.02)
time.sleep(0.5)
process.send_signal(signal.SIGTERM)
insist(process.wait(60) == 0, f"exit {process.returncode} after SIGTERM")
insist(0 < len(rows(work / "ended")) < FRAMES, "rows after SIGTERM")

# Kills at random moments. Each loses at most a second of rows. The zero stays, and no row is off.
rng = random.Random(25)


def stored_rows(folder):
    return sum(path.read_text().count("\n") for path in folder.parent.glob(folder.name + "*/**/live.csv"))


def kill(command, folder, after):
    """Kills a run `after` seconds since it stored new rows. Returns the time of the kill.

    The first rows of a run are those of the frames that waited for the reference frame.
    """
    before = stored_rows(folder)
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while stored_rows(folder) < before + (3 if before else 12) and process.poll() is None:
        time.sleep(0.02)
    time.sleep(after)
    now = time.time_ns()
    process.kill()
    insist(process.wait(60) == -signal.SIGKILL, f"exit {process.returncode}: {process.stderr.read()}")
    return now


def insist_recent(path, killed_ns):
    """The newest whole row is less than a second older than the kill."""
    whole = path.read_text().rpartition("\n")[0].splitlines()
    if len(whole) > 1:
        age = (killed_ns - int(whole[-1].split(",")[-1])) / 1e9
        insist(age < 1.0, f"the newest row is {age:.2f} s old")


for n in range(3):
    killed = kill(live("killed", 1, *(["--resume"] if n else [])), work / "killed", rng.uniform(0.0, 0.8))
    insist_recent(work / "killed.unfinished/live.csv", killed)
again = run(live("killed", "max"), 2)
insist("there is an unfinished run" in again.stderr and "--resume" in again.stderr, again.stderr)
run(live("killed", "max", "--resume", "--quiet"))
insist(json.loads((work / "killed/run.json").read_text())["reference_frame"] == 0, "another zero")
insist_true(table(work / "killed/displacement.csv"), 5)
numbers = [int(row["frame"]) for row in table(work / "killed/live.csv")]
insist(numbers == sorted(set(numbers)) and numbers[-1] == FRAMES - 1, "rows of live.csv after kills")
insist(len(rows(work / "killed")) == len(set(numbers) | {int(row[0]) for row in rows(work / "killed")}), "a row is in live.csv only")

# A camera (a pipe in real time) that is started again: numbers and zero continue, and time follows the host's clock.
# From version 6.1 on, ffmpeg reads the first half second at once by default. No camera does that.
ffmpeg_help = subprocess.run(["ffmpeg", "-hide_banner", "-h", "long"], capture_output=True, text=True, check=True).stdout
AT_ONCE = ["-readrate_initial_burst", "0.001"] if "readrate_initial_burst" in ffmpeg_help else []
FEED = ["ffmpeg", "-nostdin", "-loglevel", "error", "-re", *AT_ONCE, "-framerate", str(FPS), "-i", str(scene / "%06d.png"),
        "-pix_fmt", "gray", "-f", "yuv4mpegpipe", "-strict", "-1", "-"]


def camera(*more):
    pipe = subprocess.Popen(FEED, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    command = [program, "live", "-", "--site", site, "-o", work / "camera", "--quiet", *more]
    return pipe, subprocess.Popen([str(word) for word in command], stdin=pipe.stdout)


pipe, process = camera()
while stored_rows(work / "camera") < 12 and process.poll() is None:
    time.sleep(0.02)
process.kill()
pipe.kill()
insist(process.wait() == -signal.SIGKILL, "the camera ended")
pipe, process = camera("--resume", "--for", "2s")
insist(process.wait(60) == 0, f"exit {process.returncode} of a camera")
pipe.kill()
samples = table(work / "camera/displacement.csv")
numbers = [int(row["frame"]) for row in samples]
insist(numbers == list(range(len(numbers))) and len(numbers) > 25, f"{numbers}")
times = [float(row["time_s"]) for row in samples]
insist(times == sorted(set(times)) and times[-1] > times[0] + len(times) / FPS, "times of a camera")
insist(facts("camera")["resumed_at"] > 0 and facts("camera")["source"] == "-", "live.json of a camera")
insist(json.loads((work / "camera/run.json").read_text())["reference_frame"] == 0, "another zero")

# Without pace nothing is lost by a kill either: the bytes are those of an uninterrupted run.
process = subprocess.Popen(live("bytes", "max", "--quiet"))
csv_path = work / "bytes.unfinished/live.csv"
while process.poll() is None and not (csv_path.exists() and csv_path.read_text().count("\n") > 20):
    time.sleep(0.002)
process.kill()
process.wait()
run([*live("bytes", "max", "--resume"), "--quiet"])
for name in "displacement.csv", "run.mgj", "overlay.png":
    insist((work / "bytes" / name).read_bytes() == (work / "measured" / name).read_bytes(), f"{name} after a kill")

# Segments: each is a run directory with the same zero, also after a kill and after a regular end.
kill(live("parts", 1, "--segment", "2s"), work / "parts", 0.3)
insist("--resume" in run(live("parts", 1, "--segment", "2s"), 2).stderr, "segments are replaced")
run([*live("parts", "max", "--segment", "2s", "--resume", "--for", "2.5s"), "--quiet"])
run([*live("parts", "max", "--segment", "2s", "--resume"), "--quiet"])
insist("the choice of markers differs" in run(live("parts", "max", "--segment", "2s", "--resume", "--ignore", "NW"), 2).stderr, "other options")
parts = sorted((work / "parts").iterdir())
insist(all(part.name == f"segment-{n + 1:06}" for n, part in enumerate(parts)) and len(parts) >= 4, f"{parts}")
numbers = []
for part in parts:
    insist(json.loads((part / "run.json").read_text())["reference_frame"] == 0, "another zero")
    samples = table(part / "displacement.csv")
    insist_true(samples, 5)
    numbers += [int(row["frame"]) for row in samples]
    run([program, "solve", part, "-o", work / "part", "--quiet"])
    insist((work / "part/displacement.csv").read_bytes() == (part / "displacement.csv").read_bytes(), f"solve {part}")
insist(numbers == sorted(set(numbers)), "frames in two segments")
run([program, "export", parts[1], "--format", "csv", "-o", work / "export.csv"])
insist(len({table(part / "displacement.csv")[0]["time_s"] for part in parts}) == len(parts), "times of the segments")

# Old segments are deleted, but never the newest finished one.
run([*live("quota", "max", "--segment", "2s", "--quota", "0.5MB"), "--quiet"])
left = sorted(part.name for part in (work / "quota").iterdir())
insist(left == ["segment-000006"], f"{left}")


# A full disk ends the run with exit 6 and keeps its frames.
def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


done = subprocess.run(live("full", "max", "--quiet"), capture_output=True, text=True, check=False, preexec_fn=small_files)
insist(done.returncode == 6 and "frames are kept): free space and run again with --resume" in done.stderr, f"{done.returncode}: {done.stderr}")
run([*live("full", "max", "--resume"), "--quiet"])
insist((work / "full/displacement.csv").read_bytes() == (work / "measured/displacement.csv").read_bytes(), "after a full disk")
