"""Kills runs of `live` at random moments, resumes each, and compares the rows with the truth."""
import json
import random
import shutil
import signal
import time

from trial import FPS, MAX_LOST_S, SEED, Figures, finish, frames_of, insist, longest_gap, solve, start, stored_frames, table, whole_rows

KILLS = 200
PER_RUN = 10  # kills of one run
MAX_S = 4.0  # longest time from a start to its kill
QUEUED = 8  # frames that wait in the source while the reference frame is learned; those after them are lost
NS_PER_S = 1e9


def reference_frame(folder):
    return json.loads((folder / "run.json").read_text())["reference_frame"]


class Kills:
    """Counts over all kills."""

    def __init__(self, trial):
        self.trial, self.rng = trial, random.Random(SEED)
        self.kills = self.starting = 0
        self.age_s, self.start_s, self.mute_s = [], [], []  # newest row at the kill; first row after a start; kills without new rows
        self.gap = self.starting_gap = 0  # frames
        self.unpublished = self.frames = self.ok = self.rows = self.wrong = self.solved = 0
        self.moved_zeros = 0

    def folders(self, out):
        """Returns the folders of a run that hold frames, the oldest first."""
        found = [out, out.with_name(out.name + ".unfinished"), *sorted(out.glob("segment-*"))]
        return [path for path in found if stored_frames(path) > 0]

    def published(self, out):
        return [row for folder in self.folders(out) for row in whole_rows(folder / "live.csv")]

    def solve_stored(self, out):
        """Solves all folders that have frames. Returns their rows. Each must have the zero of the run."""
        rows = []
        for folder in self.folders(out):
            rows += solve(self.trial.program, folder, self.trial.work / "solved")
            self.solved += 1
            self.moved_zeros += reference_frame(self.trial.work / "solved") != 0
        return rows

    def kill(self, command, out):
        began_ns = time.time_ns()
        process = start(command)
        time.sleep(self.rng.uniform(0.0, MAX_S))
        killed_ns = time.time_ns()
        process.kill()
        insist(process.wait() == -signal.SIGKILL, f"exit {process.returncode} before kill {self.kills}")
        self.kills += 1
        rows = self.published(out)
        new = [int(row["utc_ns"]) for row in rows if int(row["utc_ns"]) > began_ns]
        is_learning = rows and int(rows[-1]["frame"]) <= QUEUED
        self.starting += is_learning or not new
        if new:
            self.start_s.append((min(new) - began_ns) / NS_PER_S)
        if new and not is_learning:
            self.age_s.append((killed_ns - max(new)) / NS_PER_S)
        if not new:
            self.mute_s.append((killed_ns - began_ns) / NS_PER_S)
        return self.solve_stored(out)

    def one_run(self, number, kills):
        """Kills one run `kills` times. Every second run has segments. At the end it is completed without further kills."""
        out = self.trial.work / f"run-{number}"
        more = ["--segment", "4s"] if number % 2 else []
        stored = set()
        for kill in range(kills):
            found = set(frames_of(self.kill(self.trial.live(out, 1, *more, *(["--resume"] if kill else [])), out)))
            insist(stored <= found, f"frames of earlier kills are lost: {sorted(stored - found)}")
            stored = found
        last = max(stored, default=0)
        finish(self.trial.live(out, "max", *more, "--resume", "--for", "2s"))
        self.evaluate(out, last)
        shutil.rmtree(out)

    def evaluate(self, out, last):
        """Compares a complete run with the truth. `last`: last frame before the last kill."""
        final, published = [], self.published(out)
        for folder in self.folders(out):
            rows = table(folder / "displacement.csv")
            self.moved_zeros += reference_frame(folder) != 0
            solve(self.trial.program, folder, self.trial.work / "solved")
            insist((self.trial.work / "solved/displacement.csv").read_bytes() == (folder / "displacement.csv").read_bytes(),
                   f"solve gives other rows: {folder}")
            self.solved += 1
            final += rows
        frames, shown = frames_of(final), frames_of(published)
        insist(frames[-1] > last, "the run did not continue")
        insist(set(shown) <= set(frames), "a row is in live.csv only")
        insist(len(final) == len(frames) and len(published) == len(shown), "a frame has two rows")
        for numbers in frames, shown:
            self.starting_gap = max(self.starting_gap, longest_gap([n for n in numbers if n <= QUEUED] + [n for n in numbers if n > QUEUED][:1]))
            self.gap = max(self.gap, longest_gap([n for n in numbers if n > QUEUED]))
        self.unpublished += len(set(frames) - set(shown))
        self.frames += len(frames)
        self.rows += len(final)
        self.ok += sum(row["status"] == "ok" for row in final)
        self.wrong += self.trial.count_wrong(final) + self.trial.count_wrong(published)


def kills(trial):
    """200 kills -9 with --resume"""
    trial.clip(int((PER_RUN * MAX_S + 5) * FPS))
    all_kills, total = Kills(trial), max(2, round(KILLS * trial.scale))
    for number in range((total + PER_RUN - 1) // PER_RUN):
        all_kills.one_run(number, min(PER_RUN, total - number * PER_RUN))
        print(f"{all_kills.kills} kills", file=trial.log, flush=True)
    found, figures = all_kills, Figures()
    age, slow = max(found.age_s, default=0.0), max(found.start_s, default=0.0)
    mute = max(found.mute_s, default=0.0)
    figures.add(f"{total} kills at random moments, each with `--resume`: newest row on the disk <= 1 s old",
                f"{found.kills} kills: oldest {age:.2f} s; {found.starting} of them while the run started (first rows after {slow:.2f} s "
                f"at the latest)", found.kills == total and age <= MAX_LOST_S and mute <= slow + MAX_LOST_S)
    figures.add("<= 1 s of rows lost each", f"longest gap {found.gap / FPS:.2f} s ({found.starting_gap / FPS:.2f} s while the reference frame was "
                f"learned); {found.unpublished} of {found.frames} frames are in displacement.csv only", found.gap <= MAX_LOST_S * FPS)
    figures.add("zero unchanged", f"{found.moved_zeros} other zeros; {found.wrong} wrong rows ({found.ok} of {found.rows} ok)",
                found.moved_zeros == 0 and found.wrong == 0 and 2 * found.ok > found.rows)
    figures.add("`solve` reads everything", f"{found.solved} folders solved", found.solved > 0)
    return figures
