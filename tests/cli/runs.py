"""Functions shared by the scripts of this folder: run the program, read its results."""
import csv
import math
import pathlib
import shutil
import subprocess
import sys


def start():
    """Returns the program, an empty working folder and the source tree, from the command line."""
    program, work, source = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    return program, work, source


def run(command, expected=0):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != expected:
        sys.exit(f"exit {done.returncode}, expected {expected}: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done


def simulate(program, where, scenario="small-1xyz", frames=4, *more):
    run([program, "simulate", scenario, "--frames", frames, "--markers-only", "-o", where, *more])


def rows(folder, keep=("frame", "marker", "dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm", "status")):
    with open(folder / "displacement.csv", newline="") as file:
        return [tuple(row[name] for name in keep) for row in csv.DictReader(file)]


def errors_of_dy(folder, clip):
    """Returns error and u of dy (um) of the ok rows after frame 0, relative to the truth of a clip with one target."""
    with open(clip / "truth.csv", encoding="ascii", newline="") as file:
        truth = {row["frame"]: float(row["dy_mm"]) for row in csv.DictReader(file)}
    return [(1e3 * (float(dy) - truth[frame]), 1e3 * float(u)) for frame, dy, u, status in rows(folder, ("frame", "dy_mm", "u_dy_mm", "status"))
            if status == "ok" and frame != "0"]


def rms_of(pairs):
    """Returns the rms of the first and of the second values, NaN if there are none."""
    return [math.sqrt(sum(v * v for v in values) / len(pairs)) for values in zip(*pairs)] or [math.nan, math.nan]


def insist(condition, message):
    if not condition:
        sys.exit(message)


def tag_rotation(video, degrees, out):
    """Copies a video and adds a tag that rotates the image counter-clockwise. FFmpeg 6 replaced the option for this."""
    version = run(["ffmpeg", "-version"]).stdout.split("version ")[1]
    is_old = version.startswith(("4", "5"))
    before, after = ([], ["-metadata:s:v:0", f"rotate={degrees}"]) if is_old else (["-display_rotation:v:0", str(degrees)], [])
    run(["ffmpeg", "-nostdin", "-loglevel", "error", *before, "-i", video, "-c", "copy", *after, out])
