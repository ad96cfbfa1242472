#!/usr/bin/python3
"""Tests non-linear grey levels, and sites with small uncertainties.

A camera hovers 8 m in front of a wall; the pitch is 60 mm or 21 px. The depth of a target changes the size of its
grating by 1.3e-4 per mm. A tone curve makes a change of blur look like such a change. Requires errors of 10 um rms with
the usual site file, and no ok row with an error above 5 u.
"""
import csv
import json
import math
import sys

import runs

program, work, _ = runs.start()

WALL = """
[camera]
width = 3840
height = 2160
fx = 2800
fy = 2800
cx = 1921.3
cy = 1078.4
[mount]
distance_mm = 8000
[sensor]
fps = 10
exposure_s = 0.002
"""
MARKERS = {"NW": (-2700, 1100), "NE": (2700, 1100), "SW": (-2700, -1100), "SE": (2700, -1100), "T1": (0, 0), "T2": (1300, 150)}


def scenario():
    text = "frames = 40\nseed = 1\n" + WALL
    for axis in "xyz":
        text += f"[rotation.{axis}]\nrandom = 3\n[shift.{axis}]\nrandom = 500\n"
    for name, (x, y) in MARKERS.items():
        target = name.startswith("T")
        text += f'[[marker]]\nname = "{name}"\nrole = "{"target" if target else "reference"}"\n'
        if not target:
            text += f"circle_mm = [{x + math.copysign(450, x)}, {y}]\ncircle_diameter_mm = 200\n"
        text += f"grating_mm = [{x}, {y}]\ngrating_size_mm = [480, 480]\npitch_mm = 60\n"
        if name == "T1":
            text += "[marker.dy]\namplitude = 3\nfrequency_hz = 0.7\n"
    return text


def samples(out, truth):
    """Returns the errors in mm of the ok rows, with their u, over all targets and both axes."""
    known = {(r["frame"], r["marker"]): r for r in csv.DictReader(truth.open())}
    run = json.loads((out / "run.json").read_text())
    rows, ok = [], 0
    for r in csv.DictReader((out / "displacement.csv").open()):
        if int(r["frame"]) == run["reference_frame"]:
            continue
        if r["status"] != "ok":
            continue
        ok += 1
        for axis in ("dx", "dy"):
            first = float(known[str(run["reference_frame"]), r["marker"]][f"{axis}_mm"])
            error = float(r[f"{axis}_mm"]) - float(known[r["frame"], r["marker"]][f"{axis}_mm"]) + first
            rows.append((axis, error, float(r[f"u_{axis}_mm"])))
    return run, rows, ok


def rms(rows, axis):
    errors = [e for a, e, _ in rows if a == axis]
    return math.sqrt(sum(e * e for e in errors) / len(errors))


def lies(rows):
    return sum(1 for _, e, u in rows if abs(e) > 5 * u and abs(e) > 5e-4)


# 1. Tone curves.
(work / "wall.toml").write_text(scenario())
for gamma, given, source in ((1, [], "tag"), (2.2, [], None), (2.6, [], None), (2.2, ["--tone", "gamma:2.2"], "option")):
    name = f"wall-{gamma}{'-given' if given else ''}"
    clip = work / f"wall-{gamma}"
    if not clip.exists():
        runs.simulate(program, clip, work / "wall.toml", 40, "--set", f"sensor.gamma={gamma}", "--markers-only")
        site = (clip / "site.toml").read_text()
        (clip / "site.toml").write_text(site.split("[known_to]")[0])
    runs.run([program, "measure", clip / "frames", "--site", clip / "site.toml", "--fps", 10, "--quiet", *given, "-o", work / f"{name}-out"])
    run, rows, ok = samples(work / f"{name}-out", clip / "truth.csv")
    tone = run["input"]["tone"], run["input"]["tone_source"]
    runs.insist(ok == 78, f"{name}: {ok} of 78 rows are ok")
    runs.insist(lies(rows) == 0, f"{name} ({tone}): {lies(rows)} values off by more than 5 u")
    for axis in ("dx", "dy"):
        runs.insist(rms(rows, axis) < 0.010, f"{name} ({tone}): {axis} off by {1e3 * rms(rows, axis):.1f} um rms")
    if gamma == 1:
        runs.insist(tone == ("linear", "tag"), f"{name}: {tone}")
    elif source:
        runs.insist(tone == ("gamma:2.2", source), f"{name}: {tone}")
    else:
        runs.insist(tone[0] != "linear", f"{name}: {tone}")

# 2. Surveyed positions with an unknown lens: its distortion is 0.2 mm between a circle and its grating.
clip = work / "surveyed"
runs.simulate(program, clip, "rig-8xyz", 20, "--set", "lens.k1=-0.032", "--set", "lens.k2=0.009", "--set", "sensor.fps=1.25", "--markers-only")
known = "[known_to]\nposition_mm = 0.01\nrotation_deg = 0.001\nheight_mm = 0.01\nprint_scale = 0.000001\n"
(clip / "surveyed.toml").write_text((clip / "site.toml").read_text().split("[known_to]")[0] + known)
runs.run([program, "measure", clip / "frames", "--site", clip / "surveyed.toml", "--fps", 1.25, "--quiet", "-o", work / "surveyed-out"])
run, rows, ok = samples(work / "surveyed-out", clip / "truth.csv")
runs.insist(ok == 19, f"surveyed: {ok} of 19 rows are ok")
runs.insist(lies(rows) == 0, f"surveyed: {lies(rows)} values off by more than 5 u")
runs.insist(rms(rows, "dy") < 0.002, f"surveyed: dy off by {1e3 * rms(rows, 'dy'):.2f} um rms")

# 3. Edges sharper than the pixels are asymmetric without a tone curve. A grey video without a tag stays linear.
for psf in (0.4, 0.6):
    clip, out = work / f"sharp-{psf}", work / f"sharp-{psf}-out"
    runs.simulate(program, clip, "small-1x", 4, "--set", f"sensor.psf_sigma_px={psf}", "--codec", "ffv1")
    runs.run([program, "measure", clip / "video.mkv", "--site", clip / "site.toml", "--quiet", "-o", out])
    run, rows, ok = samples(out, clip / "truth.csv")
    runs.insist(run["input"]["tone"] == "linear", f"PSF of {psf} px: {run['input']['tone']}")
    runs.insist(ok == 3 and lies(rows) == 0, f"PSF of {psf} px: {ok} of 3 rows are ok, {lies(rows)} lies")
sys.exit(0)
