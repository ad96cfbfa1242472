#!/usr/bin/python3
"""Checks u of `two-stage` behind blurs, enlargements and a denoiser: smooth_noise.py PROGRAM WORK SOURCE.

They smooth the noise of single pixels. The coarse noise that moves a phase remains, so that errors and u must remain,
too. The camera sways, and the target moves by 0.12 mm. Errors are relative to truth.csv.
"""
import csv
import math

import runs
from runs import insist

program, work, _ = runs.start()
SWAY = [f"rotation.{axis}.{part}" for axis, hertz in zip("xyz", (0.7, 1.1, 0.5))
        for part in ("amplitude=0.15", f"frequency_hz={hertz}", "knots=[[0, 0]]")]
SETTINGS = ["marker.mid.dx.knots=[[0, 0], [4, 0.12]]", "sensor.fps=5", *SWAY]
FRAMES = 40
# Filters of ffmpeg. docs/methods/two-stage.md has a table of the figures that this test prints.
FILTERS = {"blur": "gblur=sigma=0.8", "mean": "avgblur=1", "median": "median=radius=1", "enlarged-1.5": "scale=iw*1.5:-2:flags=lanczos",
           "enlarged-2": "scale=iw*2:-2:flags=bicubic", "denoised": "dctdnoiz=6"}


def measured(video, name):
    """Returns the rms of u_dy in mm and the notes. Checks the errors of all rows."""
    said = runs.run([program, "measure", video, "--site", work / "clip/site.toml", "--method", "two-stage", "-o", work / name]).stderr
    with open(work / "clip/truth.csv", encoding="ascii") as file:
        truth = {(row["frame"], row["marker"]): row for row in csv.DictReader(file)}
    squares, errors = 0.0, []
    for frame, marker, dx, dy, u_dx, u_dy, status in runs.rows(work / name):
        if int(frame) == 0:
            continue
        insist(status == "ok", f"{name}: frame {frame} is {status}")
        squares += float(u_dy) ** 2
        for is_, u, axis in ((dx, u_dx, "dx_mm"), (dy, u_dy, "dy_mm")):
            errors.append(abs(float(is_) - float(truth[frame, marker][axis])) / float(u))
    u, within = math.sqrt(squares / (FRAMES - 1)), sum(error <= 2 for error in errors) / len(errors)
    print(f"{name}: u_dy {1e3 * u:.2f} um, largest error {max(errors):.1f} u, {100 * within:.0f} % of the values within 2 u")
    # A reference frame's error is in all rows. So some of the 78 values may exceed 2 u, but not a third of them, as an
    # error of 2 u of the reference frame would leave.
    insist(within > 0.85, f"{name}: {within:.2f} of the values are within 2 u")
    return u, said


runs.run([program, "simulate", "small-still", "--frames", FRAMES, "--markers-only", "--seed", "1054", "--codec", "ffv1", "-o", work / "clip",
          *[word for setting in SETTINGS for word in ("--set", setting)]])
plain_u, said = measured(work / "clip/video.mkv", "none")
insist("noise of neighbouring pixels" not in said, said)
for name, video_filter in FILTERS.items():
    video = work / f"{name}.mkv"
    runs.run(["ffmpeg", "-nostdin", "-loglevel", "error", "-i", work / "clip/video.mkv", "-vf", video_filter, "-c:v", "ffv1", video])
    u, said = measured(video, name)
    insist("noise of neighbouring pixels" in said, said)
    # u of the excess from 780 slopes, half of them independent, is 6 %.
    insist(abs(u / plain_u - 1) < 0.2, f"{name}: u is {u / plain_u:.2f} of that without the filter")
