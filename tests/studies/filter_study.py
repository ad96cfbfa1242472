#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures simulated clips that an ffmpeg filter has processed, and compares them with the truth.

    filter_study.py --program MOIREGAUGE [--frames 30] [--filters hqdn3d,tmix,...] [--scenes still,sway]

Prints a table with one row per filter and scene. filter_study_intro.md defines the scenes and a lie.
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

from errors_of_run import Tally, run

TARGET = ["marker.mid.dx.knots=[[0, 0], [4, 0.12]]", "sensor.fps=10"]
SWAY = [f"rotation.{axis}.{key}" for axis, hertz in zip("xyz", (0.7, 1.1, 0.5)) for key in ("amplitude=0.2", f"frequency_hz={hertz}", "knots=[[0, 0]]")]
SCENES = {"still": TARGET, "sway": TARGET + SWAY}
# Filters in the time between frames, in the image plane, and in grey levels.
FILTERS = [
    "null",
    "hqdn3d=1:1:2:2", "hqdn3d=4:3:6:4.5", "atadenoise", "fftdnoiz=sigma=4:prev=1", "nlmeans=s=3", "vaguedenoiser", "dctdnoiz=sigma=4",
    "tmix=frames=2:weights='1 9'", "tmix=frames=2", "tmix=frames=3", "lagfun=decay=0.95", "lagfun=decay=0.5", "tmedian=radius=1", "deflicker", "bwdif", "yadif",
    "median=radius=1", "median=radius=2", "gblur=sigma=1", "avgblur=1", "unsharp=5:5:0.6", "unsharp=7:7:1.5", "cas=0.7", "smartblur=1:0.8:0",
    "scale=iw*3/4:-2:flags=bicubic,scale=1024:512:flags=bicubic", "scale=iw/2:-2:flags=area,scale=1024:512:flags=lanczos",
    "rotate=0.1*PI/180:bilinear=1", "lenscorrection=k1=-0.01:i=bilinear", "deshake",
    "eq=contrast=1.2", "eq=gamma=1.4", "curves=preset=increase_contrast", "curves=preset=lighter", "vignette=PI/6", "noise=alls=8:allf=t", "normalize",
    "histeq=strength=0.1", "deband", "dedot", "elbg=codebook_length=16", "pp=al", "fspp", "deblock",
]


def name_of(video_filter):
    return video_filter.split("=")[0].split(",")[0]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=30)
    parser.add_argument("--filters", default="", help="names; default: all")
    parser.add_argument("--scenes", default=",".join(SCENES))
    options = parser.parse_args()
    program, wanted = options.program.resolve(), [name for name in options.filters.split(",") if name]
    print("| filter | scene | rows ok | rms error dx / dy, um | rms u dx / dy, um | within 1.96 u | lies |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes.split(","):
            clip = pathlib.Path(folder) / scene
            settings = [word for setting in SCENES[scene] for word in ("--set", setting)]
            run([program, "simulate", "small-still", "--frames", options.frames, "--markers-only", "--codec", "ffv1", "--quiet", "-o", clip, *settings])
            for video_filter in FILTERS:
                if not wanted or name_of(video_filter) in wanted:
                    print(f"| `{video_filter}` | {scene} | {measured(program, clip, video_filter)}", flush=True)


def measured(program, clip, video_filter):
    """Returns the cells of a filtered clip's row."""
    processed, out = clip / "processed.mkv", clip / "out"
    made = subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i", clip / "video.mkv", "-vf", video_filter, "-pix_fmt", "gray",
                           "-c:v", "ffv1", processed], capture_output=True, check=False)
    if made.returncode != 0:
        return "this ffmpeg has no such filter | - | - | - | - |"
    run([program, "measure", processed, "--site", clip / "site.toml", "--quiet", "-o", out])
    tally = Tally()
    if (out / "displacement.csv").exists():
        tally.add(out, clip / "truth.csv")
    for file in out.glob("*"):
        file.unlink()
    # Without a row that is ok there is no error.
    return re.sub(r"nan / nan|(?<=\| )0\.0 %", "-", tally.columns())


main()
