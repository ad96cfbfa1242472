#!/usr/bin/python3
"""Checks that all outputs state a length that can be checked with a tape measure. A wrong pitch shows in lengths only.

The upper circles of the small rig are 256 mm apart. With a pitch that is ten times too small all outputs state 25.6 mm.
"""
import json
import subprocess
import sys

import numpy

import runs

program, work, _ = runs.start()
clip = work / "clip"
runs.simulate(program, clip, "small-1x", 3)


def longest_white_run(overlay):
    """Returns the length of the scale bar in px: the longest run of pure white, because the scene has at most 210."""
    raw = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", str(overlay), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         capture_output=True, check=True).stdout
    width = int(subprocess.run(["ffprobe", "-loglevel", "error", "-show_entries", "stream=width", "-of", "csv=p=0", str(overlay)],
                               capture_output=True, check=True, text=True).stdout)
    white = (numpy.frombuffer(raw, numpy.uint8).reshape(-1, width, 3) == 255).all(axis=2)
    edges = numpy.diff(white.astype(numpy.int8), axis=1, prepend=0, append=0)
    starts, ends = numpy.argwhere(edges == 1), numpy.argwhere(edges == -1)
    return int((ends[:, 1] - starts[:, 1]).max()), width


def is_round(length):
    """Returns true for 1, 2 or 5 times a power of ten, within 2 %."""
    digits = length / 10.0 ** numpy.floor(numpy.log10(length * 1.02))
    return min(abs(digits / n - 1.0) for n in (1, 2, 5)) < 0.02


for words, distance in ((["--pitch", "10mm"], 256.0), (["--pitch", "1mm"], 25.6), (["--site", clip / "site.toml"], 256.0)):
    out = work / f"out{distance}{words[0]}"
    said = runs.run([program, "measure", clip / "frames", *words, "--fps", 10, "-o", out]).stdout
    run = json.loads((out / "run.json").read_text())
    scale = run["scale"]
    upper = ("R1", "R2") if words[0] == "--pitch" else ("NW", "NE")
    runs.insist((scale["from"], scale["to"]) == upper, f"{words}: {scale}")
    runs.insist(abs(scale["distance_mm"] / distance - 1) < 0.005, f"{words}: {scale}, not {distance} mm")
    runs.insist(abs(scale["mm_per_px"] / (distance / 256 * 1200 / 3478.26) - 1) < 0.005, f"{words}: {scale}")
    text = f"{upper[0]} to {upper[1]} = {distance:g} mm"
    runs.insist(text in said.splitlines()[0] and said.startswith("found: "), f"{text} is not in the first line of {said}")
    report = (out / "report.html").read_text()
    runs.insist(f"{upper[0]} and {upper[1]} are {distance:g} mm apart" in report, f"{words}: the report does not say {distance} mm")
    bar, width = longest_white_run(out / "overlay.png")
    runs.insist(bar > 0.05 * width and is_round(bar * scale["mm_per_px"]),
                f"{words}: a bar of {bar} px is {bar * scale['mm_per_px']} mm")
    seen = runs.run([program, "inspect", clip / "frames", *words, "-o", work / f"seen{distance}{words[0]}"]).stdout
    runs.insist(any(line.startswith("scale: ") and text in line for line in seen.splitlines()), f"{text} is not in {seen}")
    seen = json.loads((work / f"seen{distance}{words[0]}" / "inspect.json").read_text())
    runs.insist(abs(seen["scale"]["distance_mm"] / distance - 1) < 0.005, f"inspect {words}: {seen['scale']}")

seen = runs.run([program, "inspect", clip / "frames", "-o", work / "seen"]).stdout
runs.insist("R1 to R2 = 25.6 pitches" in seen, f"without a pitch: {seen}")
sys.exit(0)
