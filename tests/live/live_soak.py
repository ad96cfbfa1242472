"""Runs `live` for a day of footage at twenty times its pace. States memory, gaps and wrong rows."""
import json
import math
import time

import numpy

from memory import descendants, private_bytes
from trial import FEW, MAX_U, Figures, finish, frames_of, insist, start, whole_rows

FPS, PACE, FOOTAGE_S = 10, 20, 86400  # frames/s of the footage, and its length
SEGMENT_S = 3600  # in the time of the footage
STEP_S = 5.0
WARM_UP = 0.25  # share of the time: caches fill
MAX_RISE = 1.0  # MB per hour of footage
S_PER_H = 3600.0
MB = 1e6


def without_compression(picture):
    """Returns a picture of the same grey levels whose decoding costs next to nothing, as a camera's frames."""
    out = picture.with_suffix(".tif")
    finish(("ffmpeg", "-loglevel", "error", "-i", picture, "-compression_algo", "raw", out))
    return out


def memory_until_end(live):
    """Returns times (hours of footage) and private memory (MB) of a run, all its processes together."""
    begin, at_h, used = time.monotonic(), [], []
    while live.poll() is None:
        processes = [live.pid, *(number for number, _ in descendants(live.pid))]
        bytes_ = sum(value for value in map(private_bytes, processes) if not math.isnan(value))
        at_h.append((time.monotonic() - begin) * PACE / S_PER_H)
        used.append(bytes_ / MB)
        time.sleep(STEP_S)
    return numpy.array(at_h[:-1]), numpy.array(used[:-1])  # the last one may be of a run that ends


def soak(trial):
    """A day of footage at twenty times its pace"""
    seconds = max(30 * PACE, round(FOOTAGE_S * trial.scale))
    trial.clip(seconds * FPS + 2 * FEW, without_compression)
    out = trial.work / "soak"
    words = [trial.program, "live", trial.frames, "--site", trial.site, "--fps", FPS, "--pace", PACE, "--segment", f"{SEGMENT_S}s",
             "--for", f"{seconds}s", "-o", out, "--quiet"]
    live = start(words)
    at_h, used = memory_until_end(live)
    insist(live.returncode in (0, 5), f"exit {live.returncode}")
    later = at_h >= WARM_UP * at_h[-1]
    (rise, _), covariance = numpy.polyfit(at_h[later], used[later], 1, cov=True)
    folders = sorted(out.glob("segment-*"))
    rows = [row for folder in folders for row in whole_rows(folder / "live.csv")]
    lost = sum(json.loads((folders[-1] / "live.json").read_text())["lost_frames"].values())  # since the start of the run
    frames = frames_of(rows)
    gaps = frames[-1] + 1 - len(frames) - lost
    wrong, ok = trial.count_wrong(rows), sum(row["status"] == "ok" for row in rows)
    figures = Figures()
    figures.add(f"{at_h[-1]:.1f} h of footage at {PACE} x its pace: memory rises by < {MAX_RISE:.0f} MB/h",
                f"{rise:+.2f} +- {math.sqrt(covariance[0][0]):.2f} MB per hour of footage, {used[later].mean():.0f} MB on average, "
                f"{len(folders)} segments", rise < MAX_RISE)
    figures.add("0 unexplained gaps", f"{gaps} of {frames[-1] + 1} frames neither in a row nor counted as lost; {lost} lost", gaps == 0)
    figures.add("0 wrong rows", f"{wrong} above {MAX_U} u ({ok} of {len(rows)} ok)", wrong == 0 and 2 * ok > len(rows))
    return figures
