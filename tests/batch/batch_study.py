#!/usr/bin/python3
"""Measures how `moiregauge batch` scales, and prints the tables of docs/scaling.md.

    batch_study.py MOIREGAUGE WORK SOURCE [CLIPS] [CATALOGUE] [PART...]

CLIPS (200): short clips, of which every tenth is damaged. CATALOGUE (10000): clips of the largest catalogue.
PART: local, slurm, catalogue; all unless given. The others need the first one. Ends 1 if
a requirement is not met. Takes a quarter of an hour on two idle cores.
"""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from clips import batch  # noqa: E402
from cluster import Cluster, kill_children, missing  # noqa: E402
from runs import insist, run, simulate, start  # noqa: E402

FRAMES = 40
SCENES = 10  # different recordings
failed = []


def require(condition, what):
    if not condition:
        failed.append(what)


def timed(command, env=None, expected=(0, 5)):
    """Returns wall time in s and the largest resident set in MB."""
    report = subprocess.run(["/usr/bin/time", "-f", "%e %M", *map(str, command)], capture_output=True, text=True, env=env, check=False)
    insist(report.returncode in expected, f"exit {report.returncode}: {command}: {report.stderr}")
    seconds, kilobytes = report.stderr.strip().splitlines()[-1].split()
    return float(seconds), int(kilobytes) / 1000


