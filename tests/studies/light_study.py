#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Grey levels that are not light: a drone before a wall through tone curves and sharpening, against the truth.

    light_study.py --program MOIREGAUGE [--frames 40] [--tones linear,gamma:1.5,...] [--sharpen 0,0.6] [--seeds 1,2,3] [--noise 1.5]

Prints a table, one row for each tone curve, sharpening and site.
"""
import argparse
import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

HEIGHTS_MM = {"T1": 0, "T2": -150, "T3": 0}  # of the targets, in front of the references' plane
SURVEYED = "[known_to]\nposition_mm = 0.01\nrotation_deg = 0.001\nheight_mm = 0.01\nprint_scale = 0.0005\n"
TONES = ["linear", "gamma:1.5", "gamma:2.2", "gamma:2.6", "srgb", "s-curve"]


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4, 5):
        sys.exit(f"exit {done.returncode}: {' '.join(map(str, command))}\n{done.stderr}")


def without_tags(folder):
    """Takes the gamma chunk out of every picture: a camera's own files often have none."""
    for path in folder.glob("*.png"):
        data = path.read_bytes()
        at = data.find(b"gAMA")
        if at > 0:
            path.write_bytes(data[:at - 4] + data[at + 12:])


def errors(out, truth_file):
    truth = {(r["frame"], r["marker"]): r for r in csv.DictReader(truth_file.open())}
    result = json.loads((out / "run.json").read_text())
    reference = result["reference_frame"]
    rows = ok = lies = 0
    found = {"dx": [], "dy": []}
    for r in csv.DictReader((out / "displacement.csv").open()):
        if int(r["frame"]) == reference:
            continue
        rows += 1
        if r["status"] != "ok":
            continue
        ok += 1
        lie = False
        for axis, pairs in found.items():
            now, then = truth[r["frame"], r["marker"]], truth[str(reference), r["marker"]]
            e = float(r[f"{axis}_mm"]) - float(now[f"{axis}_mm"]) + float(then[f"{axis}_mm"])
            u = float(r[f"u_{axis}_mm"])
            pairs.append((e, u))
            lie = lie or (abs(e) > 5 * u and abs(e) > 5e-4)
        lies += lie
    return result["input"], rows, ok, lies, found


def rms(values):
    return 1e3 * math.sqrt(sum(v * v for v in values) / len(values)) if values else math.nan


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
                print_row(tone, sharpen, site, tally)


def sites(plain):
    """The site as stated, surveyed, and surveyed with the heights of the targets."""
    with_heights = plain
    for name, z_mm in HEIGHTS_MM.items():
        with_heights = with_heights.replace(f'name = "{name}"\n', f'name = "{name}"\nz_mm = {z_mm}\n')
    return {"usual": plain, "surveyed": plain + SURVEYED, "surveyed, targets' heights too": with_heights + SURVEYED}


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
            tone_read, rows, ok, lies, found = errors(out, clip / "truth.csv")
            shutil.rmtree(out)
            tally = tallies.setdefault(name, {"tones": [], "rows": 0, "ok": 0, "lies": 0, "dx": [], "dy": []})
            tally["tones"].append(f"{tone_read['tone']} ({tone_read['tone_source']})")
            tally["rows"] += rows
            tally["ok"] += ok
            tally["lies"] += lies
            tally["dx"] += found["dx"]
            tally["dy"] += found["dy"]


def print_row(tone, sharpen, site, tally):
    pairs = tally["dx"] + tally["dy"]
    inside = sum(abs(e) <= 1.96 * u for e, u in pairs) / max(1, len(pairs))
    print(f"| {tone} | {sharpen} | {site} | {', '.join(dict.fromkeys(tally['tones']))} | {tally['ok']} of {tally['rows']} | "
          f"{rms([e for e, _ in tally['dx']]):.1f} / {rms([e for e, _ in tally['dy']]):.1f} | "
          f"{rms([u for _, u in tally['dx']]):.1f} / {rms([u for _, u in tally['dy']]):.1f} | {100 * inside:.1f} % | {tally['lies']} |",
          flush=True)


main()
