#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tests detection and measurement of thin-line grids from an ink-jet printer in 12 Mpx images of a phone.

    ink_study.py --program MOIREGAUGE [--frames 12] [--seeds 20]

Prints a table with one row per draw of paper, ink and camera motion.
"""
import argparse
import json
import pathlib
import shutil
import tempfile

from errors_of_run import Tally, rms_um, run

PIXEL_MM = 5.0 / 22.0  # mm per px: a pitch of 5 mm is 22 px
PRINTS = 5             # gratings: four references and the target


def one_draw(program, seed, frames, tally):
    """Returns the numbers of crossed and of all gratings found in the first frame, and the errors of the draw."""
    with tempfile.TemporaryDirectory() as folder:
        clip, out = pathlib.Path(folder) / "clip", pathlib.Path(folder) / "out"
        run([program, "simulate", "ink", "--frames", frames, "--seed", seed, "--quiet", "-o", clip])
        run([program, "inspect", clip / "frames", "--quiet", "-o", out])
        found = json.loads((out / "inspect.json").read_text())
        shutil.rmtree(out)
        run([program, "measure", clip / "frames", "--site", clip / "site.toml", "--fps", 10, "--quiet", "-o", out])
        own = Tally()
        for each in (own, tally):
            each.add(out, clip / "truth.csv")
        crossed = sum(grating["pattern"] == "auto" for grating in found["gratings"])
        return crossed, len(found["gratings"]), own


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--seeds", type=int, default=20)
    options = parser.parse_args()
    program, whole, tally = options.program.resolve(), 0, Tally()
    print("| draw | crossed gratings found / all | rows ok | rms error dx / dy, um | rms u dx / dy, um | within 1.96 u | lies |")
    print("|---|---|---|---|---|---|---|")
    for seed in range(1, options.seeds + 1):
        crossed, gratings, own = one_draw(program, seed, options.frames, tally)
        whole += crossed == gratings == PRINTS
        print(f"| {seed} | {crossed} / {gratings} | {own.columns()}", flush=True)
    print(f"| all | - | {tally.columns()}")
    pixels = [rms_um(e for e, _ in tally.pairs[axis]) / 1e3 / PIXEL_MM for axis in ("dx", "dy")]
    print(f"\nEvery print is one grating in {whole} of {options.seeds} draws. Rms error dx / dy: {pixels[0]:.4f} / {pixels[1]:.4f} px.")


main()
