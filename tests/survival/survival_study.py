"""Tests killed runs and failing calls, and prints a table. Stops at the first requirement that is not met.

    survival_study.py PROGRAM LIBRARY WORK [KILLS]
"""
import concurrent.futures
import errno
import pathlib
import shutil
import sys
import time

from injections import Injections
from kills import Kills
from survival import clear, contents, done, insist, long_clip, measure

program, library, work = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
KILLS = int(sys.argv[4]) if len(sys.argv) > 4 else 240  # some come after the end of the run
SECONDS = 1.5  # duration of a run
LOST_S = 1.0  # largest loss in s
shutil.rmtree(work, ignore_errors=True)
for name in ("kills", "calls"):
    (work / name).mkdir(parents=True)


def clip_of_seconds():
    """Makes a clip with the number of frames that takes SECONDS to measure."""
    clip, site = long_clip(program, work / "kills", 3000)
    seconds = {}
    for frames in (100, 400):
        begun = time.monotonic()
        run = done(measure(program, clip, site, work / "kills/timed", "--frames", f"0:{frames}"))
        seconds[frames] = time.monotonic() - begun
        insist(run.returncode == 0, run.stderr)
        clear(work / "kills/timed")
    frames = int(400 + (SECONDS - seconds[400]) * 300 / max(seconds[400] - seconds[100], 1e-3))
    frames = min(max(frames, 200), 3000)
    for path in sorted(clip.iterdir())[frames:]:
        path.unlink()
    return clip, site, frames


def kill():
    clip, site, frames = clip_of_seconds()
    workers = [Kills(program, library, clip, site, work / f"kills/out{n}", frames, SECONDS) for n in range(2)]
    for _ in range(2):
        begun = time.monotonic()
        clear(workers[0].out)
        insist(done(workers[0].plain).returncode == 0, "the plain run")
        for worker in workers:
            worker.seconds = 1.1 * (time.monotonic() - begun)
    wanted = contents(workers[0].out)
    with concurrent.futures.ThreadPoolExecutor(len(workers)) as pool:
        jobs = [pool.submit(lambda w=w, n=n: [w.one(wanted, seed) for seed in range(n, KILLS, len(workers))])
                for n, w in enumerate(workers)]
        for job in jobs:
            job.result()
    print(f"\n| kill -9 at a random moment of a run of {frames} frames, {workers[0].seconds / 1.1:.1f} s | {KILLS} |\n|---|---|")
    for phase in workers[0].phase:
        print(f"| {phase} | {sum(w.phase[phase] for w in workers)} |")
    kept, synced = max(w.kept_late for w in workers), max(w.synced_late for w in workers)
    print("| unreadable journals | 0 |\n| old results touched | 0 |")
    print(f"| longest time from the last frame kept to the kill | {kept:.2f} s |")
    print(f"| longest time that a power cut then would have cost | {synced:.2f} s |")
    print("| `--resume` ends in the bytes of a run in one piece | all |")
    insist(max(kept, synced) <= LOST_S, f"more than {LOST_S} s lost")


def fail_every_call():
    clip, site = long_clip(program, work / "calls", 6)
    states = {"nothing": "into a new folder", "finished": "over old results", "unfinished": "with `--resume`"}
    ways = {"once, no space": [(errno.ENOSPC, "once")], "once, input/output error": [(errno.EIO, "once")],
            "and all after it": [(errno.ENOSPC, "on")], "half done": [(errno.ENOSPC, "short")]}
    jobs = [(state, way) for state in states for way in ways]

    def one(job):
        injections = Injections(program, library, clip, site, work / f"calls/out-{jobs.index(job)}")
        injections.all([job[0]], ways[job[1]])
        return injections

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        found = dict(zip(jobs, pool.map(one, jobs)))
    print("\n| every call that writes fails in turn | " + " | ".join(ways) + " |\n|---|" + "---|" * len(ways))
    for state, words in states.items():
        print(f"| {words} | " + " | ".join(str(found[state, way].count) for way in ways) + " |")
    total = sum(injections.count for injections in found.values())
    by_call = {}
    for injections in found.values():
        for call, count in injections.by_call.items():
            by_call[call] = by_call.get(call, 0) + count
    calls = ", ".join(f"{count} {call}" for call, count in sorted(by_call.items()))
    print(f"\n{total} injections ({calls}): each time exit 6 and one line, old results whole, nothing half written, the journal\n"
          "readable, and `--resume` ends in the bytes of a run in one piece.")
    insist(total >= 300, "fewer than 300 injections")


kill()
fail_every_call()
shutil.rmtree(work)
