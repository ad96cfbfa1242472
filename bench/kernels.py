#!/usr/bin/python3
"""Prints a fingerprint of the sources that decide the speed of a frame, which docs/performance.md names.

  bench/kernels.py [ROOT]

Comments, white space, includes and the choice of names do not change it. Every identifier counts as its number of first
appearance in its file. So a renamed variable or a reworded comment needs no new benchmark, and a changed operation does.
"""
import hashlib
import pathlib
import re
import sys

# The only list of these sources.
KERNELS = (
    "src/moiregauge/phase/fit/patch_pass.cc",
    "src/moiregauge/phase/fit/patch_columns-inl.h",
    "src/moiregauge/phase/fit/patch_products-inl.h",
    "src/moiregauge/phase/fit/patch_rows-inl.h",
    "src/moiregauge/phase/fit/patch_strips-inl.h",
    "src/moiregauge/phase/fit/patch_tiles-inl.h",
    "src/moiregauge/phase/fit/patch_fit.cc",
    "src/moiregauge/phase/fit/patch_system.cc",
    "src/moiregauge/phase/fit/print_template.cc",
    "src/moiregauge/phase/raw_pixels/fringe_nodes.cc",
    "src/moiregauge/observation/raster/pixel_sums.cc",
    "src/moiregauge/observation/raster/noise.cc",
    "src/moiregauge/observation/frame/disc_centre.cc",
    "src/moiregauge/observation/frame/track.cc",
    "src/moiregauge/observation/print/own_blur.cc",
    "src/moiregauge/observation/print/template_residuals.cc",
    "src/moiregauge/calibration/scene/patch_residual.cc",
    "src/moiregauge/calibration/scene/frame_fit.cc",
    "src/moiregauge/displacement/precise/precise_budget.cc",
)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|^\s*#\s*include[^\n]*", re.DOTALL | re.MULTILINE)
TOKEN = re.compile(r'"(?:\\.|[^"\\\n])*"|[A-Za-z_]\w*|[0-9][\w.\']*(?:[eE][+-]?\d+\w*)?|\S')


def tokens(source):
    """Returns the tokens of a C++ source, with identifiers numbered by first appearance."""
    names = {}
    for token in TOKEN.findall(COMMENT.sub(" ", source)):
        yield f"n{names.setdefault(token, len(names))}" if token[0].isalpha() or token[0] == "_" else token


def fingerprint(root):
    digest = hashlib.sha256()
    for path in KERNELS:
        digest.update(" ".join(tokens((root / path).read_text(encoding="utf-8"))).encode())
        digest.update(b"\n")
    return digest.hexdigest()[:16]


if __name__ == "__main__":
    print(fingerprint(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")))
