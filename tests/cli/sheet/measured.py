#!/usr/bin/python3
"""Measures a simulated print of a whole set on one sheet, at 100 dpi.

The markers must be those of its site.toml. A second print has the target 1.5 mm higher and 0.7 mm to the right, and
must give this displacement.
"""
import json
import re
import sys

import pictures
import rendered
import runs

program, work, _ = runs.start()


def measured(pattern, tolerance_mm):
    folder = work / pattern
    runs.run([program, "sheet", "--paper", "A3", "--references", 4, "--pattern", pattern, "--quiet", "-o", folder])
    site = (folder / "site.toml").read_text()
    # Moves the target, which is the last marker, and not its page.
    head, target = site.split("[[target]]")
    moved = head + "[[target]]" + re.sub(r"grating_mm = \[0\.0, 0\.0\]", "grating_mm = [0.7, 1.5]", target)
    runs.insist(moved != site, "no target at the origin")
    (folder / "moved.toml").write_text(moved)
    runs.run([program, "sheet", "--paper", "A3", "--site", folder / "moved.toml", "--quiet", "-o", folder / "moved"])
    frames = folder / "frames"
    frames.mkdir()
    for i, pdf in enumerate([folder / "sheets.pdf", folder / "moved" / "sheets.pdf"]):
        pictures.write_png(frames / f"{i}.png", rendered.binned(rendered.page(pdf, 600), 6))
    seen = json.loads(runs.run([program, "inspect", frames / "0.png", "--site", folder / "site.toml", "--json",
                                "-o", folder / "seen"]).stdout)
    runs.insist(seen["measurable"], "inspect cannot measure it")
    # With the pitch only, the positions agree with site.toml within 0.3 %: gratings of four pitches determine the scale
    # of the board no better.
    runs.run([program, "measure", frames, "--pitch", "10mm", "--tone", "linear", "--method", "two-stage", "--quiet", "-o", folder / "blind"])
    blind = json.loads((folder / "blind" / "run.json").read_text())["markers"]
    stated = [(float(x), float(y)) for x, y in re.findall(r"grating_mm = \[([-0-9.]+), ([-0-9.]+)\]", site)]
    for (x, y), marker in zip(stated, blind):
        runs.insist(abs(marker["x_mm"] - x) < 0.4 and abs(marker["y_mm"] - y) < 0.4, f"{marker} is not at {x}, {y}")
        runs.insist(abs(marker["pitch_px"] - 100 / 2.54) < 0.04, f"{marker['name']}: pitch {marker['pitch_px']} px")
    for method in ("two-stage", "precise"):
        runs.run([program, "measure", frames, "--site", folder / "site.toml", "--tone", "linear", "--method", method, "--quiet", "-o", folder / method])
        frame, name, dx, dy, _, _, status = runs.rows(folder / method)[1]
        runs.insist(status == "ok" and abs(float(dx) - 0.7) < tolerance_mm and abs(float(dy) - 1.5) < tolerance_mm,
                    f"{pattern}, {method}: {dx}, {dy}, {status}; printed 0.7, 1.5")


# A dot of 1/600 inch is 42 um. The edges of lines have errors below a quarter of a dot, averaged over ten edges.
measured("grid", 0.003)
# Grey levels have dots of 1/300 inch. A renderer that selects the nearest dot has an error of a quarter of a dot.
measured("cosine", 0.021)
sys.exit(0)
