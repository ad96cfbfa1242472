#!/usr/bin/python3
"""Checks `moiregauge batch --slurm` on a real Slurm cluster of one node.

    slurm.py MOIREGAUGE WORK SOURCE

The results are those of a local batch, byte for byte, although one task is killed and another requeued. Tasks write no catalogue. A second
submission has nothing to do. Ends 77 (skipped) only if it does not run as root, which slurmd requires.
"""
import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from clips import batch, make_clip  # noqa: E402
from cluster import Cluster, kill_children, missing  # noqa: E402
from runs import insist, start  # noqa: E402

CLIPS = 6
REPEATS = 12  # times that a clip shows its frames, so that a task runs for seconds and is not finished when it is killed


def submitted(program, cluster, clips, out, *words, expected=0):
    done = subprocess.run([program, "batch", clips, "-o", out, "--slurm", *words], env=cluster.environment, capture_output=True,
                          text=True, check=False)
    insist(done.returncode == expected, f"exit {done.returncode}: {done.stdout}{done.stderr}")
    return done


def main():
    if os.geteuid() != 0:
        print("skipped: slurmd needs root")
        return 77
    insist(not missing(), f"not installed: {', '.join(missing())}: run tools/install-packages test")
    program, work, _ = start()
    program = str(pathlib.Path(program).resolve())
    video, site = make_clip(program, work, REPEATS)
    clips, out, local = work / "it's clips", work / "100% out", work / "local"
    clips.mkdir()
    shutil.copy(site, clips / "site.toml")
    for n in range(CLIPS):
        os.link(video, clips / f"clip{n}.mkv")
    (clips / "broken.mkv").write_bytes(video.read_bytes()[:2000])
    batch(program, clips, "-o", local, expected=5)
    with Cluster(work) as cluster:
        refused = submitted(program, cluster, clips, out, "--sbatch=--partition=none", expected=2)
        insist("error: Slurm did not accept the job: sbatch (" in refused.stderr and "partition" in refused.stderr, refused.stderr)
        done = submitted(program, cluster, clips, out, "--chunk", "2", "--jobs", "2")
        insist(f"{CLIPS + 1} of them to measure" in done.stdout and "with 4 tasks" in done.stdout, done.stdout)
        killed, requeued = cluster.wait_for_steps(2, seconds=60)[:2]
        kill_children(killed)  # for Slurm the task has failed, so it is not started again
        subprocess.run(["scontrol", "requeue", cluster.task_of(requeued)], env=cluster.environment, check=True)  # as after the loss of a node
        cluster.wait(120)
        insist(not (out / "catalogue.sqlite").exists(), "tasks write no catalogue")
        again = submitted(program, cluster, clips, out)
        insist("with 1 tasks" in again.stdout, f"only the killed task is left: {again.stdout}")
        cluster.wait(60)
        again = submitted(program, cluster, clips, out)
        insist("nothing was submitted" in again.stdout, again.stdout)
    batch(program, "--collect", "-o", out, expected=5)
    for n in range(CLIPS):
        insist((out / f"clip{n}/displacement.csv").read_bytes() == (local / f"clip{n}/displacement.csv").read_bytes(), f"clip{n}")
    query = "SELECT run, outcome, exit_code FROM runs ORDER BY run"
    insist(batch(program, "-o", out, "--query", query).stdout == batch(program, "-o", local, "--query", query).stdout, "the same catalogue")
    return 0


if __name__ == "__main__":
    sys.exit(main())
