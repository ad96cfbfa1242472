"""Measures a camera of 4096 x 2168 px in memory: losses, share of a core, latency, and the highest rate."""
import re
import shutil

from trial import Figures, frames_of, insist, start, whole_rows

FPS, SECONDS = 42, 600
FAST_FPS, FAST_SECONDS = 300, 30
START_S = 2  # the reference frame is learned, and the first scene is solved
MAX_CORE, MAX_P50_MS, MAX_P99_MS = 25.0, 10.0, 24.0
LINE = re.compile(r"measured ([\d.]+) frames/s, lost (\d+) .*?; ([\d.]+) % of a core; latency p50 ([\d.]+) ms, p99 ([\d.]+) ms, max ([\d.]+) ms; "
                  r"scenes \d+; rows ok (\d+) of (\d+)")


class Bench:
    """The figures of one run of live_bench."""

    def __init__(self, trial, fps, seconds):
        out = trial.work / "bench"
        unfinished = out.with_name("bench.unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        done = start([trial.neighbour("live_bench"), fps, max(5, round(seconds * trial.scale)), out], stdout=-1, stderr=-1)
        text, errors = done.communicate()
        found = LINE.search(text)
        insist(found, f"live_bench: exit {done.returncode}: {text}{errors}")
        self.rate, self.core, self.p50_ms, self.p99_ms, self.max_ms = (float(found[k]) for k in (1, 3, 4, 5, 6))
        self.lost, self.ok, self.rows = (int(found[k]) for k in (2, 7, 8))
        self.frames = frames_of(whole_rows(unfinished / "live.csv"))

    def lost_from(self, first):
        """Returns the number of frames lost after frame `first`."""
        later = [n for n in self.frames if n >= first]
        return later[-1] - later[0] + 1 - len(later)


def speed(trial):
    """4096 x 2168 px from memory"""
    figures = Figures()
    slow = Bench(trial, FPS, SECONDS)
    figures.add(f"4096 x 2168 px, 8 bits, at {FPS} frames/s for {SECONDS} s from memory, 5 markers, `precise`: 0 lost", f"{slow.lost} lost",
                slow.lost == 0)
    figures.add(f"<= {MAX_CORE:.0f} % of a core", f"{slow.core:.1f} %", slow.core <= MAX_CORE)
    figures.add(f"latency p50 <= {MAX_P50_MS:.0f} ms, p99 <= {MAX_P99_MS:.0f} ms",
                f"{slow.p50_ms:.2f} ms, {slow.p99_ms:.2f} ms (largest {slow.max_ms:.1f} ms); {slow.ok} of {slow.rows} rows ok",
                slow.p50_ms <= MAX_P50_MS and slow.p99_ms <= MAX_P99_MS)
    return figures


def rate(trial):
    """The highest rate without loss"""
    figures = Figures()
    fast, free = Bench(trial, FAST_FPS, FAST_SECONDS), Bench(trial, 0, FAST_SECONDS)
    later = fast.lost_from(START_S * FAST_FPS)
    figures.add(f"highest rate without loss >= {FAST_FPS} frames/s, after the first {START_S} s",
                f"{later} lost at {FAST_FPS} frames/s for {FAST_SECONDS} s ({fast.lost_from(0)} in all, with the first {START_S} s); "
                f"{free.rate:.0f} frames/s without a pace", later == 0 and free.rate >= FAST_FPS)
    return figures
