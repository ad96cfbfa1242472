#!/usr/bin/python3
"""Tests rotated and mirrored images of a sheet.

The larger circle of a sheet shows its orientation: an image rotated by 180 degrees is measured correctly, a mirrored
one is refused. A layout that is its own mirror image is measured, with a note that images do not show whether they are
mirrored.
"""
import json
import sys

import pictures
import rendered
import runs

program, work, _ = runs.start()
runs.run([program, "sheet", "--paper", "A3", "--quiet", "-o", work / "set"])
site = (work / "set" / "site.toml").read_text()
head, target = site.split("[[target]]")
(work / "moved.toml").write_text(head + "[[target]]" + target.replace("grating_mm = [0.0, 0.0]", "grating_mm = [0.7, 1.5]"))
runs.run([program, "sheet", "--paper", "A3", "--site", work / "moved.toml", "--quiet", "-o", work / "moved"])
PAGES = [rendered.binned(rendered.page(work / name / "sheets.pdf", 600), 6) for name in ("set", "moved")]
FLIPS = {"upright": lambda p: p, "half-turned": lambda p: p[::-1, ::-1], "mirrored": lambda p: p[:, ::-1], "upside-down": lambda p: p[::-1]}
runs.insist("circle_diameter_mm = 25" in site, f"no larger circle in {site}")
for name, flip in FLIPS.items():
    frames = work / name
    frames.mkdir()
    for i, page in enumerate(PAGES):
        pictures.write_png(frames / f"{i}.png", flip(page).copy())
    refused = name in ("mirrored", "upside-down")
    done = runs.run([program, "measure", frames, "--site", work / "set" / "site.toml", "--tone", "linear", "--quiet", "-o", work / f"{name}-out"],
                    expected=4 if refused else 0)
    if refused:
        runs.insist(done.stderr.startswith("error: "), done.stderr)
        continue
    _, _, dx, dy, _, _, status = runs.rows(work / f"{name}-out")[1]
    runs.insist(status == "ok" and abs(float(dx) - 0.7) < 0.003 and abs(float(dy) - 1.5) < 0.003, f"{name}: {dx}, {dy}, {status}")
    warnings = json.loads((work / f"{name}-out" / "run.json").read_text())["warnings"]
    runs.insist(not any("unnoticed" in w for w in warnings), f"{name}: {warnings}")

runs.simulate(program, work / "rig", "small-1xyz", 4, "--quiet")
runs.run([program, "measure", work / "rig", "--site", work / "rig" / "site.toml", "--fps", 10, "--quiet", "-o", work / "rig-out"])
warnings = json.loads((work / "rig-out" / "run.json").read_text())["warnings"]
runs.insist(any(w.startswith("note: a mirrored, upside-down or half-rotated image cannot be recognised") for w in warnings), f"{warnings}")
runs.insist("cannot be recognised" in (work / "rig-out" / "report.html").read_text(), "the report does not say it")
sys.exit(0)
