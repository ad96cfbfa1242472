#!/usr/bin/python3
"""Markers larger than the paper: joined parts of A4 equal the marker printed on A0, and their marks meet.

Also: six references are the default where they fit, and the stated pitch is one with which they do.
"""
import re
import subprocess

import numpy

import rendered
import runs

program, work, _ = runs.start()
DPI = 100
LEFT, RIGHT, TOP, BOTTOM, OVERLAP = 19.0, 7.0, 15.0, 24.0, 10.0  # mm, margins and glued strip
SET = ["--pitch", "45mm", "--span", "1500x1200mm", "--targets", 1, "--references", 4]


def px(mm):
    return numpy.round(numpy.asarray(mm) * DPI / 25.4 - 0.5).astype(int)


parts = runs.run([program, "sheet", *SET, "-o", work / "a4"])
columns, rows = (int(n) for n in re.search(r"T1 (\d+) x (\d+)", parts.stderr).groups())
runs.insist(columns * rows > 1, f"T1 is in parts: {parts.stderr}")
runs.run([program, "sheet", *SET, "--separate", "--paper", "A0", "-o", work / "a0"])
pages = int(re.search(r"on (\d+) sheets of A4", parts.stdout).group(1))
shown = subprocess.run(["pdfinfo", str(work / "a4" / "sheets.pdf")], capture_output=True, text=True, check=True).stdout
runs.insist(int(re.search(r"Pages: +(\d+)", shown).group(1)) == pages, f"{pages} pages: {shown}")

# The drawing for laser cutters is whole: its size is that of the marker's area and the margins.
svg = (work / "a4" / "T1.svg").read_text(encoding="utf-8")
width = float(re.search(r'width="([\d.]+)mm"', svg).group(1)) - LEFT - RIGHT
height = float(re.search(r'height="([\d.]+)mm"', svg).group(1)) - TOP - BOTTOM
part_width, part_height = (width + (columns - 1) * OVERLAP) / columns, (height + (rows - 1) * OVERLAP) / rows
step_x, step_y = part_width - OVERLAP, part_height - OVERLAP
images = [rendered.page(work / "a4" / "sheets.pdf", DPI, pages - columns * rows + 1 + k) for k in range(columns * rows)]
whole = rendered.page(work / "a0" / "sheets.pdf", DPI, 5)  # T1 is the last of five markers
whole_height, whole_width = whole.shape
middle_x = LEFT + 0.5 * (whole_width * 25.4 / DPI - LEFT - RIGHT)
middle_y = TOP + 0.5 * (whole_height * 25.4 / DPI - TOP - BOTTOM)

# Points of the joined marker, each from the part that shows it after cutting in the middle of the overlap.
rng = numpy.random.default_rng(1)
x, y = rng.uniform(1, width - 1, 60000), rng.uniform(1, height - 1, 60000)
column = numpy.clip(numpy.floor((x - 0.5 * OVERLAP) / step_x), 0, columns - 1)
row = numpy.clip(numpy.floor((y - 0.5 * OVERLAP) / step_y), 0, rows - 1)
at_x, at_y = px(LEFT + x - column * step_x), px(TOP + y - row * step_y)
joined = numpy.array([images[int(r) * columns + int(c)][v, u] for c, r, u, v in zip(column, row, at_x, at_y)])
u, v = px(middle_x + x - 0.5 * width), px(middle_y + y - 0.5 * height)
around = numpy.stack([whole[v + dv, u + du] for dv in (-1, 0, 1) for du in (-1, 0, 1)])
inside = around.max(0) == around.min(0)  # not at an edge, where a dot is grey
runs.insist(inside.mean() > 0.8 and 0.2 < (joined[inside] < 128).mean() < 0.8, f"points inside lines: {inside.mean()}")
# Cutting marks of 0.15 mm around the marker differ by a dot.
runs.insist((joined[inside] == whole[v, u][inside]).mean() > 0.998, f"joined parts differ: {(joined[inside] == whole[v, u][inside]).mean()}")
dark = {int(value) for value in numpy.unique(joined[inside])}
runs.insist({0, 255} <= dark, f"ink and paper: {dark}")

# The ticks "join" and "cut" of neighbours are one line of the marker.
for k in range(columns - 1):
    line = px(TOP - 3.2)
    ticks = [numpy.flatnonzero(images[n][line] < 128) for n in (k, k + 1)]
    join = (ticks[0].max() + 0.5) * 25.4 / DPI - LEFT + k * step_x
    cut = (ticks[1].min() + 0.5) * 25.4 / DPI - LEFT + (k + 1) * step_x
    runs.insist(abs(join - cut) < 2 * 25.4 / DPI and abs(join - (k + 1) * step_x - 0.5 * OVERLAP) < 25.4 / DPI,
                f"parts {k} and {k + 1} are joined at {join} and {cut} mm")

# Six references where the paper allows.
small = runs.run([program, "sheet", "-o", work / "small"])
runs.insist("5 markers" in small.stdout and "cannot show which one moves" in small.stderr, f"{small.stdout}{small.stderr}")
pitch = re.search(r"--pitch (\S+) or less", small.stderr).group(1)
fitting = runs.run([program, "sheet", "--pitch", pitch, "-o", work / "fitting"])
runs.insist("7 markers on 1 sheet of A4" in fitting.stdout and not fitting.stderr, f"{fitting.stdout}{fitting.stderr}")
refused = runs.run([program, "sheet", "--references", 6, "-o", work / "refused"], expected=2)
runs.insist(f"six references fit with --pitch {pitch} or less (A4)" in refused.stderr, refused.stderr)
four = runs.run([program, "sheet", "--references", 4, "-o", work / "four"])
runs.insist("5 markers" in four.stdout and not four.stderr, f"{four.stderr}")
