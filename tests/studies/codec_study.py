#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the coverage of u in compressed footage: random short scenes of the small rig, compressed by ffmpeg.

    codec_study.py --program MOIREGAUGE [--scenes 200] [--first-seed 1] [--settings crf18,crf23,crf28,mjpeg] [--jobs N]

A scene has 13 frames and is compressed once per setting. Camera motion, pattern, pitch, contrast, noise, background and
the target's movement are random. Prints a table. Ends 1 if a requirement is not met.
"""
import argparse
import concurrent.futures
import csv
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

FRAMES = 13
SETTINGS = {
    "raw": None,
    "crf18": ["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"],
    "crf23": ["-c:v", "libx264", "-crf", "23", "-pix_fmt", "yuv420p"],
    "crf28": ["-c:v", "libx264", "-crf", "28", "-pix_fmt", "yuv420p"],
    "mjpeg": ["-c:v", "mjpeg", "-pix_fmt", "yuvj420p"],
    "hevc": ["-c:v", "libx265", "-crf", "26", "-pix_fmt", "yuv420p", "-x265-params", "log-level=none:pools=1"],
}
NAMES = {"crf18": "x264 crf 18", "crf23": "x264 crf 23", "crf28": "x264 crf 28", "mjpeg": "Motion JPEG, q 2 to 10",
         "hevc": "x265 crf 26", "raw": "not compressed"}
COVERED = 1.96               # coverage factor k of the 95 % interval
LIE_U, LIE_MM = 5.0, 0.0005  # a lie has an error above 5 u and 0.5 um
WIDEST = 4.0                 # largest ratio of mean u to the rms error
FEWEST_LIES = 0.001          # largest share of lies


def scene(seed):
    """Returns the built-in name, the --set values, a flag for a rough background, and the encoder's other options."""
    draw = random.Random(seed)
    fps = draw.choice([10, 25, 50])
    duration = FRAMES / fps
    still = draw.random() < 0.5
    sets = {"sensor.fps": fps, "grating.pattern": draw.choice(["grid", "grid", "cosine", "dots", "checkerboard", "squares"]),
            "grating.pitch_mm": draw.choice([4, 5, 6, 8, 10, 12]), "noise.sigma": draw.choice([0.3, 1.0, 1.5, 3.0])}
    contrast, middle = draw.choice([40, 70, 110, 150, 190]), draw.uniform(105, 130)
    sets["light.white"], sets["light.black"] = round(middle + contrast / 2), round(middle - contrast / 2)
    textured = draw.random() < 0.4
    if textured:
        sets["light.texture"] = draw.choice([5, 12, 20])
    if not still:
        turn = 10 ** draw.uniform(-1.5, 0)  # deg over the whole scene
        for axis in "xyz":
            sets[f"rotation.{axis}.knots"] = f"[[0,0],[{duration},{turn * draw.uniform(-1, 1):.5f}]]"
        if draw.random() < 0.5:  # handheld
            for axis in "xy":
                sets[f"rotation.{axis}.amplitude"] = 0.02
                sets[f"rotation.{axis}.frequency_hz"] = draw.uniform(0.5, 3) / duration
    movement = draw.choice(["rest", "creep", "swing", "tremble", "jump"])
    size = 10 ** draw.uniform(-2.3, 0.3)  # mm
    sets["marker.mid.dy.scale"] = 0
    for axis, part in (("dy", 1.0), ("dx", draw.uniform(-1, 1))):
        key = f"marker.mid.{axis}"
        if movement == "creep":
            sets[f"{key}.scale"] = 1
            sets[f"{key}.knots"] = f"[[0,0],[{duration},{size * part:.5f}]]"
        elif movement in ("swing", "tremble"):
            sets[f"{key}.amplitude"] = f"{size * part * (0.05 if movement == 'tremble' else 1):.6f}"
            sets[f"{key}.frequency_hz"] = f"{draw.uniform(0.4, 3) / duration:.5f}"
        elif movement == "jump":
            sets[f"{key}.random"] = f"{size * abs(part):.5f}"
            sets[f"{key}.random_step_s"] = f"{draw.choice([1, 3, 5]) / fps:.5f}"
    words = {"crf": ["-preset", draw.choice(["veryfast", "medium", "medium", "slow"])], "mjpeg": ["-q:v", str(draw.randint(2, 10))]}
    if draw.random() < 0.3:
        words["crf"] += ["-tune", draw.choice(["zerolatency", "film", "grain"])]
    return ("small-still" if still else "small-1xyz"), sets, textured, words


def rows(path):
    with open(path, newline="") as file:
        return {int(row["frame"]): row for row in csv.DictReader(file)}


def run(words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)


