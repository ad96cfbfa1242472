#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the provisional rows of `live`, and the final ones, with the truth of simulated footage.

    live_study.py --program MOIREGAUGE [--seeds N] [--frames 161] [--pace 2] [--scenarios still,sway] [--keep FOLDER]

Prints a table with one row per scenario.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import pathlib
import shutil
import statistics
import tempfile

from errors_of_run import run

FPS = 10
JOBS = 2  # runs at the same time
SWAY = [f"rotation.{axis}.{key}={value}" for axis, hertz, phase in (("x", 0.31, 0), ("y", 0.23, 60), ("z", 0.17, 120))
        for key, value in (("amplitude", 0.4), ("frequency_hz", hertz), ("phase_deg", phase))]
PUSHED = ["rotation.x.knots=[[8, 0], [8.1, 0.6]]", "rotation.y.knots=[[8, 0], [8.1, -0.4]]", "shift.x.knots=[[8, 0], [8.1, 3]]"]
VIDEOS = {"x264": "video.mp4", "mjpeg": "video.mkv"}

# Name: footage of the simulator, and its settings.
SCENARIOS = {
    "still": ("small-still", []),
    "still, noise 4 DN": ("small-still", ["noise.sigma=4"]),
    "turning 1 deg": ("small-1xyz", []),
    "turning 8 deg": ("rig-8xyz", []),
    "sway": ("small-still", SWAY),
    "sway, lens -1 %": ("small-still", [*SWAY, "lens.k1=-0.370"]),
    "turning 1 deg, lens -2 %": ("small-1xyz", ["lens.k1=-0.740"]),
    "pushed": ("small-still", PUSHED),
    "blur": ("small-still", [*SWAY, "sensor.defocus_px.knots=[[0, 0], [8, 1.5], [16, 0]]"]),
    "light": ("small-still", [*SWAY, "light.flicker.knots=[[0, 0], [6, 0], [6.5, -0.4], [12, -0.4], [13, 0.1]]",
                              "light.slope_x.knots=[[0, 0], [16, 0.3]]"]),
    "covered": ("small-covered", []),
    "knocked, 6 references": ("small-six-slip", []),
    "knocked, 4 references": ("small-still", [*SWAY, "marker.NE.dy.knots=[[8, 0], [8.1, 0.3]]"]),
    "creeping, 6 references": ("small-six-slip", ["marker.NE.dy.knots=[[2, 0], [16, 1]]"]),
    "creeping, 4 references": ("small-1xyz", ["marker.NE.dy.knots=[[2, 0], [16, 1]]"]),
    "fast target": ("small-walk", []),
    "target off the plane": ("small-travel-5", []),
    "telephone tone": ("small-1xyz", ["processing.tone=s-curve:0.3", "processing.sharpen=0.6"]),
    "average over time": ("small-1xyz", ["processing.recursion=0.5"]),
    "repeated frames": ("small-1xyz", ["timing.repeated=[[20, 22], [30, 32], [60, 63], [110, 114]]"]),
    "rolling shutter": ("small-still", [*SWAY, "sensor.readout_s=0.02"]),
    "focal length drifts": ("small-still", [*SWAY, "lens.zoom.knots=[[0, 0], [16, 0.001]]"]),
    "drone": ("small-drone", []),
    "H.264": ("small-still", SWAY, "x264"),
    "H.264, still": ("small-still", [], "x264"),
    "Motion JPEG": ("small-still", SWAY, "mjpeg"),
}


class Rows:
    """Rows of a table of displacements, judged by the truth. A lie is an ok row with an error above 5 u and 0.5 um."""

    def __init__(self, table, truth, reference):
        self.rows = self.ok = self.inside = self.values = self.lies = 0
        self.largest = 0.0  # error / u
        self.u_mm = []
        self.value = {}  # by frame, marker and axis: mm and u of ok rows
        for row in table:
            if int(row["frame"]) <= reference:
                continue
            self.rows += 1
            if row["status"] != "ok":
                continue
            self.ok += 1
            self.add(row, truth, str(reference))

    def add(self, row, truth, reference):
        is_lie = False
        for axis in "dx", "dy":
            value, u = float(row[f"{axis}_mm"]), float(row[f"u_{axis}_mm"])
            now, then = truth[row["frame"], row["marker"]], truth[reference, row["marker"]]
            if math.isnan(value):
                continue
            error = abs(value - float(now[f"{axis}_mm"]) + float(then[f"{axis}_mm"]))
            self.values += 1
            self.inside += error <= 1.96 * u
            self.largest = max(self.largest, error / u)
            self.u_mm.append(u)
            self.value[int(row["frame"]), row["marker"], axis] = value, u
            is_lie = is_lie or error > max(5 * u, 5e-4)
        self.lies += is_lie


