#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares surveyed sites (0.01 mm, 0.001 deg) with the usual one, on rigs with radial and tangential distortion.

    survey_study.py --program MOIREGAUGE [--frames 20] [--seeds 1,2,3,4,5,6]

Positions are drawn from the uncertainties of the site. Prints a table with one row per rig, lens and site.
"""
import argparse
import pathlib
import tempfile

from errors_of_run import Tally, run, with_heights

LENSES = {"-1 %": -0.0225, "-2 %": -0.0451}
RIGS = ["rig-0.1x", "rig-1x", "rig-1xyz", "rig-8xyz"]
TRAVEL = {"small-travel-50": -30.0}  # mm, z of the target; positive in front of the references' plane


def one_row(program, name, lens, settings, seeds, frames, height_mm):
    """Prints the rows of the usual and the surveyed site, each with its own draw of positions.

    Surveyed targets have stated heights.
    """
    for site_name in ("usual", "surveyed"):
        tally = Tally()
        for seed in seeds:
            with tempfile.TemporaryDirectory() as folder:
                clip, out = pathlib.Path(folder) / "clip", pathlib.Path(folder) / "out"
                words = [*settings, "truth.draw_known_to=true"]
                if site_name == "surveyed":
                    words.append("site.surveyed=true")
                run([program, "simulate", name, "--frames", frames, "--seed", seed, "--markers-only", "--quiet", "-o", clip,
                     *[word for setting in words for word in ("--set", setting)]])
                site = clip / "site.toml"
                if site_name == "surveyed":
                    site.write_text(with_heights(site.read_text(), {"mid": height_mm}))
                run([program, "measure", clip / "frames", "--site", site, "--fps", 10, "--quiet", "-o", out])
                tally.add(out, clip / "truth.csv")
        print(f"| {name} | {lens} | {site_name} | {tally.columns()}", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--seeds", default="1,2,3,4,5,6")
    options = parser.parse_args()
    program, seeds = options.program.resolve(), options.seeds.split(",")
    print("| scenario | lens | site | rows ok | rms error dx / dy, um | rms u dx / dy, um | within 1.96 u | lies |")
    print("|---|---|---|---|---|---|---|---|")
    for rig in RIGS:
        for lens, k1 in LENSES.items():
            settings = [f"lens.k1={k1}", "lens.p1=0.0005", "lens.p2=-0.0005", "sensor.fps=2.5" if rig == "rig-8xyz" else "sensor.fps=10"]
            one_row(program, rig, lens, settings, seeds, options.frames, 0.0)
    for name, height_mm in TRAVEL.items():
        one_row(program, name, "ideal", [], seeds, options.frames, height_mm)


main()
