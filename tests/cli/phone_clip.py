#!/usr/bin/python3
"""Measures clips of a camera in a moving hand: motion blur in every frame, a rolling shutter, H.264.

A telephone films at 30 frames/s and 1/80 s. The hand rotates it by 6.6 deg/s in frame 0, which blurs the gratings by 5 px of
29 px pitch. Errors are relative to truth.csv.
"""
import math

import runs

program, work, _ = runs.start()
HAND = ["sensor.fps=30", "rotation.x.knots=[[0, 0]]", "rotation.y.amplitude=0.35", "rotation.y.frequency_hz=3", "rotation.x.amplitude=0.21",
        "rotation.x.frequency_hz=2.3", "rotation.x.phase_deg=40", "rotation.z.amplitude=0.3", "rotation.z.frequency_hz=1.9"]


def measured(name, settings, *codec):
    """Returns the number of ok rows, the rms error and rms u of dy (um), and the largest error in u."""
    clip = work / name
    command = [program, "simulate", "small-still", "--frames", 20, "--markers-only", "-o", clip, "--codec", *codec]
    for setting in HAND + settings:
        command += ["--set", setting]
    runs.run(command)
    video = next(clip.glob("video.*"))
    runs.run([program, "measure", video, "--site", clip / "site.toml", "-o", work / f"{name}-out"])
    pairs = runs.errors_of_dy(work / f"{name}-out", clip)
    rms = runs.rms_of(pairs)
    print(name, len(pairs), *rms)
    return len(pairs), *rms, max((abs(e) / u for e, u in pairs), default=math.nan)


# The smear of 0.17 pitch leaves 0.95 of the fundamentals, whose bound is three times that of all edges. So u of the sharp
# clip, times three, is a limit.
ok, error, sharp, worst = measured("sharp", ["sensor.exposure_s=0.002"], "ffv1")
runs.insist(ok == 19 and worst < 4, f"sharp: {ok} ok, {worst} u")
ok, error, u, worst = measured("blurred", ["sensor.exposure_s=0.0125"], "ffv1")
runs.insist(ok == 19 and worst < 4 and u < 3 * sharp and error < u * 2, f"blurred: {ok} ok, {worst} u, error {error} um, u {u} um, sharp {sharp} um")
# Rate and acceleration during the readout double u at most (docs/methods/precise/rolling-shutter.md, parts of `shutter`).
ok, error, u, worst = measured("rolling", ["sensor.exposure_s=0.0125", "sensor.readout_s=0.012"], "ffv1")
runs.insist(ok == 19 and worst < 4 and u < 6 * sharp, f"rolling: {ok} ok, {worst} u, u {u} um, sharp {sharp} um")
# The stated error of the codec covers the shear of the rolling shutter. A stretch of all prints must not take its place: u
# was 2.6 mm then. A tenth of a millimetre is three times the codec's own u.
ok, error, u, worst = measured("rolling-h264", ["sensor.exposure_s=0.0125", "sensor.readout_s=0.012"], "x264", "--quality", 20)
runs.insist(ok == 19 and worst < 4 and u < 100, f"H.264: {ok} ok, {worst} u, u {u} um")
