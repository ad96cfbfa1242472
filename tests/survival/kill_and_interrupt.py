"""Checks that a killed or interrupted run keeps its frames, and that --resume gives the bytes of an uninterrupted run.

Interrupts are SIGINT and SIGTERM, once and twice.
"""
import json
import os
import signal
import subprocess
import time

from survival import Records, with_suffix, clear, contents, done, error_lines, insist, insist_same, long_clip, measure, start

program, work, _ = start()
FRAMES = 160
clip, site = long_clip(program, work, FRAMES)
out = work / "out"
plain = measure(program, clip, site, out)
insist(done(plain).returncode == 0, "the plain run")
wanted = contents(out)
journal = with_suffix(out, ".unfinished") / "run.mgj"


def kept_frames():
    """Returns the number of frames in the journal; None if there is no journal."""
    try:
        return Records(journal.read_bytes()).frames()
    except FileNotFoundError:
        return None


def stopped(command, *signals):
    """Starts a command and sends the signals when the journal has a frame. Returns the exit code and stderr."""
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
    insist("there is an unfinished run: " in again.stderr and "--resume" in again.stderr and "--restart" in again.stderr, again.stderr)
    insist(frames is None or f"({frames} frames)" in again.stderr, f"{frames} frames\n{again.stderr}")
    insist((contents(out), contents(journal.parent)) == before, "something was touched")


def insist_resumes(what, *options):
    again = done([*plain, "--resume", *options])
    insist(again.returncode == 0, f"{what}: exit {again.returncode}: {again.stderr}")
    insist_same(out, wanted, what)


# Killed: only the journal and the old results remain.
for state in ("old results", "none"):
    if state == "none":
        clear(out)
    code, _ = stopped(plain, signal.SIGKILL)
    insist(code == -signal.SIGKILL, f"exit {code}")
    insist(contents(out) == (wanted if state == "old results" else None), state)
    kept = kept_frames()
    insist_found(kept)
    solved = done([program, "solve", journal.parent, "-o", work / "solved"])
    insist(solved.returncode == 130 and f"the results end after the first {kept} of its frames" in solved.stderr, f"{solved.returncode}: {solved.stderr}")
    insist(len((work / "solved/displacement.csv").read_text().splitlines()) == kept + 1, "frames solved")
    clear(work / "solved")
    insist_resumes(f"killed with {state}")

# Journals after a power cut: a truncated record, zeros, an empty file.
whole = wanted["run.mgj"]
for what, data in [("torn", whole[:len(whole) * 2 // 3]), ("zeros", whole[:len(whole) // 2] + bytes(5000)), ("empty", b""),
                   ("a torn head", whole[:40]), ("a bit that fell over", whole[:9000] + bytes([whole[9000] ^ 4]) + whole[9001:])]:
    journal.parent.mkdir()
    journal.write_bytes(data)
    insist_resumes(what)

# Another process uses the same output folder.
process = subprocess.Popen(plain, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
while process.poll() is None and not journal.exists():
    time.sleep(0.002)
time.sleep(0.05)
os.kill(process.pid, signal.SIGSTOP)
second = done([*plain, "--restart"])
insist(second.returncode == 2 and "another process" in second.stderr, second.stderr)
os.kill(process.pid, signal.SIGKILL)
process.wait()

# The journal is discarded.
insist(done([*plain, "--restart"]).returncode == 0, "--restart")
insist_same(out, wanted, "--restart")

# Interrupted once, without old results: the results so far are written to the output folder.
clear(out)
for how in (signal.SIGINT, signal.SIGTERM):
    clear(out)
    code, stderr = stopped(plain, how)
    insist(code == 130 and "error: stopped at frame " in stderr and "continue with --resume" in stderr, f"exit {code}: {stderr}")
    insist(set(contents(out)) >= {"run.json", "run.mgj", "displacement.csv", "displacement.h5", "overlay.png"}, "results so far")
    about = json.loads((out / "run.json").read_text())
    insist(about["complete"] is False and about["exit_code"] == 130, "run.json")
    frames = Records((out / "run.mgj").read_bytes()).frames()
    rows = (out / "displacement.csv").read_text().splitlines()
    insist(frames == len(rows) - 1 and rows[-1].split(",")[0] == stderr.split("frame ")[1].split(":")[0], f"{frames} frames, {rows[-1]}")
    insist_found(frames)
    insist_resumes("interrupted")

# Interrupted once, with old results: the journal remains in out.unfinished. A second interrupt ends the run at once.
code, stderr = stopped(plain, signal.SIGINT)
insist(code == 130 and "out.unfinished" in stderr and contents(out) == wanted, f"exit {code}: {stderr}")
insist_found()
insist_resumes("interrupted next to old results")
code, stderr = stopped(plain, signal.SIGINT, signal.SIGINT)
insist(code in (-signal.SIGINT, 130) and contents(out) == wanted, f"exit {code}: {stderr}")
insist_found()

# Other options or another input do not belong to this run.
for options, word in [(["--method", "two-stage"], "--method"), (["--frames", f"0:{FRAMES - 50}"], "--frames"), (["--fps", "20"], "--fps")]:
    again = done([word for word in plain if options[0] != "--fps" or word not in ("--fps", "10")] + [*options, "--resume"])
    insist(again.returncode == 2 and "the unfinished run had other options" in again.stderr and word in again.stderr, again.stderr)
(clip / f"{FRAMES:06}.png").write_bytes((clip / "000000.png").read_bytes())
for option in ([], ["--resume"], ["--restart"]):
    again = done([*plain, *option])
    insist(again.returncode == 2, again.stderr)
(clip / f"{FRAMES:06}.png").unlink()

# Killed repeatedly, also while a resumed run reads its journal.
while kept_frames() is not None:
    had = kept_frames()
    process = subprocess.Popen([*plain, "--resume"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and (kept_frames() or 0) < min(had + 40, FRAMES):
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    insist(process.returncode in (0, -signal.SIGKILL), f"exit {process.returncode}")
    insist((kept_frames() or FRAMES) >= had, "frames were lost")
    if kept_frames() == FRAMES:
        insist_resumes("stopped again and again")
insist_same(out, wanted, "in the end")
