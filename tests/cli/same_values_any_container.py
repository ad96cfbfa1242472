"""Checks that equal grey levels as PNG, FFV1, uncompressed video and 16-bit TIFF give equal displacements.

A video that is read in place gives the same bytes as a decoded one.
"""
from runs import insist, rows, run, simulate, start

program, work, _ = start()
simulate(program, work / "run")
site = work / "run/site.toml"
frames = work / "run/frames/%06d.png"
ffmpeg = ["ffmpeg", "-loglevel", "error", "-framerate", "10", "-i", frames]
run([*ffmpeg, "-c:v", "ffv1", "-pix_fmt", "gray", work / "clip.mkv"])
# 16-bit TIFF with the same values (not scaled by 257), one file with many pages.
run(["/usr/bin/python3", "-c", """
import sys, pathlib
import numpy, struct, zlib
sys.path.insert(0, sys.argv[1])
from pictures import read_png, write_tiff_pages
folder = pathlib.Path(sys.argv[2])
write_tiff_pages(sys.argv[3], [read_png(path).astype("<u2") for path in sorted(folder.glob("*.png"))])
""", __file__.rsplit("/", 1)[0], work / "run/frames", work / "stack.tif"])
run([program, "measure", work / "run/frames", "--site", site, "--fps", "10", "-o", work / "png"])
run([program, "measure", work / "clip.mkv", "--site", site, "-o", work / "ffv1"])
run([program, "measure", work / "stack.tif", "--site", site, "--fps", "10", "-o", work / "tiff"])
for name, codec in [("raw.avi", "rawvideo"), ("packed.avi", "ffv1"), ("raw.mkv", "rawvideo")]:
    run([*ffmpeg, "-c:v", codec, "-pix_fmt", "gray", work / name])
    for threads in ["1", "2"]:
        run([program, "measure", work / name, "--site", site, "--threads", threads, "-o", work / f"{name}-{threads}"])
in_place, decoded = "raw.avi raw.mkv".split(), {"raw.avi": "packed.avi-2", "raw.mkv": "ffv1"}
for name in in_place:
    want = (work / decoded[name] / "displacement.csv").read_bytes()
    for threads in ["1", "2"]:
        got = (work / f"{name}-{threads}" / "displacement.csv").read_bytes()
        insist(got == want, f"{name} in place, {threads} threads, differs from the decoder's")
expected = rows(work / "png", ("frame", "marker", "dx_mm", "dy_mm", "status"))
insist(len(expected) == 4, f"4 rows expected: {expected}")
for name in ["ffv1", "tiff"]:
    got = rows(work / name, ("frame", "marker", "dx_mm", "dy_mm", "status"))
    insist(got == expected, f"{name} differs from png:\n{got}\n{expected}")
