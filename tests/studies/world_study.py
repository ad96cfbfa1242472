#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures recordings of a second, independent renderer and compares them with its truth.

    world_study.py --program MOIREGAUGE --world WORLD [FIRST LAST] [--groups a,b] [--processing png,x264] [--set KEY=VALUE]... [--keep DIR] [--verbose]

Seeds FIRST to LAST of every group are drawn. Prints one table by group and one by processing. world_study_intro.md
defines groups and lies.
"""
import argparse
import collections
import csv
import json
import math
import multiprocessing.pool
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from world_draws import GROUPS, draw_text, factors_of, layout, site_text

PROCESSINGS = {
    "png": [],
    "x264, 23": ["-pix_fmt", "yuv420p", "-c:v", "libx264", "-crf", "23"],
    "x265, 26": ["-pix_fmt", "yuv420p", "-c:v", "libx265", "-crf", "26", "-x265-params", "log-level=error"],
    "mjpeg, 4": ["-pix_fmt", "yuvj420p", "-c:v", "mjpeg", "-q:v", "4"],
    "unsharp": ["-vf", "unsharp=5:5:0.6", "-pix_fmt", "gray", "-c:v", "ffv1"],
    "hqdn3d, x264": ["-vf", "hqdn3d", "-pix_fmt", "yuv420p", "-c:v", "libx264", "-crf", "23"],
    "scale 0.75, x264": ["-vf", "scale=iw*3/4:-2:flags=bicubic", "-pix_fmt", "yuv420p", "-c:v", "libx264", "-crf", "20"],
    "tmix 2": ["-vf", "tmix=frames=2", "-pix_fmt", "gray", "-c:v", "ffv1"],
}
HEADER = "| %s | recordings | not ok | rows | ok | within 1.96 u | lies | rms error, um | rms u, um | worst error / u |\n|---|---|---|---|---|---|---|---|---|---|"


class Errors:
    """Errors and u of the ok rows of recordings, in mm."""

    def __init__(self):
        self.recordings = self.refused = self.rows = self.ok = self.lies = 0
        self.pairs = []

    def columns(self):
        inside = sum(abs(e) <= 1.96 * u for e, u in self.pairs)
        rms = [1e3 * math.sqrt(sum(v * v for v in values) / max(1, len(self.pairs))) for values in zip(*self.pairs)] or [math.nan] * 2
        worst = max((abs(e) / u for e, u in self.pairs if u > 0), default=math.nan)
        return (f"{self.recordings} | {self.refused} | {self.rows} | {self.ok} | {100 * inside / max(1, len(self.pairs)):.1f} % | {self.lies} | "
                f"{rms[0]:.2f} | {rms[1]:.2f} | {worst:.1f} |")


def judge(out, clip):
    """Returns the errors of one run, its words for a list, and its warnings. Row times count if no shutter was solved."""
    errors, words = Errors(), []
    errors.recordings = 1
    truth = {(r["frame"], r["marker"]): r for r in csv.DictReader((clip / "truth.csv").open())}
    if not (out / "displacement.csv").exists():
        errors.refused, errors.rows = 1, len(truth)
        return errors, ["no displacement.csv"], []
    result = json.loads((out / "run.json").read_text())
    reference, counts = str(result["reference_frame"]), collections.Counter()
    axes = ("dx_mm", "dy_mm") if result["scene"]["readout_s"] else ("row_dx_mm", "row_dy_mm")
    for r in csv.DictReader((out / "displacement.csv").open()):
        if r["frame"] == reference:
            continue
        errors.rows += 1
        counts[r["status"]] += 1
        if r["status"] != "ok":
            continue
        errors.ok += 1
        now, then = truth[r["frame"], r["marker"]], truth[reference, r["marker"]]
        for axis, of_truth in zip(("dx", "dy"), axes):
            u = float(r[f"u_{axis}_mm"])
            e = float(r[f"{axis}_mm"]) - float(now[of_truth]) + float(then[of_truth])
            if math.isnan(u) or math.isnan(e):
                continue
            errors.pairs.append((e, u))
            if abs(e) > 5 * u:
                errors.lies += 1
                words.append(f"lie: frame {r['frame']} {r['marker']} {axis}: error {1e3 * e:.2f} um, u {1e3 * u:.2f} um, {abs(e) / u:.1f} u")
    errors.refused = int(errors.ok < 0.5 * errors.rows)
    if errors.ok < errors.rows:
        words.insert(0, "statuses: " + ", ".join(f"{name} {count}" for name, count in counts.items()))
    f, u_f = result["camera"]["fx"], result["camera"]["u"].get("fx")
    if f and u_f:
        true_f = json.loads((clip / "factors.json").read_text())["focal_px"]
        words.append(f"focal length {f:.1f} px, u {u_f:.1f} px, off by {(f - true_f) / u_f:.1f} u")
    words.append(f"model {result['scene']['model']}, readout_s {result['scene']['readout_s']}, tone {result['input']['tone']}, method {result['method']}")
    return errors, words, result["warnings"]


def rendered(options, group, seed, clip):
    """Renders one recording into a folder and returns its factors."""
    f = factors_of(group, seed, dict(setting.split("=", 1) for setting in options.set))
    markers = layout(f)
    clip.mkdir(parents=True, exist_ok=True)
    (clip / "draw.txt").write_text(draw_text(f, markers, seed))
    (clip / "site.toml").write_text(site_text(f, markers))
    (clip / "factors.json").write_text(json.dumps(f, indent=1))
    done = subprocess.run([options.world, clip / "draw.txt", clip], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{options.world}: {done.stderr}")
    return f


def measured(options, f, clip, processing):
    """Measures one recording behind a processing. Returns the folder of results and what went wrong."""
    footage, out = clip / "frames", clip / ("out-" + "".join(c for c in processing if c.isalnum()))
    shutil.rmtree(out, ignore_errors=True)
    if PROCESSINGS[processing]:
        footage = clip / "processed.mkv"
        subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", str(f["fps"]), "-i", clip / "frames" / "%06d.png",
                        *PROCESSINGS[processing], footage], check=True)
    extra = ["--readout", f"{f['readout_ms']:.3f}ms"] if f["state_readout"] else []
    done = subprocess.run([options.program, "measure", footage, "--site", clip / "site.toml", "--fps", str(f["fps"]), "--method", "precise", "--quiet",
                           "-o", out, *extra], capture_output=True, text=True, check=False)
    return out, f"exit {done.returncode} {done.stderr.strip()}"


def one_recording(options, group, seed):
    """Renders and measures one recording. Returns what it adds to the tallies, and its part of the list."""
    found, listed = [], []
    with tempfile.TemporaryDirectory() as temporary:
        clip = pathlib.Path(options.keep or temporary) / f"{group.replace(' ', '-').replace(',', '')}-{seed}"
        f = rendered(options, group, seed, clip)
        for processing in options.processing:
            out, said = measured(options, f, clip, processing)
            errors, words, warnings = judge(out, clip)
            if processing == "png":
                found.append((("group", group), errors))
            found.append((("processing", processing), errors))
            if options.verbose or errors.lies or errors.ok < errors.rows:
                listed.append(f"- {group}, seed {seed}, {processing}: {errors.columns()} {said}")
                listed += [f"    {text}" for text in [*words, *(warnings if options.verbose or errors.refused else [])]]
    return found, listed


def add(tally, errors):
    for name in ("recordings", "refused", "rows", "ok", "lies"):
        setattr(tally, name, getattr(tally, name) + getattr(errors, name))
    tally.pairs += errors.pairs


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("seeds", type=int, nargs="*", default=[1, 6], metavar="SEED", help="FIRST LAST")
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--world", required=True, type=pathlib.Path, help="the renderer")
    parser.add_argument("--groups", default="", help="names, separated by semicolons")
    parser.add_argument("--processing", default="png", help="names, separated by semicolons; all: every one")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--keep", help="folder for recordings and results")
    parser.add_argument("--only", default="group processing", help="tables to print")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    options.program, options.world = options.program.resolve(), options.world.resolve()
    options.processing = list(PROCESSINGS) if options.processing == "all" else options.processing.split(";")
    tallies = {}
    groups = options.groups.split(";") if options.groups else GROUPS
    seeds = range(options.seeds[0], options.seeds[-1] + 1)
    with multiprocessing.pool.ThreadPool(os.cpu_count()) as pool:
        for found, listed in pool.imap(lambda one: one_recording(options, *one), [(g, s) for g in groups for s in seeds]):
            print("".join(f"{line}\n" for line in listed), end="", file=sys.stderr, flush=True)
            for key, errors in found:
                add(tallies.setdefault(key, Errors()), errors)
    for kind in options.only.split():
        print(HEADER % kind)
        for (of_kind, name), tally in tallies.items():
            if of_kind == kind:
                print(f"| {name} | {tally.columns()}")
        print()


main()
