#!/usr/bin/python3
"""Tests the figures of a run with a covered target: figures.py MOIREGAUGE WORK.

One column is 85 mm = 240.94 points wide. The band of each axis has two parts, before and after the gap. A run that is
too short for a spectrum reports that and has the other figures. `solve` draws all figures except the overlay.
"""
import pathlib
import re
import shutil
import subprocess
import sys

WIDTH = 85.0 * 72.0 / 25.4


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    assert done.returncode in (0, 5), f"{words}: exit {done.returncode}: {done.stderr}"
    return done


def main():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    run(program, "simulate", "small-1x", "--markers-only", "--quiet", "--frames", 80, "--set", "sensor.fps=30",
        "--set", "marker.mid.cover.frames=[[60, 64]]", "-o", work / "run")
    run(program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 30, "--figures", "pdf,svg,png", "-o", work / "out")
    names = sorted(path.name for path in (work / "out/figures").iterdir())
    assert names == sorted(f"{name}.{kind}" for name in ["camera", "displacement", "overlay", "spectrum"] for kind in ["pdf", "png", "svg"]), names
    for path in (work / "out/figures").glob("*.svg"):
        width = float(re.search(r'<svg [^>]*width="([0-9.]+)(?:pt)?"', path.read_text()).group(1))
        assert abs(width - WIDTH) < 0.01, f"{path.name} is {width} points wide"
    drawing = (work / "out/figures/displacement.svg").read_text()
    bands = len(re.findall(r'opacity(?::|=")0\.28', drawing))
    assert bands == 4, f"{bands} pieces of bands, expected 2 axes with 2 pieces each"
    short = run(program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", 30, "--frames", "0:20",
                "--figures", "svg", "-o", work / "short")
    assert re.search("^note: (there is )?no figure of the spectrum .+", short.stderr, re.M), short.stderr
    assert not (work / "short/figures/spectrum.svg").exists() and (work / "short/figures/displacement.svg").exists()
    run(program, "solve", work / "out", "-o", work / "again", "--figures", "png")
    assert sorted(path.name for path in (work / "again/figures").iterdir()) == ["camera.png", "displacement.png", "spectrum.png"]
    assert (work / "again/figures/displacement.png").read_bytes() == (work / "out/figures/displacement.png").read_bytes()


if __name__ == "__main__":
    main()
