# SPDX-License-Identifier: Apache-2.0
"""Computes the errors of a run from the simulator's truth.csv, for studies."""
import csv
import json
import math
import subprocess
import sys

SURVEYED = "[known_to]\nposition_mm = 0.01\nrotation_deg = 0.001\nheight_mm = 0.01\nprint_scale = 0.0005\n"


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4, 5):
        sys.exit(f"exit {done.returncode}: {' '.join(map(str, command))}\n{done.stderr}")


def with_heights(site, heights_mm):
    """Returns the site file with the heights of the targets added."""
    for name, z_mm in heights_mm.items():
        site = site.replace(f'name = "{name}"\n', f'name = "{name}"\nz_mm = {z_mm}\n')
    return site


class Tally:
    """Statistics of the rows of runs: number of ok rows, their errors and u (mm), and lies.

    A lie is an ok row with an error above 5 u and 0.5 um.
    """

    def __init__(self):
        self.rows = self.ok = self.lies = 0
        self.pairs = {"dx": [], "dy": []}
        self.tones = []

    def add(self, out, truth_file):
        truth = {(r["frame"], r["marker"]): r for r in csv.DictReader(truth_file.open())}
        if not (out / "displacement.csv").exists():  # a refused run: no row is ok
            self.rows += len(truth) - len({marker for _, marker in truth})
            return
        result = json.loads((out / "run.json").read_text())
        reference = result["reference_frame"]
        self.tones.append(f"{result['input']['tone']} ({result['input']['tone_source']})")
        for r in csv.DictReader((out / "displacement.csv").open()):
            if int(r["frame"]) == reference:
                continue
            self.rows += 1
            if r["status"] != "ok":
                continue
            self.ok += 1
            lie = False
            for axis, pairs in self.pairs.items():
                now, then = truth[r["frame"], r["marker"]], truth[str(reference), r["marker"]]
                e = float(r[f"{axis}_mm"]) - float(now[f"{axis}_mm"]) + float(then[f"{axis}_mm"])
                u = float(r[f"u_{axis}_mm"])
                pairs.append((e, u))
                lie = lie or (abs(e) > 5 * u and abs(e) > 5e-4)
            self.lies += lie

    def merge(self, other):
        """Adds the rows of another tally."""
        self.rows, self.ok, self.lies = self.rows + other.rows, self.ok + other.ok, self.lies + other.lies
        self.tones += other.tones
        for axis, pairs in self.pairs.items():
            pairs += other.pairs[axis]

    def columns(self):
        """Returns the ok rows, rms errors, rms u, coverage and lies as cells of a table."""
        both = self.pairs["dx"] + self.pairs["dy"]
        inside = sum(abs(e) <= 1.96 * u for e, u in both) / max(1, len(both))
        errors = [rms_um(e for e, _ in self.pairs[axis]) for axis in ("dx", "dy")]
        stated = [rms_um(u for _, u in self.pairs[axis]) for axis in ("dx", "dy")]
        return (f"{self.ok} of {self.rows} | {errors[0]:.2f} / {errors[1]:.2f} | {stated[0]:.2f} / {stated[1]:.2f} | "
                f"{100 * inside:.1f} % | {self.lies} |")


def rms_um(values):
    squares = [v * v for v in values]
    return 1e3 * math.sqrt(sum(squares) / len(squares)) if squares else math.nan
