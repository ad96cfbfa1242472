#!/usr/bin/python3
"""Measures the markers in stabilised.mp4 itself: stabilised_video.py MOIREGAUGE WORK.

The camera of the small rig rotates by 1 degree about three axes in 20 frames while the target moves up. In the
stabilised half the references must be fixed within 0.025 px rms and 0.05 px. In the half as filmed they move by several
px. The target must move by N times its displacement, within 1 %. Shifts are phases of the gratings' fundamentals in
Hann windows of two pitches. The codec suppresses small changes of up to two grey levels, which are 0.025 px at edges of
80 grey levels per px.
"""
import csv
import pathlib
import shutil
import subprocess
import sys

import numpy

TIMES = 4.0
FRAMES = 20
GAP = 4
CODEC_PX = 2.0 / 80.0
MM_PER_PX = 1200.0 / 3478.26  # small rig


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{words}: exit {done.returncode}: {done.stderr}"
    return done


def pictures_of(film):
    probe = run("ffprobe", "-v", "error", "-show_entries", "stream=width,height,pix_fmt", "-of", "csv=p=0", film).stdout
    width, height, kind = probe.strip().split(",")
    assert kind == "yuv420p", kind
    raw = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", str(film), "-f", "rawvideo", "-pix_fmt", "gray", "-color_range", "tv", "-"],
                         capture_output=True, check=True).stdout
    return numpy.frombuffer(raw, numpy.uint8).reshape(-1, int(height), int(width)).astype(float)


def phase(picture, x, y, pitch):
    """Returns the phase in rad of the fundamental along y, at (x, y) px."""
    half = int(round(pitch))
    rows = numpy.arange(int(round(y)) - half, int(round(y)) + half + 1)
    columns = numpy.arange(int(round(x)) - half, int(round(x)) + half + 1)
    weight = numpy.hanning(len(rows) + 2)[1:-1]
    part = picture[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
    part = part - part.mean()
    return numpy.angle(numpy.sum(weight[:, None] * weight[None, :] * part * numpy.exp(-2j * numpy.pi * rows / pitch)[:, None]))


def shifts(film, x, y, pitch):
    """Returns the downward shifts in px since the first frame, with phase unwrapping over time."""
    phases = numpy.unwrap([phase(picture, x, y, pitch) for picture in film])
    return -(phases - phases[0]) * pitch / (2.0 * numpy.pi)


def main():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    run(program, "simulate", "small-1xyz", "--quiet", "--frames", FRAMES, "--set", "rotation.x.scale=8", "--set", "rotation.y.scale=8",
        "--set", "rotation.z.scale=8", "-o", work / "run")
    out = run(program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 10, "--video", "--exaggerate", TIMES,
              "-o", work / "out")
    # The layout of the rig is its own mirror image, which each run reports in a note.
    assert all("cannot be recognised" in line for line in out.stderr.splitlines()), out.stderr
    film = pictures_of(work / "out/stabilised.mp4")
    assert len(film) == FRAMES, len(film)
    part = (film.shape[2] - GAP) // 2
    scale = part / 1024.0
    strip = film.shape[1] - round(512 * scale)
    pitch = 10.0 / MM_PER_PX * scale
    filmed, still = film[:, strip:, :part], film[:, strip:, part + GAP:]

    def place(x_mm, y_mm):
        return (511.5 + x_mm / MM_PER_PX + 0.5) * scale - 0.5, (255.5 - y_mm / MM_PER_PX + 0.5) * scale - 0.5

    wandered = 0.0
    for x_mm, y_mm in [(-100, 40), (100, 40), (-100, -40), (100, -40)]:
        residual = shifts(still, *place(x_mm, y_mm), pitch)
        moves = shifts(filmed, *place(x_mm, y_mm), pitch)
        wandered = max(wandered, numpy.abs(moves).max())
        rms = numpy.sqrt(numpy.mean(residual ** 2))
        print(f"reference at {x_mm:4d}, {y_mm:3d} mm: moves {numpy.abs(moves).max():.2f} px as filmed, stabilised "
              f"{rms:.4f} px rms, {numpy.abs(residual).max():.4f} px at most")
        assert rms < CODEC_PX and numpy.abs(residual).max() < 2.0 * CODEC_PX, residual
    assert wandered > 5.0, "the recording does not shake: nothing is shown"
    with open(work / "run/truth.csv", encoding="ascii") as file:
        truth = numpy.array([float(row["dy_mm"]) for row in csv.DictReader(file) if row["marker"] == "mid"])
    target = -shifts(still, *place(0, 0), pitch) * MM_PER_PX / scale
    print(f"target: moved {truth[-1]:.3f} mm, drawn {target[-1]:.3f} mm: {target[-1] / truth[-1]:.4f} times")
    assert truth[-1] > 0.5
    assert numpy.abs(target - TIMES * truth).max() < 0.01 * TIMES * truth.max(), target - TIMES * truth
    # The index must precede the frames.
    head = (work / "out/stabilised.mp4").read_bytes()
    assert head.index(b"moov") < head.index(b"mdat")


if __name__ == "__main__":
    main()
