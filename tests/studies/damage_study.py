#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Measures damaged videos: truncation at every 1 % and seeded mutations of five inputs, one by one.

    damage_study.py --program MOIREGAUGE [--mutations 500] [--step 1] [--jobs N] [--only avi,mp4] [--keep DIR]

damage_study_intro.md defines "damaged", "wrong" and "lie". Prints tables in Markdown. Ends 1 after a crash or timeout.
"""
import argparse
import collections
import concurrent.futures
import csv
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

H264 = ["-pix_fmt", "yuv420p", "-c:v", "libx264", "-g", "8", "-bf", "2", "-crf", "18", "-threads", "1"]
INPUTS = {
    "mp4": [*H264, "-movflags", "faststart"],
    "mkv": [*H264, "-cluster_time_limit", "200"],
    "ts": H264,
    "avi": ["-c:v", "mjpeg", "-q:v", "2", "-pix_fmt", "yuvj420p"],
    "png": None,
}
FRAMES = 24
Result = collections.namedtuple("Result", "input kind damaged crashed hung exit wrong_rows lies ok_rows name")


def ffmpeg(*words):
    return subprocess.run(["ffmpeg", "-nostdin", "-loglevel", "quiet", *map(str, words)], capture_output=True, check=False).stdout


def pictures_of(path):
    """Returns the frames that ffmpeg shows: time in s (for PNG files: the number) -> MD5 of the grey levels."""
    if path.is_dir():
        files = sorted(path.glob("*.png"))
        return {i: ffmpeg("-i", file, "-f", "md5", "-") if file.stat().st_size else b"" for i, file in enumerate(files)}
    shown, tick = {}, 1.0
    for line in ffmpeg("-i", path, "-an", "-vf", "extractplanes=y", "-vsync", "passthrough", "-copyts", "-f", "framemd5", "-").decode().splitlines():
        if line.startswith("#tb"):
            above, below = line.split(":")[1].split("/")
            tick = int(above) / int(below)
        if line.startswith("#"):
            continue
        _, _, pts, _, _, sum_ = [word.strip() for word in line.split(",")]
        while pts in shown:  # a repeated time stamp is another frame
            pts += "+"
        shown[pts] = sum_
    times = [(float(pts.rstrip("+")) * tick, len(pts) - len(pts.rstrip("+")), sum_) for pts, sum_ in shown.items()]
    first = times[0][0] if times else 0.0
    return {(round(at - first, 3), again): sum_ for at, again, sum_ in times}


def flips(data, rng):
    for _ in range(1 << rng.randint(0, 5)):  # 1 to 32 bits; a single one is the hardest to detect
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return data


def burst(data, rng):
    at = rng.randrange(len(data) - 40)
    data[at:at + 40] = rng.randbytes(40)
    return data


def hole(data, rng):
    size = rng.randint(64, len(data) // 20)
    at = rng.randrange(len(data) - size)
    data[at:at + size] = bytes(size)
    return data


def cut_out(data, rng):
    size = rng.randint(1, len(data) // 20)
    at = rng.randrange(len(data) - size)
    return data[:at] + data[at + size:]


def swap(data, rng):
    size = rng.randint(16, len(data) // 40)
    a, b = sorted(rng.randrange(len(data) - size) for _ in range(2))
    if b - a >= size:
        data[a:a + size], data[b:b + size] = data[b:b + size], data[a:a + size]
    return data


MUTATIONS = [flips, burst, hole, cut_out, swap]


class Study:
    def __init__(self, options, work):
        self.program, self.work, self.options = options.program, work, options
        self.site = work / "run/site.toml"
        self.whole = {}   # input -> path
        self.shown = {}   # input -> result of pictures_of
        self.values = {}  # input -> rows of the undamaged run
        self.seconds = {}
        self.run(["simulate", "small-1xyz", "--frames", FRAMES, "--markers-only", "--quiet", "-o", work / "run"])
        for name in options.only.split(","):
            path = work / "run/frames" if name == "png" else work / f"whole.{name}"
            if name != "png":
                ffmpeg("-framerate", 25, "-i", work / "run/frames/%06d.png", *INPUTS[name], "-bitexact", path)
            self.whole[name], self.shown[name] = path, pictures_of(path)
            begin = time.monotonic()
            code, self.values[name] = self.measure(path, work / f"out-{name}")
            self.seconds[name] = time.monotonic() - begin
            print(f"{name}: {FRAMES} frames, exit {code}, {self.seconds[name]:.1f} s", file=sys.stderr)

    def run(self, words, timeout=None):
        return subprocess.run([self.program, *map(str, words)], capture_output=True, check=False, timeout=timeout).returncode

    def measure(self, path, out, timeout=None):
        """Returns the exit code (None: timeout) and the rows of the run."""
        words = ["measure", path, "--site", self.site, "--quiet", "-o", out, *(["--fps", 25] if path.is_dir() else [])]
        try:
            code = self.run(words, timeout)
        except subprocess.TimeoutExpired:
            return None, []
        table = out / "displacement.csv"
        return code, list(csv.DictReader(table.open())) if table.exists() else []

    def mutant(self, name, kind, number):
        """Writes a damaged copy of the input and returns its path. Its name is the seed."""
        label = f"{name}-{kind if isinstance(kind, str) else kind.__name__}-{number}"
        rng = random.Random(label)
        place = self.work / label
        place.mkdir()
        if name != "png":
            data = bytearray(self.whole[name].read_bytes())
            path = place / f"a.{name}"
            path.write_bytes(data[:len(data) * number // 100] if kind == "cut" else kind(data, rng))
            return path
        files = sorted(self.whole[name].glob("*.png"))
        left = sum(file.stat().st_size for file in files) * number // 100
        victim = rng.randrange(len(files))
        for i, file in enumerate(files):
            data = bytearray(file.read_bytes())
            if kind == "cut":
                data, left = data[:max(left, 0)], left - len(data)
            elif i == victim:
                data = kind(data, rng)
            if data or kind != "cut":
                (place / file.name).write_bytes(data)
        return place

    def judge(self, name, kind, number):
        path = self.mutant(name, kind, number)
        place = path if path.is_dir() else path.parent
        out = place.with_name(place.name + "-out")
        code, rows = self.measure(path, out, 3 * self.seconds[name] + 10)
        now, before = pictures_of(path), self.shown[name]
        if name == "png" and kind == "cut":  # a folder with fewer images is not damaged
            before = {i: before[i] for i in now}
        wrong, lies, good = 0, 0, 0
        known = {row["time_s"][:5]: row for row in self.values[name]}
        shift = self.shift_of(rows, known)
        for i, row in enumerate(rows):
            good += row["status"] == "ok"
            key = i if name == "png" else (round(float(row["time_s"]), 3), 0)
            if row["status"] != "ok" or (key in before and now.get(key) == before[key]):
                continue
            wrong += 1
            lies += self.is_lie(row, known.get(row["time_s"][:5]), shift)
        if not self.options.keep:
            shutil.rmtree(place)
            shutil.rmtree(out, ignore_errors=True)
        label = kind if isinstance(kind, str) else kind.__name__
        crashed = code is not None and (code < 0 or code == 1 or code > 7)
        return Result(name, label, now != before, crashed, code is None, code, wrong, lies, good, f"{name}-{label}-{number}")

    @staticmethod
    def shift_of(rows, known):
        """Returns the undamaged run's row of this run's reference frame, which may differ from its own."""
        for row in rows:
            if row["status"] == "ok" and float(row["u_dx_mm"]) == 0.0 == float(row["dx_mm"]):
                return known.get(row["time_s"][:5])
        return None

    @staticmethod
    def is_lie(row, true, shift):
        if true is None or shift is None:
            return True
        for axis in ["dx_mm", "dy_mm"]:
            off = abs(float(row[axis]) - float(true[axis]) + float(shift[axis]))
            if off > 5 * float(row["u_" + axis]) and off > 5e-4:
                return True
        return False


def table(results, of):
    print(f"| {of} | runs | damaged | crashes | hangs | exit 0 | 3 | 4 | 5 | wrong ok rows (lies) in exit 0 | in exit 5 | whole, exit not 0 |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    groups = collections.defaultdict(list)
    for result in results:
        groups[result.input if of == "input" else result.kind].append(result)
    for group, members in [*sorted(groups.items()), ("all", results)]:
        bad = [r for r in members if r.damaged]

        def rows(code):
            return f"{sum(r.wrong_rows for r in bad if r.exit == code)} ({sum(r.lies for r in bad if r.exit == code)})"
        counts = [sum(r.exit == code for r in bad) for code in (0, 3, 4, 5)]
        print(f"| {group} | {len(members)} | {len(bad)} | {sum(r.crashed for r in members)} | {sum(r.hung for r in members)} | "
              f"{' | '.join(map(str, counts))} | {rows(0)} of {sum(r.ok_rows for r in bad if r.exit == 0)} | "
              f"{rows(5)} of {sum(r.ok_rows for r in bad if r.exit == 5)} | "
              f"{sum(r.exit != 0 for r in members if not r.damaged)} |")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--mutations", type=int, default=500)
    parser.add_argument("--step", type=int, default=1, help="step of the truncation in percent; 0: none")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default=",".join(INPUTS))
    parser.add_argument("--keep", type=pathlib.Path, help="leave all inputs and results there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if options.keep:
            options.keep.mkdir(parents=True)
        study = Study(options, options.keep or pathlib.Path(folder))
        inputs = list(study.whole)
        tasks = [(name, "cut", percent) for name in inputs for percent in range(options.step, 100, options.step)] if options.step else []
        tasks += [(inputs[i % len(inputs)], MUTATIONS[i // len(inputs) % len(MUTATIONS)], i) for i in range(options.mutations)]
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda task: study.judge(*task), tasks))
    for title, chosen in [("Truncated at every percent", [r for r in results if r.kind == "cut"]),
                          ("Mutated", [r for r in results if r.kind != "cut"])]:
        if chosen:
            print(f"{title}:\n")
            table(chosen, "input")
            if chosen[0].kind != "cut":
                table(chosen, "kind")
    silent = [r for r in results if r.damaged and r.exit == 0]
    print("Damaged and exit 0: " + (", ".join(f"{r.name} ({r.wrong_rows} wrong, {r.lies} lies)" for r in silent) or "none"), file=sys.stderr)
    alarms = [r for r in results if not r.damaged and r.exit != 0]
    print("Whole and not exit 0: " + (", ".join(f"{r.name} (exit {r.exit})" for r in alarms) or "none"), file=sys.stderr)
    failed = [r for r in results if r.crashed or r.hung]
    print("Crashed or hung: " + (", ".join(f"{r.name} (exit {r.exit})" for r in failed) or "none"), file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