def make_clips(program, work, count):
    clips = work / "clips"
    clips.mkdir()
    rng = random.Random(27)
    for scene in range(SCENES):
        folder = work / f"scene{scene}"
        simulate(program, folder, "small-1xyz", FRAMES, "--set", f"seed={scene + 1}")
        run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", "10", "-i", folder / "frames/%06d.png", "-c:v", "ffv1", work / f"{scene}.mkv"])
    shutil.copy(work / "scene0/site.toml", clips / "site.toml")
    for n in range(count):
        source = work / f"{n % SCENES}.mkv"
        target = clips / f"clip{n:05d}.mkv"
        if n % 10 != 7:
            os.link(source, target)
            continue
        content = bytearray(source.read_bytes())
        kind = n // 10 % 4
        if kind == 0:
            content = content[: rng.randrange(100, len(content))]
        elif kind == 1:
            content = rng.randbytes(5000)
        elif kind == 2:
            content = b""
        else:
            at = rng.randrange(len(content) // 2)
            content[at: at + 20000] = rng.randbytes(20000)
        target.write_bytes(content)
    return clips


def outcomes(program, out):
    text = batch(program, "-o", out, "--query", "SELECT run, exit_code FROM runs ORDER BY run").stdout
    return dict(line.split(",") for line in text.splitlines()[1:])


def same_results(one, other, names):
    return all((one / name / "displacement.csv").read_bytes() == (other / name / "displacement.csv").read_bytes()
               for name in names if (one / name / "displacement.csv").exists())


def one_process(program, clips, work):
    """Measures the clips one after the other on one processor. Returns the time and the exit codes.

    `measure` decodes in a process of its own. With two processors it uses 1.2 of them, so two processes would be compared with 1.2.
    """
    codes = {}
    processor = str(min(os.sched_getaffinity(0)))
    begin = time.time()
    for clip in clips:
        done = subprocess.run(["taskset", "-c", processor, program, "measure", clip, "--site", clip.parent / "site.toml", "--quiet", "-o", work / "single" / clip.stem,
                               "--threads", "1"], capture_output=True, check=False)
        codes[clip.stem] = str(done.returncode)
    return time.time() - begin, codes


def local_part(program, clips, work, count):
    (work / "single").mkdir()
    single_s = two_s = two_mb = 0.0
    codes = {}
    # In turns, so that other work of the computer slows both. Few parts, because one processor idles at the end of each.
    every = sorted(clips.glob("*.mkv"))
    for part in range(2):
        some = every[part::2]
        seconds, more = one_process(program, some, work)
        single_s += seconds
        codes.update(more)
        (work / "clips.txt").write_text("".join(f"{clip}\n" for clip in some))
        seconds, megabytes = timed([program, "batch", f"@{work / 'clips.txt'}", "-o", work / "two", "--jobs", "2"])
        two_s += seconds
        two_mb = max(two_mb, megabytes)
    again_s, _ = timed([program, "batch", clips, "-o", work / "two", "--jobs", "2"])
    require(outcomes(program, work / "two") == codes, "each clip has the exit code of `measure`")
    require(same_results(work / "single", work / "two", codes), "the displacements are those of `measure`")
    ratio = single_s / two_s
    require(ratio >= 1.9, f"two processes are {ratio:.2f} times as fast as one")
    bad = sum(code not in ("0", "5") for code in codes.values())
    print(f"""| {count} clips of {FRAMES} frames, {1024} x 512 px, ffv1; {bad} of {count // 10} damaged ones fail | measured |
|---|---|
| `measure` clip by clip, on one processor | {single_s:.1f} s, {single_s / count:.2f} s per clip |
| `batch --jobs 2` on two processors | {two_s:.1f} s |
| ratio (required: at least 1.9) | {ratio:.2f} |
| exit code and displacement.csv of every clip as by `measure` | yes |
| the same command again: all clips are skipped, the three files are written | {again_s:.1f} s |
| largest resident memory of one process | {two_mb:.0f} MB |
""")
    return single_s / count


def slurm_part(program, clips, work, count):
    absent = missing()
    if absent:
        print(f"No Slurm cluster could run here, because programs are not installed: {', '.join(absent)}.\n")
        return
    out = work / "slurm"
    with Cluster(work) as cluster:
        begin = time.time()
        submit_s, _ = timed([program, "batch", clips, "-o", out, "--slurm", "--chunk", "5"], env=cluster.environment)
        rng = random.Random(10)
        kills = 0
        while kills < 10:
            steps = cluster.steps()
            if steps and rng.random() < 0.5:
                kill_children(rng.choice(steps))
                kills += 1
            time.sleep(0.7)
            insist(cluster.jobs(), "ten tasks can be killed before all have ended")
        cluster.kill_slurmd()
        time.sleep(3)
        cluster.start_slurmd()
        cluster.wait(1200)
        first_s = time.time() - begin
        left = unfinished(out, clips)
        timed([program, "batch", clips, "-o", out, "--slurm", "--chunk", "5"], env=cluster.environment)
        cluster.wait(600)
        tasks_s = empty_tasks(cluster, work)
    collect_s, _ = timed([program, "batch", "--collect", "-o", out])
    present = outcomes(program, out) == outcomes(program, work / "two") and same_results(work / "two", out, outcomes(program, out))
    require(present, "the results of Slurm are those of the local batch")
    print(f"""| {count} clips on a Slurm cluster of one node with two processors, {-(-count // 5)} tasks | measured |
|---|---|
| submission | {submit_s:.1f} s |
| ten tasks killed and slurmd killed and started again: until no task is left | {first_s:.0f} s |
| clips that the killed tasks left, for a second submission | {left} |
| after it every result is present and identical to the local batch | {'yes' if present else 'no'} |
| `--collect` | {collect_s:.1f} s |
| 40 empty tasks, time per task and processor | {tasks_s:.1f} s |
""")


def unfinished(out, clips):
    states = [json.loads(path.read_text()) for path in (out / ".batch/state").iterdir()]
    return len(list(clips.glob("*.mkv"))) - sum(state["finished"] for state in states)


def empty_tasks(cluster, work):
    (work / "empty.sh").write_text("#!/bin/sh\nexit 0\n")
    begin = time.time()
    subprocess.run(["sbatch", "--array=1-40", "--output=/dev/null", work / "empty.sh"], env=cluster.environment, capture_output=True, check=True)
    cluster.wait(300)
    return (time.time() - begin) / 20


def catalogue_part(program, work, largest):
    """Copies one finished clip, so that only the catalogue is measured."""
    print("| catalogue only: clips of 40 frames | time | largest resident memory | catalogue.sqlite | index.html |\n|---|---|---|---|---|")
    memory = []
    for count in (largest // 100, largest // 10, largest):
        out = work / "many"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(work / "two/.batch", out / ".batch")
        lines = (out / ".batch/clips.jsonl").read_text().splitlines()
        state = (out / ".batch/state/clip00000.json").read_text()
        shutil.rmtree(out / ".batch/state")
        (out / ".batch/state").mkdir()
        with open(out / ".batch/clips.jsonl", "w") as clips:
            print(lines[0], file=clips)
            for n in range(count):
                print(json.dumps({"name": f"clip{n}", "input": f"/recordings/clip{n}.mkv"}), file=clips)
                (out / f".batch/state/clip{n}.json").write_text(state)
                (out / f"clip{n}").mkdir()
                for name in ("run.json", "displacement.csv"):
                    os.link(work / "two/clip00000" / name, out / f"clip{n}" / name)
        seconds, megabytes = timed([program, "batch", "--collect", "-o", out])
        memory.append(megabytes)
        sizes = [(out / name).stat().st_size / 1e6 for name in ("catalogue.sqlite", "index.html")]
        print(f"| {count} | {seconds:.1f} s | {megabytes:.0f} MB | {sizes[0]:.1f} MB | {sizes[1]:.1f} MB |")
    require(memory[2] < memory[0] + 10, f"the memory is flat: {memory}")
    files = sum(path.is_file() for path in (work / "two/clip00000").iterdir())
    size = sum(path.stat().st_size for path in (work / "two/clip00000").iterdir()) / 1e6
    print(f"\nA run directory of this clip has {files} files and {size:.2f} MB. Its state is one more file.\n")


def main():
    program, work, _ = start()
    program, work = str(pathlib.Path(program).resolve()), work.resolve()  # a list of clips names them relative to itself
    count = int(sys.argv[4]) if len(sys.argv) > 4 else 200
    largest = int(sys.argv[5]) if len(sys.argv) > 5 else 10_000
    parts = sys.argv[6:] or ["local", "slurm", "catalogue"]
    clips = make_clips(program, work, count)
    local_part(program, clips, work, count)
    if "slurm" in parts:
        slurm_part(program, clips, work, count)
    if "catalogue" in parts:
        catalogue_part(program, work, largest)
    for what in failed:
        print(f"not met: {what}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
