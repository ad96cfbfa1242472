"""Checks that a rotation tag is applied: displacements are those of the image as displayed, for all tags.

A phone stores frames as read from the sensor, with a tag for the display.
"""
import numpy

from pictures import read_png, write_png
from runs import insist, rows, run, simulate, start, tag_rotation

program, work, _ = start()
simulate(program, work / "run")
site = work / "run/site.toml"
run([program, "measure", work / "run/frames", "--site", site, "--fps", "10", "-o", work / "upright"])
expected = rows(work / "upright", ("frame", "marker", "dx_mm", "dy_mm", "status"))
for tag in [0, 90, 180, 270]:
    stored = work / f"stored{tag}"
    stored.mkdir()
    for path in sorted((work / "run/frames").glob("*.png")):
        # The tag rotates the stored image by 90 degrees COUNTER-clockwise. The image is therefore stored rotated clockwise.
        write_png(stored / path.name, numpy.ascontiguousarray(numpy.rot90(read_png(path), -tag // 90)))
    run(["ffmpeg", "-loglevel", "error", "-framerate", "10", "-i", stored / "%06d.png", "-c:v", "libx264", "-qp", "0",
         "-pix_fmt", "gray", work / f"plain{tag}.mp4"])
    tag_rotation(work / f"plain{tag}.mp4", tag, work / f"tagged{tag}.mp4")
    run([program, "measure", work / f"tagged{tag}.mp4", "--site", site, "-o", work / f"out{tag}"])
    got = rows(work / f"out{tag}", ("frame", "marker", "dx_mm", "dy_mm", "status"))
    insist(got == expected, f"tag {tag}:\n{got}\n{expected}")
