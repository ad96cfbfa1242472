#!/usr/bin/python3
"""Compares the prediction of `plan` with the result of `measure`.

u by noise (grating, references, reference frame) must agree within 15 % along both axes. The bound of the layout must
agree within 8 %; run.json computes it with each grating as one point at its middle. The other parts of u (unknown lens,
positions and rotations) cannot be planned and are excluded.
"""
import json
import math
import sys

import runs

program, work, _ = runs.start()
LENS = ["--distance", "1.2m", "--pixel", "3.45um", "--focal", "12mm"]
CASES = {  # scenario, frames, settings, words for plan
    "small": ("small-1xyz", 12, [], ["--resolution", "1024x512"]),
    "fine_noisy": ("small-0.1x", 12, ["noise.sigma=3", "grating.pitch_mm=6"], ["--resolution", "1024x512", "--noise", 3]),
    "checkerboard": ("small-1xyz", 12, ["grating.pattern=checkerboard", "light.white=150"],
                     ["--resolution", "1024x512", "--contrast", 110]),
    "rig": ("rig-1xyz", 6, [], ["--resolution", "4104x1012"]),
}

for name, (scenario, frames, settings, words) in CASES.items():
    runs.simulate(program, work / name, scenario, frames, "--quiet", *[w for s in settings for w in ("--set", s)])
    site = ["--site", work / name / "site.toml"]
    runs.run([program, "measure", work / name, *site, "--fps", 10, "--quiet", "-o", work / f"{name}-out"])
    stated = json.loads((work / f"{name}-out" / "run.json").read_text())["targets"][0]
    planned = json.loads(runs.run([program, "plan", *LENS, *words, *site, "--json"]).stdout)["targets"][0]
    for axis in "xy":
        noise = math.hypot(*(stated["budget"][part][f"{axis}_mm"] for part in ("noise", "references", "reference_frame")))
        ratio = noise / planned["u_mm"][axis]
        runs.insist(1 / 1.15 < ratio < 1.15, f"{name}: u along {axis} {noise}, planned {planned['u_mm'][axis]}: {ratio:.3f}")
    ratio = stated["bound_mm"]["y"] / planned["bound_mm"]["y"]
    runs.insist(abs(ratio - 1) < 0.08, f"{name}: bound along y {stated['bound_mm']}, planned {planned['bound_mm']}")

# For compressed footage plan, inspect and measure state the same u. plan assumes a typical quantiser, within a factor
# of 1.7.
clip = work / "clip"
runs.run([program, "simulate", "small-1x", "--frames", 30, "--codec", "x264", "--quality", 20, "--quiet", "-o", clip])
words = [next(clip.glob("video.*")), "--site", clip / "site.toml", "--quiet"]
runs.run([program, "measure", *words, "-o", work / "clip-out"])
stated = json.loads((work / "clip-out" / "run.json").read_text())["targets"][0]
u = json.loads(runs.run([program, "inspect", *words, "--json", "-o", work / "clip-seen"]).stdout)["expected"][0]
planned = json.loads(runs.run([program, "plan", *LENS, "--resolution", "1024x512", "--compressed", "--site", clip / "site.toml",
                               "--json"]).stdout)["targets"][0]
for axis in "xy":
    parts = ("noise", "references", "reference_frame", "codec")
    total = math.hypot(*(stated["budget"][part][f"{axis}_mm"] for part in parts))
    runs.insist(1 / 1.7 < u[f"u_d{axis}_mm"] / total < 1.7, f"inspect: u along {axis} {u}, measured {total}")
    runs.insist(1 / 1.7 < planned["u_mm"][axis] / total < 1.7, f"plan: u along {axis} {planned}, measured {total}")

# The advice must equal the plan of the changed layout.
rig = ["--distance", "1.2m", "--resolution", "4104x1012", "--pixel", "3.45um", "--focal", "12mm"]
site = (work / "rig" / "site.toml").read_text()
plan = json.loads(runs.run([program, "plan", *rig, "--site", work / "rig" / "site.toml", "--json"]).stdout)
advice = next(line for line in plan["advice"] if "Move NW and NE up by" in line)
metres = float(advice.split("up by ")[1].split(" m")[0])
moved = site.replace(", 28.0]", f", {28.0 + 1000 * metres}]", 4)
(work / "moved.toml").write_text(moved)
again = json.loads(runs.run([program, "plan", *rig, "--site", work / "moved.toml", "--json"]).stdout)
promised = float(advice.split("u_dx ")[-1].split(" um")[0])
runs.insist(abs(1000 * again["targets"][0]["u_mm"]["x"] / promised - 1) < 0.02, f"{advice}: {again['targets']}")
sys.exit(0)
