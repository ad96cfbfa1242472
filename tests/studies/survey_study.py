#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares surveyed sites (0.01 mm, 0.001 deg) with the usual one, on rigs with radial and tangential distortion.

    survey_study.py --program MOIREGAUGE [--frames 20] [--seeds N] [--scenarios rig-1x,small-travel-50]

Prints a table with one row per scenario, lens, footage and statement. The same footage of a surveyed scene is measured
with the surveyed and with the usual statement.
"""
import argparse
import concurrent.futures
import pathlib
import random
import tempfile

from errors_of_run import Tally, run, with_heights

LENSES = {"-1 %": -0.0225, "-2 %": -0.0451}
RIGS = ["rig-0.1x", "rig-1x", "rig-1xyz", "rig-8xyz"]
HEIGHT_MM = {"small-travel-50": -30.0}  # z of the target, positive in front of the references' plane; 0 on the rigs
SEEDS = {"rig-8xyz": 16, "small-travel-50": 40}
U_FOCAL_PX = 1.0  # standard uncertainty of the calibrated focal length
JOBS = 2  # runs at the same time


def calibrated(truth_file, folder, seed):
    """Writes a camera file whose focal length is wrong by a draw from its stated u."""
    fx = float(truth_file.read_text().split("fx = ")[1].split()[0])
    fx += random.Random(int(seed)).gauss(0.0, U_FOCAL_PX)
    camera = truth_file.read_text().split("[truth]")[0]
    lines = [f"{line.split()[0]} = {fx}" if line.startswith(("fx", "fy")) else line for line in camera.splitlines()]
    path = folder / "camera.toml"
    path.write_text("\n".join(lines) + f"\n\n[camera.u]\nfx = {U_FOCAL_PX}\n")
    return path


def one_seed(program, name, settings, frames, seed):
    """Measures the footage of both scenes. Returns tuples of the places' uncertainty, the statement, and the tally."""
    out = []
    height_mm = HEIGHT_MM.get(name, 0.0)
    for places in ("usual", "surveyed"):
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            clip = folder / "clip"
            words = [*settings, "truth.draw_known_to=true"]
            if places == "surveyed":
                words.append("site.surveyed=true")
            run([program, "simulate", name, "--frames", frames, "--seed", seed, "--markers-only", "--quiet", "-o", clip,
                 *[word for setting in words for word in ("--set", setting)]])
            as_rendered = (clip / "site.toml").read_text()
            statements = {"usual": (as_rendered.split("[known_to]")[0], [])}
            if places == "surveyed":
                stated = with_heights(as_rendered, {"mid": height_mm})
                statements["surveyed"] = (stated, [])
                if name in HEIGHT_MM:
                    camera = calibrated(clip / "truth-camera.toml", folder, seed)
                    statements["surveyed, and `--camera`"] = (stated, ["--camera", camera])
            for number, (statement, (text, options)) in enumerate(statements.items()):
                site, result = folder / "site.toml", folder / f"out{number}"
                site.write_text(text)
                run([program, "measure", clip / "frames", "--site", site, "--fps", 10, "--quiet", "-o", result, *options])
                tally = Tally()
                tally.add(result, clip / "truth.csv")
                out.append((places, statement, tally))
    return out


def rows_of(program, name, lens, settings, seeds, frames):
    """Prints the rows of one scenario and lens."""
    tallies = {}
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        for results in pool.map(lambda seed: one_seed(program, name, settings, frames, seed), seeds):
            for places, statement, tally in results:
                tallies.setdefault((places, statement), Tally()).merge(tally)
    for (places, statement), tally in tallies.items():
        print(f"| {name} | {lens} | {places} | {statement} | {tally.columns()}", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--seeds", type=int, help="runs per row, instead of 6 (rig-8xyz: 16, small-travel-50: 40)")
    parser.add_argument("--scenarios", default=",".join([*RIGS, *HEIGHT_MM]))
    options = parser.parse_args()
    program = options.program.resolve()
    print("| scenario | lens | places drawn from | stated | rows ok | rms error dx / dy, um | rms u dx / dy, um | within 1.96 u | lies |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name in options.scenarios.split(","):
        seeds = range(1, 1 + (options.seeds or SEEDS.get(name, 6)))
        if name not in RIGS:
            rows_of(program, name, "ideal", [], seeds, options.frames)
            continue
        for lens, k1 in LENSES.items():
            settings = [f"lens.k1={k1}", "lens.p1=0.0005", "lens.p2=-0.0005", "sensor.fps=2.5" if name == "rig-8xyz" else "sensor.fps=10"]
            rows_of(program, name, lens, settings, seeds, options.frames)


main()