def largest_step(published, final):
    """Returns the largest change of published minus final values from one frame to the next, over the larger u of both frames.

    Both have the noise of the same observation, so changes of scene remain.
    """
    largest, last = 0.0, {}
    for (frame, marker, axis), (value, u) in published.value.items():
        if (frame, marker, axis) not in final.value:
            continue
        difference = value - final.value[frame, marker, axis][0]
        before, then, u_then = last.get((marker, axis), (None, None, None))
        if before == frame - 1:
            largest = max(largest, abs(difference - then) / max(u, u_then))
        last[marker, axis] = frame, difference, u
    return largest


def median_ratio(published, final):
    both = [u / final.value[key][1] for key, (_, u) in published.value.items() if key in final.value]
    return statistics.median(both) if both else math.nan


class Tally:
    """Figures of one scenario over its sequences."""

    def __init__(self):
        self.frames, self.published, self.final, self.steps, self.ratios = 0, [], [], [], []

    def add(self, frames, published, final):
        self.frames += frames
        self.published.append(published)
        self.final.append(final)
        self.steps.append(largest_step(published, final))
        self.ratios.append(median_ratio(published, final))

    def columns(self):
        ratios = [ratio for ratio in self.ratios if not math.isnan(ratio)]
        ratio = f"{statistics.median(ratios):.2f}" if ratios else "-"
        return (f"{len(self.published)} | {self.frames} | {judged(self.published)} | {max(self.steps):.2f} | {ratio} | "
                f"{judged(self.final)} |")


def judged(sequences):
    """Returns share ok, coverage with its standard error, lies and the largest error. The frames of a sequence share its draw."""
    rows, values = sum(s.rows for s in sequences), sum(s.values for s in sequences)
    share = f"{100 * sum(s.ok for s in sequences) / max(1, rows):.1f} %"
    if not values:
        return f"{share} | - | 0 | -"
    coverage = sum(s.inside for s in sequences) / values
    scatter = math.sqrt(sum((s.inside - coverage * s.values) ** 2 for s in sequences)) / values
    return (f"{share} | {100 * coverage:.1f} +- {100 * scatter:.1f} % | {sum(s.lies for s in sequences)} | "
            f"{max(s.largest for s in sequences):.1f}")


def table(path):
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def sequence(options, name, seed, folder):
    """Plays one clip. Returns frames, published and final rows."""
    scene, settings, *codec = SCENARIOS[name]
    clip, out = folder / "clip", folder / "out"
    words = [*settings, "truth.draw_known_to=true", f"sensor.fps={FPS}"]
    run([options.program, "simulate", scene, "--frames", options.frames, "--seed", seed, "--markers-only", "--quiet", "-o", clip,
         *[word for setting in words for word in ("--set", setting)], *(["--codec", codec[0]] if codec else [])])
    footage = [clip / VIDEOS[codec[0]]] if codec else [clip / "frames", "--fps", FPS]
    run([options.program, "live", *footage, "--site", clip / "site.toml", "--pace", options.pace, "--quiet", "-o", out])
    truth = {(row["frame"], row["marker"]): row for row in table(clip / "truth.csv")}
    reference = json.loads((out / "run.json").read_text())["reference_frame"]
    published, final = (Rows(table(out / name), truth, reference) for name in ("live.csv", "displacement.csv"))
    return json.loads((out / "live.json").read_text())["frames"], published, final


def one(options, name, seed):
    if options.keep:
        folder = options.keep / f"{name}-{seed}".replace(" ", "-").replace(",", "")
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        return sequence(options, name, seed, folder)
    with tempfile.TemporaryDirectory() as temporary:
        return sequence(options, name, seed, pathlib.Path(temporary))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=161)
    parser.add_argument("--pace", type=float, default=2.0, help=f"times {FPS} frames/s")
    parser.add_argument("--seeds", type=int, default=2, help="sequences per scenario")
    parser.add_argument("--scenarios", help="names, separated by semicolons")
    parser.add_argument("--keep", type=pathlib.Path, help="folder in which clips and runs remain")
    options = parser.parse_args()
    options.program = options.program.resolve()
    print("| scenario | sequences | frames | provisional: ok | within 1.96 u | lies | largest error / u | largest step / u | u / final u | "
          "final: ok | within 1.96 u | lies | largest error / u |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for name in options.scenarios.split(";") if options.scenarios else SCENARIOS:
        tally = Tally()
        with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
            for result in pool.map(lambda seed: one(options, name, seed), range(1, 1 + options.seeds)):
                tally.add(*result)
        print(f"| {name} | {tally.columns()}", flush=True)


main()
