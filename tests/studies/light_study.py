#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tests non-linear grey levels: a drone in front of a wall, with tone curves and sharpening, compared with the truth.

    light_study.py --program MOIREGAUGE [--frames 40] [--tones linear,gamma:1.5,...] [--sharpen 0,0.6] [--seeds 1,2,3] [--noise 1.5]

Prints a table with one row per tone curve, sharpening and site.
"""
import argparse
import pathlib
import shutil
import tempfile

from errors_of_run import SURVEYED, Tally, run, with_heights

HEIGHTS_MM = {"T1": 0, "T2": -150, "T3": 0}  # mm, z of the targets; positive in front of the references' plane
TONES = ["linear", "gamma:1.5", "gamma:2.2", "gamma:2.6", "srgb", "s-curve"]


def without_tags(folder):
    """Removes the gamma chunk from all images, because files of cameras often have none."""
    for path in folder.glob("*.png"):
        data = path.read_bytes()
        at = data.find(b"gAMA")
        if at > 0:
            path.write_bytes(data[:at - 4] + data[at + 12:])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--tones", default=",".join(TONES))
    parser.add_argument("--sharpen", default="0,0.6")
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--noise", default="1.5", help="grey levels")
    options = parser.parse_args()
    program = options.program.resolve()
    print("| tone curve | sharpened | site | mapped by (source) | rows ok | rms error dx / dy, um | rms u dx / dy, um | within 1.96 u | lies |")
    print("|---|---|---|---|---|---|---|---|---|")
    for tone in options.tones.split(","):
        for sharpen in options.sharpen.split(","):
            tallies = {}
            for seed in options.seeds.split(","):
                one_clip(program, options, tone, sharpen, seed, tallies)
            for site, tally in tallies.items():
                print(f"| {tone} | {sharpen} | {site} | {', '.join(dict.fromkeys(tally.tones))} | {tally.columns()}", flush=True)


def sites(plain):
    """Returns the site as stated, surveyed, and surveyed with the heights of the targets."""
    return {"usual": plain, "surveyed": plain + SURVEYED, "surveyed, targets' heights too": with_heights(plain, HEIGHTS_MM) + SURVEYED}


def one_clip(program, options, tone, sharpen, seed, tallies):
    with tempfile.TemporaryDirectory() as folder:
        clip = pathlib.Path(folder) / "clip"
        run([program, "simulate", "drone", "--frames", options.frames, "--seed", seed, "--markers-only", "--quiet", "-o", clip,
             "--set", f"processing.tone={tone}", "--set", f"processing.sharpen={sharpen}", "--set", f"noise.sigma={options.noise}"])
        without_tags(clip / "frames")
        for name, text in sites((clip / "site.toml").read_text().split("[known_to]")[0]).items():
            site, out = pathlib.Path(folder) / "site.toml", pathlib.Path(folder) / "out"
            site.write_text(text)
            run([program, "measure", clip / "frames", "--site", site, "--fps", 10, "--quiet", "-o", out])
            tallies.setdefault(name, Tally()).add(out, clip / "truth.csv")
            shutil.rmtree(out)


main()
