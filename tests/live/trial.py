"""Functions shared by the trials of `moiregauge live`: the long clip and its truth, processes, gaps between rows, figures."""
import atexit
import os
import shutil
import subprocess
import sys

from live_sources import is_wrong, table
from runs import insist, run  # noqa: F401
from survival import Records, long_clip, shown_frame

SEED = 25
FPS = 25  # rate of the long clip
FEW = 120  # simulated frames of the long clip
MAX_LOST_S = 1.0
MAX_U = 5  # a wrong row has the status ok and is off by more


class Figures:
    """The figures of one trial: what was required, what was measured, and if all requirements are met."""

    def __init__(self):
        self.required, self.measured, self.is_met = [], [], True

    def add(self, required, measured, is_met):
        self.required.append(required)
        self.measured.append(measured if is_met else f"**{measured}**")
        self.is_met = self.is_met and is_met

    def note(self, measured):
        self.measured.append(measured)


class Trial:
    """The program, an empty folder, and a scale of the durations (1: as required)."""

    def __init__(self, program, work, scale):
        self.program, self.work, self.scale, self.log = program, work, scale, sys.stderr
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)

    def neighbour(self, name):
        """Returns a program that was built with `moiregauge`."""
        return self.program.parent / name

    def clip(self, frames, converted=None):
        """Makes the long clip. `live` replays it at FPS. `converted`: writes a picture in another format."""
        self.frames, self.site = long_clip(self.program, self.work, frames, "small-1x", FEW, converted)
        self.truth = {int(row["frame"]): (float(row["dx_mm"]), float(row["dy_mm"])) for row in table(self.work / "few/truth.csv")
                      if row["marker"] == "mid"}

    def live(self, out, pace, *more):
        words = [self.program, "live", self.frames, "--site", self.site, "--fps", FPS, "--pace", pace, "-o", out, "--quiet", *more]
        return [str(word) for word in words]

    def count_wrong(self, samples, reference=0):
        """Returns the number of wrong rows of the long clip."""
        then = self.truth[shown_frame(reference, FEW)]
        return sum(is_wrong(row, self.truth[shown_frame(int(row["frame"]), FEW)], then, MAX_U) for row in samples)


def start(command, **more):
    """Starts a process that ends with this one at the latest."""
    process = subprocess.Popen([str(word) for word in command], text=True, **more)
    atexit.register(lambda: process.poll() is None and process.kill())
    return process


def finish(command, expected=(0, 5)):
    """Runs a command to its end. 5: some rows are not ok. Returns its errors."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    insist(done.returncode in expected, f"exit {done.returncode}: {' '.join(map(str, command))}\n{done.stderr}")
    return done.stderr


def solve(program, folder, out):
    """Runs `solve`. Returns its rows. It ends with 130 for an unfinished run, and with 4 or 5 if few rows are ok."""
    shutil.rmtree(out, ignore_errors=True)
    finish((program, "solve", folder, "-o", out, "--quiet"), (0, 4, 5, 130))
    return table(out / "displacement.csv")


def stored_frames(folder):
    """Returns the number of frames in a journal."""
    path = folder / "run.mgj"
    return Records(path.read_bytes()).frames() if path.exists() else 0


def whole_rows(path):
    """Returns the rows of live.csv without the incomplete one that a kill may leave."""
    return [row for row in table(path) if row["utc_ns"] and len(row["utc_ns"]) == 19] if path.exists() else []


def frames_of(samples):
    return sorted({int(row["frame"]) for row in samples})


def longest_gap(frames):
    """Returns the largest number of missing frames between neighbours."""
    return max((b - a - 1 for a, b in zip(frames, frames[1:])), default=0)


def load():
    """Returns the load average of the last minute."""
    return os.getloadavg()[0]
