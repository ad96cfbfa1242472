"""A run is killed, or interrupted once, twice, by the keyboard or by a manager: what was measured stays, and the run goes on to the
same bytes."""
import json
import os
import signal
import subprocess
import time

from survival import Records, beside, clear, contents, done, error_lines, insist, insist_same, long_clip, measure, start

program, work, _ = start()
clip, site = long_clip(program, work, 300)
out = work / "out"
plain = measure(program, clip, site, out)
insist(done(plain).returncode == 0, "the plain run")
wanted = contents(out)
journal = beside(out, ".unfinished") / "run.mgj"


def kept_frames():
    """In the journal; None where there is none, or none any more."""
    try:
        return Records(journal.read_bytes()).frames()
    except FileNotFoundError:
        return None


def stopped(command, *signals):
    """Once a frame or more is in the journal."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not kept_frames():
        time.sleep(0.002)
    for each in signals:
        process.send_signal(each)
        time.sleep(0.001)
    _, stderr = process.communicate(timeout=120)
    insist(process.returncode != 0, "it was done before it could be stopped")
    return process.returncode, stderr


def insist_found(frames=None):
    before = contents(out), contents(journal.parent)
    again = done(plain)
    insist(again.returncode == 2 and len(error_lines(again.stderr)) == 1, f"exit {again.returncode}: {again.stderr}")
    insist("found unfinished run (" in again.stderr and "use --resume or --restart" in again.stderr, again.stderr)
    insist(frames is None or f"({frames} frames)" in again.stderr, f"{frames} frames\n{again.stderr}")
    insist((contents(out), contents(journal.parent)) == before, "something was touched")


def insist_resumes(what, *options):
    again = done([*plain, "--resume", *options])
    insist(again.returncode == 0, f"{what}: exit {again.returncode}: {again.stderr}")
    insist_same(out, wanted, what)


# Killed: the journal is all there is beside the old results.
for state in ("old results", "none"):
    if state == "none":
        clear(out)
    code, _ = stopped(plain, signal.SIGKILL)
    insist(code == -signal.SIGKILL, f"exit {code}")
    insist(contents(out) == (wanted if state == "old results" else None), state)
    kept = kept_frames()
    insist_found(kept)
    solved = done([program, "solve", journal.parent, "-o", work / "solved"])
    insist(solved.returncode == 130 and f"these are its first {kept} frames" in solved.stderr, f"{solved.returncode}: {solved.stderr}")
    insist(len((work / "solved/displacement.csv").read_text().splitlines()) == kept + 1, "frames solved")
    clear(work / "solved")
    insist_resumes(f"killed with {state}")

# What a power cut may leave: a torn record, zeros, nothing at all.
whole = wanted["run.mgj"]
for what, data in [("torn", whole[:len(whole) * 2 // 3]), ("zeros", whole[:len(whole) // 2] + bytes(5000)), ("empty", b""),
                   ("a torn head", whole[:40]), ("a bit that fell over", whole[:9000] + bytes([whole[9000] ^ 4]) + whole[9001:])]:
    journal.parent.mkdir()
    journal.write_bytes(data)
    insist_resumes(what)

# Another one at work.
process = subprocess.Popen(plain, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
while process.poll() is None and not journal.exists():
    time.sleep(0.002)
time.sleep(0.05)
os.kill(process.pid, signal.SIGSTOP)
second = done([*plain, "--restart"])
insist(second.returncode == 2 and "another process" in second.stderr, second.stderr)
os.kill(process.pid, signal.SIGKILL)
process.wait()

# Thrown away.
insist(done([*plain, "--restart"]).returncode == 0, "--restart")
insist_same(out, wanted, "--restart")

# Interrupted once, with nothing in the way: what there is so far stands in the folder.
clear(out)
for how in (signal.SIGINT, signal.SIGTERM):
    clear(out)
    code, stderr = stopped(plain, how)
    insist(code == 130 and "error: stopped at frame " in stderr and "go on with --resume" in stderr, f"exit {code}: {stderr}")
    insist(set(contents(out)) >= {"run.json", "run.mgj", "displacement.csv", "displacement.h5", "overlay.png"}, "results so far")
    about = json.loads((out / "run.json").read_text())
    insist(about["complete"] is False and about["exit_code"] == 130, "run.json")
    frames = Records((out / "run.mgj").read_bytes()).frames()
    rows = (out / "displacement.csv").read_text().splitlines()
    insist(frames == len(rows) - 1 and rows[-1].split(",")[0] == stderr.split("frame ")[1].split(":")[0], f"{frames} frames, {rows[-1]}")
    insist_found(frames)
    insist_resumes("interrupted")

# With old results in the way they stand beside it; twice is at once.
code, stderr = stopped(plain, signal.SIGINT)
insist(code == 130 and "out.unfinished" in stderr and contents(out) == wanted, f"exit {code}: {stderr}")
insist_found()
insist_resumes("interrupted beside old results")
code, stderr = stopped(plain, signal.SIGINT, signal.SIGINT)
insist(code in (-signal.SIGINT, 130) and contents(out) == wanted, f"exit {code}: {stderr}")
insist_found()

# Other options, another input: not this run.
for options, word in [(["--method", "two-stage"], "--method"), (["--frames", "0:200"], "--frames"), (["--fps", "20"], "--fps")]:
    again = done([word for word in plain if options[0] != "--fps" or word not in ("--fps", "10")] + [*options, "--resume"])
    insist(again.returncode == 2 and "cannot resume" in again.stderr and word in again.stderr, again.stderr)
(clip / "000300.png").write_bytes((clip / "000000.png").read_bytes())
for option in ([], ["--resume"], ["--restart"]):
    again = done([*plain, *option])
    insist(again.returncode == 2, again.stderr)
(clip / "000300.png").unlink()

# Stopped again and again, and once more while it passes over what it has.
while kept_frames() is not None:
    had = kept_frames()
    process = subprocess.Popen([*plain, "--resume"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and (kept_frames() or 0) < min(had + 60, 300):
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    insist(process.returncode in (0, -signal.SIGKILL), f"exit {process.returncode}")
    insist((kept_frames() or 300) >= had, "frames were lost")
    if kept_frames() == 300:
        insist_resumes("stopped again and again")
insist_same(out, wanted, "in the end")