def compressed(frames, fps, setting, words, out):
    rate = words["crf"] if setting.startswith("crf") else words["mjpeg"] if setting == "mjpeg" else []
    done = run(["ffmpeg", "-nostdin", "-v", "error", "-y", "-framerate", fps, "-i", frames / "%06d.png", *SETTINGS[setting], *rate,
                "-threads", 1, out])
    if done.returncode != 0:
        raise RuntimeError(done.stderr)


def measured(program, settings, seed):
    """Returns, per setting, the status and the (error, u) of both axes of all rows except the reference frame's."""
    name, sets, textured, words = scene(seed)
    out = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        drawn = run([program, "simulate", name, "-o", folder / "s", "--frames", FRAMES, "--seed", seed, "--threads", 1, "--quiet",
                     *([] if textured else ["--markers-only"]), *[w for k, v in sets.items() for w in ("--set", f"{k}={v}")]])
        if drawn.returncode != 0:
            raise RuntimeError(f"seed {seed}: {drawn.stderr}")
        truth = rows(folder / "s/truth.csv")
        for setting in settings:
            if setting == "raw":
                source = folder / "s/frames"
            else:
                source = folder / f"{setting}.mkv"
                compressed(folder / "s/frames", sets["sensor.fps"], setting, words, source)
            run([program, "measure", source, "--site", folder / "s/site.toml", "-o", folder / setting, "--quiet", "--threads", 1])
            out[setting] = []
            if not (folder / setting / "displacement.csv").exists():
                continue
            for frame, row in rows(folder / setting / "displacement.csv").items():
                if frame == 0:
                    continue
                axes = [(float(row[f"{a}_mm"]) - float(truth[frame][f"{a}_mm"]), float(row[f"u_{a}_mm"])) for a in ("dx", "dy")]
                out[setting].append((row["status"], axes))
    return out


def table_row(setting, scenes):
    """Returns one line of the table, and the requirements that are not met."""
    broken = []
    all_rows = sum(FRAMES - 1 for _ in scenes)
    ok = [[axes for status, axes in one if status == "ok"] for one in scenes]
    ok = [one for one in ok if one]
    count = sum(len(one) for one in ok)
    cells, lies = [], 0
    for axis in (0, 1):
        shares = [sum(abs(a[axis][0]) <= COVERED * a[axis][1] for a in one) / len(one) for one in ok]
        covered = sum(s * len(one) for s, one in zip(shares, ok)) / count
        mean = sum(shares) / len(shares)
        band = 2.0 * math.sqrt(sum((s - mean) ** 2 for s in shares) / len(shares) / len(shares))
        rms = math.sqrt(sum(a[axis][0] ** 2 for one in ok for a in one) / count)
        width = sum(a[axis][1] for one in ok for a in one) / count / rms
        lies += sum(abs(a[axis][0]) > LIE_U * a[axis][1] and abs(a[axis][0]) > LIE_MM for one in ok for a in one)
        cells.append((rms, covered, band, width))
        if setting != "raw" and covered + band < 0.95:
            broken.append(f"{setting}: {100 * covered:.1f} % covered along {'xy'[axis]}")
        if setting != "raw" and width > WIDEST:
            broken.append(f"{setting}: the interval along {'xy'[axis]} is {width:.1f} times as wide as needed")
    if setting != "raw" and lies > FEWEST_LIES * 2 * count:
        broken.append(f"{setting}: {lies} silent lies in {2 * count}")
    (x_rms, x_in, x_band, x_width), (y_rms, y_in, y_band, y_width) = cells
    line = (f"| {NAMES[setting]} | {len(ok)} | {100 * count / all_rows:.1f} % | {1000 * x_rms:.1f} / {1000 * y_rms:.1f} | "
            f"{100 * x_in:.1f} (+- {100 * x_band:.1f}) | {100 * y_in:.1f} (+- {100 * y_band:.1f}) | {x_width:.1f} / {y_width:.1f} | "
            f"{lies} of {2 * count} |")
    return line, broken


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--settings", default="crf18,crf23,crf28,mjpeg")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    settings = options.settings.split(",")
    seeds = range(options.first_seed, options.first_seed + options.scenes)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        scenes = list(pool.map(lambda seed: measured(options.program, settings, seed), seeds))
    print("| compressed by | runs | rows `ok` | rms error dx / dy, um | 95 % interval holds dx, % | dy, % | "
          "mean u / rms error, dx / dy | silent lies |")
    print("|---|---|---|---|---|---|---|---|")
    broken = []
    for setting in settings:
        line, wrong = table_row(setting, [one[setting] for one in scenes])
        print(line)
        broken += wrong
    for line in broken:
        print(f"broken: {line}", file=sys.stderr)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
