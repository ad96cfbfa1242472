#!/usr/bin/python3
"""Checks pitch, positions and rulers of a set printed at 600 dpi, in mm on paper.

The position of an edge follows from the grey level of the dot that it cuts. Poppler has four levels per dot, so the
error is below a quarter of a dot, 11 um. A pitch from the outer lines of n is n times more precise. The requirement is
10 um.
"""
import re
import sys
import tomllib

import numpy

import rendered
import runs

program, work, _ = runs.start()
DPI = 600
MM = 25.4 / DPI


def edges(line):
    """Returns the positions in mm, from the left end, at which the grey level crosses the mid-level."""
    dark = 1.0 - line / 255.0
    inside = dark > 0.5
    out = []
    for i in numpy.flatnonzero(inside[1:] != inside[:-1]):
        # The edge cuts the dot that is partly dark, on one of the two sides.
        partly = i if 0.0 < dark[i] < 1.0 else i + 1
        share = dark[partly] if 0.0 < dark[partly] < 1.0 else (0.0 if partly > i else 1.0)
        rising = inside[i + 1]
        if 0.0 < dark[partly] < 1.0:
            out.append((partly + (1.0 - share if rising else share)) * MM)
        else:
            out.append((i + 1) * MM)
    return numpy.array(out)


def lines(line, pitch):
    """Returns the centres in mm of the dark lines that are half a pitch wide."""
    e = edges(line)
    pairs = [(a, b) for a, b in zip(e[0::2], e[1::2]) if abs((b - a) - pitch / 2) < 0.1]
    return numpy.array([(a + b) / 2 for a, b in pairs])


def centre(marker, page_middle, set_middle):
    x, y = marker["grating_mm"]
    return page_middle[0] + x - set_middle[0], page_middle[1] - (y - set_middle[1])


def check_pitch(picture, site, pitch):
    """Checks the pitch along x and y of all gratings, between crossing lines. Returns their middles in mm."""
    starts = {}
    for marker in site["reference"] + site["target"]:
        found = {}
        for axis in "xy":
            x, y = (value / MM for value in marker["at"])
            half = marker["grating_size_mm"][0] / 2 / MM
            off = pitch / 2 / MM  # dots, middle between two lines
            strip = picture[round(y + off), round(x - half - 20):round(x + half + 20)] if axis == "x" else \
                picture[round(y - half - 20):round(y + half + 20), round(x + off)]
            start = round(x - half - 20) if axis == "x" else round(y - half - 20)
            found[axis] = lines(strip.astype(float), pitch) + start * MM
            whole = [c for c in found[axis] if abs(c - (x if axis == "x" else y) * MM) < half * MM - pitch / 3]
            measured = (whole[-1] - whole[0]) / (len(whole) - 1)
            runs.insist(len(whole) >= 3, f"{marker['name']}: lines not found along {axis}: {found[axis]}")
            runs.insist(abs(measured - pitch) < 0.010, f"{marker['name']}: pitch along {axis} {measured:.4f}, not {pitch}")
            middle = numpy.mean(whole)
            starts[marker["name"], axis] = middle
    return starts


