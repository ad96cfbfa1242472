#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Averages simulated clips over time, compresses them with codecs that predict frames, and measures them.

    averaged_study.py --program MOIREGAUGE

Prints a table with one row per scene and codec. averaged_study_intro.md defines the scenes, the averages and a lie.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

from errors_of_run import Tally, run

# Scenario, amplitude in mm and frequency in Hz of the target's vertical vibration, and exposure in s, at 10 frames/s.
SCENES = {
    "4.5 px/frame, still": ("small-still", 1.5, 1.63, 0.0),
    "4.5 px/frame, still, longest exposure": ("small-still", 1.5, 1.63, 0.1),
    "0.9 px/frame, still": ("small-still", 0.4, 1.2, 0.0),
    "0.9 px/frame, camera turns": ("small-1xyz", 0.3, 1.63, 0.0),
    "0.5 px/frame, camera turns": ("small-1xyz", 1.0, 0.3, 0.0),
}
CODECS = {
    "x264, 20": ["libx264", "-crf", "20"],
    "x264, 31": ["libx264", "-crf", "31"],
    "x265, 26": ["libx265", "-crf", "26", "-x265-params", "log-level=error"],
    "VP9, 30": ["libvpx-vp9", "-crf", "30", "-b:v", "0", "-cpu-used", "4"],
    "MPEG-4, 4": ["mpeg4", "-q:v", "4"],
}
AVERAGES = {"none": "null", "4:2:1": "tmix=frames=3:weights='1 2 4'", "1:1": "tmix=frames=2", "1:1:1": "tmix=frames=3"}


def cell_of(program, clip, codec, average):
    """Returns the ok rows and lies of one clip, and what the warning names: e(dges), s(ides), b(lur)."""
    made, out = clip / "averaged.mkv", clip / "out"
    subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i", clip / "video.mkv", "-vf", average, "-pix_fmt", "yuv420p",
                    "-c:v", *codec, made], check=True)
    run([program, "measure", made, "--site", clip / "site.toml", "--quiet", "-o", out])
    tally = Tally()
    tally.add(out, clip / "truth.csv")
    said = " ".join(json.loads((out / "run.json").read_text())["warnings"])
    shutil.rmtree(out)
    shown = {"of the previous frame": "e", "before and after": "s", "blur grows": "b"}
    return f"{tally.ok} ok, {tally.lies}" + "".join(f", {letter}" for words, letter in shown.items() if words in said)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    program = parser.parse_args().program.resolve()
    print("| target, camera | codec | " + " | ".join(AVERAGES) + " |\n" + "|---" * (2 + len(AVERAGES)) + "|")
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, (scenario, amplitude, hertz, exposure)) in enumerate(SCENES.items()):
            clip = pathlib.Path(folder) / str(number)
            settings = ["sensor.fps=10", f"sensor.exposure_s={exposure}", "noise.sigma=1", "sensor.gamma=1.8", "marker.mid.dy.knots=[[0, 0]]",
                        f"marker.mid.dy.amplitude={amplitude}", f"marker.mid.dy.frequency_hz={hertz}"]
            run([program, "simulate", scenario, "--frames", 30, "--markers-only", "--codec", "ffv1", "--quiet", "-o", clip,
                 *[word for setting in settings for word in ("--set", setting)]])
            for codec, words in CODECS.items():
                cells = [cell_of(program, clip, words, average) for average in AVERAGES.values()]
                print(f"| {name} | {codec} | " + " | ".join(cells) + " |", flush=True)


main()
