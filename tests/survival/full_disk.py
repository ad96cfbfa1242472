"""Checks a run on a disk that becomes full, and in a folder that cannot be written."""
import os
import resource
import shutil
import subprocess
import sys

from survival import with_suffix, clear, contents, done, error_lines, insist, insist_same, long_clip, measure, start

program, work, _ = start()
clip, site = long_clip(program, work, 60)
out = work / "out"
plain = measure(program, clip, site, out)
insist(done(plain).returncode == 0, "the plain run")
wanted = contents(out)
journal = len(wanted["run.mgj"])


def run_into_a_full_disk(command, env=None, limit=None):
    """Runs a command that must end with exit 6 and one error line. limit: largest size of a file in bytes."""
    def before():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    run = subprocess.run(command, env=env, capture_output=True, text=True, check=False, preexec_fn=before if limit else None)
    insist(run.returncode == 6, f"exit {run.returncode}\n{run.stderr}")
    insist(len(error_lines(run.stderr)) == 1 and len(run.stderr.splitlines()) == 1, run.stderr)
    return run.stderr


# During the measurement: old results are unchanged, and the journal has the frames that fitted.
said = run_into_a_full_disk(plain, limit=journal * 2 // 3)
insist("run.mgj" in said and "frames are kept): free space and run again with --resume" in said, said)
insist(contents(out) == wanted, "old results")
insist(set(contents(with_suffix(out, ".unfinished"))) == {"run.mgj"}, "more than a journal")
again = done(plain)
insist(again.returncode == 2 and "there is an unfinished run: " in again.stderr, again.stderr)
insist(contents(out) == wanted, "old results")
frames = int(again.stderr.split("(")[1].split()[0])
insist(frames > 0 and f" {frames} frames are kept" in said, f"{frames} frames found\n{said}")
insist(done([*plain, "--resume"]).returncode == 0, "--resume")
insist_same(out, wanted, "after --resume")

# A full file system: a small tmpfs, if the test may mount one.
small = work / "small"
small.mkdir()
mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", small], capture_output=True, check=False).returncode == 0
if mounted:
    try:
        on_small = measure(program, clip, site, small / "out")
        said = run_into_a_full_disk(on_small)
        insist("No space left on device" in said and "--resume" in said, said)
        subprocess.run(["mount", "-o", "remount,size=64m", small], check=True)
        insist(done([*on_small, "--resume"]).returncode == 0, "--resume after the disk was enlarged")
        insist_same(small / "out", wanted, "on a disk that was full")
    finally:
        subprocess.run(["umount", small], check=True)
else:
    print("no file system may be mounted here", file=sys.stderr)

# An output folder that cannot be written is reported before the measurement.
clear(out)
if os.geteuid() != 0:
    locked = work / "locked"
    locked.mkdir(mode=0o555)
    said = run_into_a_full_disk(measure(program, clip, site, locked / "out"))
    insist("locked/out" in said, said)
file = work / "file"
file.write_text("")
said = run_into_a_full_disk(measure(program, clip, site, file / "out"))
insist("file/out" in said, said)
insist(file.read_text() == "" and not shutil.rmtree(work / "few"), "nothing else was touched")
