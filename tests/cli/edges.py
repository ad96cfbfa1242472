#!/usr/bin/python3
"""Input and output at the edges of what a file system, a terminal and a number can hold: edges.py PROGRAM WORK SOURCE CASE."""
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import runs
from runs import insist, rows, run, simulate

program, work, _ = runs.start()


def recording(frames=12):
    """A folder of numbered pictures, the site they show and the run that measured them all."""
    simulate(program, work / "run", "small-1xyz", frames)
    run([program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", "10", "--method", "two-stage",
         "--quiet", "-o", work / "whole"])
    return work / "run/frames"


def measured(folder, expected, *more):
    out = work / (folder.name + ".out")
    return out, run([program, "measure", folder, "--site", work / "run/site.toml", "--fps", "10", "--method", "two-stage",
                     "-o", out, *more], expected)


def times(folder):
    with open(folder / "displacement.csv", newline="") as file:
        return {int(row["frame"]): float(row["time_s"]) for row in csv.DictReader(file)}


def warnings_of(done):
    return [line for line in done.stderr.splitlines() if line.startswith(("warning: ", "note: "))]


def refuses(words, code, *named, stdout="", timeout=20):
    """One error line that holds `named`, within the time."""
    done = subprocess.run([str(word) for word in [program, *words]], capture_output=True, text=True, timeout=timeout,
                          stdin=subprocess.DEVNULL, check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    insist(done.returncode == code, f"{words}: exit {done.returncode}, expected {code}: {done.stderr}")
    insist(len(lines) == 1 and all(word in done.stderr for word in named), f"{words}: {done.stderr}, not {named}")
    insist("internal error" not in done.stderr, f"{words}: {done.stderr}")
    return done


def case_missing_pictures():
    """Rows of the frames that are there are those of the whole recording: same frame, same time, same values."""
    frames = recording()
    whole = {row[0]: row for row in rows(work / "whole")}

    def is_as_before(row):
        """The search starts from the frame before, which may be another one: the last digits differ."""
        old = whole[row[0]]
        return row[-1] == old[-1] and all(abs(float(row[k]) - float(old[k])) < 5e-5 for k in (2, 3))

    folder = work / "holes"
    shutil.copytree(frames, folder)
    (folder / "000005.png").unlink()
    (folder / "000006.png").unlink()
    (folder / "000008.png").unlink()
    (folder / "000008.png").symlink_to("nowhere")
    (folder / "000010.png").unlink()
    os.mkfifo(folder / "000010.png")
    out, done = measured(folder, 5)
    insist(times(out) == {n: n / 10 for n in range(12)}, f"frames or times moved: {times(out)}")
    for row in rows(out):
        is_hole = row[0] in {"5", "6", "8", "10"}
        insist(row[-1] == "decode-error" and row[2] == "NaN" if is_hole else is_as_before(row), f"not as in the whole: {row}")
    naming = [line for line in warnings_of(done) if "000005.png" in line]
    insist(len(naming) == 1 and "000006.png" in naming[0] and "000008.png" in naming[0] and "000010.png" in naming[0],
           f"no single warning names them all: {done.stderr}")
    insist(json.loads((out / "run.json").read_text())["complete"] is False, "the run is called complete")
    first = work / "later"  # the first picture is missing too: the next one is the reference frame
    shutil.copytree(frames, first)
    (first / "000000.png").unlink()
    (first / "000000.png").symlink_to("../nowhere")
    out, done = measured(first, 5)
    insist([row[-1] for row in rows(out)] == ["decode-error"] + 11 * ["ok"], f"{rows(out)}")
    insist(json.loads((out / "run.json").read_text())["reference_frame"] == 1, "the reference frame is not the first picture")


def case_stride_of_pictures():
    """Every second picture of a recording: the same rows, numbered one by one, and nothing to warn of."""
    frames = recording()
    folder = work / "second"
    folder.mkdir()
    for n in range(0, 12, 2):
        shutil.copy(frames / f"{n:06}.png", folder)
    out, done = measured(folder, 0)
    insist(list(times(out)) == list(range(6)), f"frames: {times(out)}")
    insist(not warnings_of(done), done.stderr)


def case_special_files():
    """Nothing waits for a FIFO, and nothing but a plain file is read."""
    simulate(program, work / "run", "small-1xyz", 2)
    site = work / "run/site.toml"
    fifo, folder = work / "f.fifo", work / "folder"
    os.mkfifo(fifo)
    folder.mkdir()
    for what, kind in [(fifo, "it is a FIFO"), ("/dev/zero", "it is a device")]:
        refuses(["measure", what, "--pitch", "10mm"], 3, kind)
        refuses(["inspect", what, "--pitch", "10mm"], 3, kind)
        refuses(["calibrate", what, "--pitch", "10mm", "-o", work / "camera.toml"], 3, kind)
        refuses(["simulate", what, "-o", work / "out"], 2, str(what))
        refuses(["plan", "--distance", "5m", "--camera", what], 2, str(what))
    for what, kind in [(fifo, "it is a FIFO"), ("/dev/zero", "it is a device"), (folder, "it is a folder")]:
        refuses(["measure", work / "run/frames", "--site", what], 2, kind)
        refuses(["measure", work / "run/frames", "--site", site, "--camera", what], 2, kind)
    for name in ["run.mgj", "run.json"]:
        (work / "dir").mkdir()
        os.mkfifo(work / "dir" / name)
        refuses(["solve", work / "dir"], 3, "FIFO" if name == "run.mgj" else "run.mgj")
        refuses(["export", work / "dir"], 3, "dir")
        shutil.rmtree(work / "dir")
    insist(not (work / "out").exists() and not (work / "camera.toml").exists(), "something was written")


if __name__ == "__main__":
    globals()[sys.argv[4]]()