def main(pitch):
    folder = work / f"set{pitch}"
    runs.run([program, "sheet", "--paper", "A3", "--pitch", f"{pitch}mm", "--quiet", "-o", folder])
    site = tomllib.loads((folder / "site.toml").read_text())
    picture = rendered.page(folder / "sheets.pdf", DPI)
    runs.insist(abs(picture.shape[1] * MM - 420) < 0.1 and abs(picture.shape[0] * MM - 297) < 0.1, f"page {picture.shape}")
    middle = (19 + (420 - 26) / 2, 15 + (297 - 39) / 2)  # mm, middle of the area without rulers and text
    markers = site["reference"] + site["target"]
    low = [min(min(m["grating_mm"][k] - m["grating_size_mm"][k] / 2,
                   m["circle_mm"][k] - m["circle_diameter_mm"] / 2 if "circle_mm" in m else 1e9) for m in markers) for k in (0, 1)]
    high = [max(max(m["grating_mm"][k] + m["grating_size_mm"][k] / 2,
                    m["circle_mm"][k] + m["circle_diameter_mm"] / 2 if "circle_mm" in m else -1e9) for m in markers) for k in (0, 1)]
    for m in markers:
        m["at"] = centre(m, middle, [(a + b) / 2 for a, b in zip(low, high)])
    found = check_pitch(picture, site, pitch)
    # Relative positions of the gratings must be those of site.toml, within a quarter of a dot at each end.
    for m in markers:
        for k, axis in enumerate("xy"):
            stated = (m["grating_mm"][k] - markers[0]["grating_mm"][k]) * (1 if axis == "x" else -1)
            printed = found[m["name"], axis] - found[markers[0]["name"], axis]
            runs.insist(abs(printed - stated) < 0.022, f"{m['name']}: {axis} {printed:.3f} from NW, site.toml {stated:.3f}")
    # Circles are measured by the chords through the middle, along both axes.
    for m in site["reference"]:
        x = m["at"][0] + m["circle_mm"][0] - m["grating_mm"][0]
        y = m["at"][1] - (m["circle_mm"][1] - m["grating_mm"][1])
        reach = m["circle_diameter_mm"] * 0.75
        for k, strip in enumerate([picture[round(y / MM), round((x - reach) / MM):round((x + reach) / MM)],
                                   picture[round((y - reach) / MM):round((y + reach) / MM), round(x / MM)]]):
            e = edges(strip.astype(float))
            inner = [v for v in e if abs(v - reach) < m["circle_diameter_mm"] * 0.6]
            runs.insist(len(inner) == 2, f"{m['name']}: circle: {e}")
            runs.insist(abs(inner[1] - inner[0] - m["circle_diameter_mm"]) < 0.022, f"{m['name']}: diameter {inner[1] - inner[0]:.3f}")
            here = (x, y)[k]
            offset = round((here - reach) / MM) * MM + (inner[0] + inner[1]) / 2 - here
            runs.insist(abs(offset) < 0.022, f"{m['name']}: circle off by {offset:.3f} mm")
    # Rulers have long ticks at intervals of 100 mm.
    check_ruler("x", picture[round((297 - 17 + 2.6) / MM), :])
    check_ruler("y", picture[:, round((13 - 4.5 + 2.6) / MM)])


def check_ruler(axis, across):
    dark = numpy.flatnonzero(across < 128)
    groups = [group.mean() for group in numpy.split(dark, numpy.flatnonzero(numpy.diff(dark) > 10) + 1)]
    runs.insist(abs((groups[-1] - groups[0]) * MM - 100) < MM, f"{axis} ruler {(groups[-1] - groups[0]) * MM:.3f} mm")


def svg():
    """Checks the SVG, whose numbers are in mm: vertical lines are rectangles half a pitch wide."""
    folder = work / "svg"
    runs.run([program, "sheet", "--paper", "A3", "--pitch", "7mm", "--pattern", "lines-x", "--quiet", "-o", folder])
    text = (folder / "set.svg").read_text()
    runs.insist('width="420mm"' in text, "no width in mm")
    path = max(re.findall(r' d="(M [^"]*)"', text), key=lambda d: d.count("Z"))
    first = sorted({float(v) for v in re.findall(r"M (-?[0-9.]+)", path)})
    steps = numpy.diff(first)
    runs.insist(len(steps) > 3, "no lines in the SVG")
    runs.insist(numpy.all(abs(steps[1:-1] - 7.0) < 0.010), f"lines {steps}")
    runs.insist(abs(numpy.mean(steps[1:-1]) - 7.0) < 0.005, f"mean {numpy.mean(steps[1:-1])}")


for p in (10, 7.3):
    main(p)
svg()
first, second = work / "set10", work / "again"
runs.run([program, "sheet", "--paper", "A3", "--pitch", "10mm", "--quiet", "-o", second])
for name in ("sheets.pdf", "mounting.pdf", "set.svg", "site.toml"):
    runs.insist((first / name).read_bytes() == (second / name).read_bytes(), f"{name}: other bytes the second time")
sys.exit(0)
