#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Repeats the minimal reproductions of 22 defects that 1850 hostile inputs found.

    hostile_study.py --program MOIREGAUGE [--cases 1,2,...]

Prints a table with one row per defect: what the program did at commit db8380a, and what it does now. Ends 1 if one of
them is still there.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

from errors_of_run import Tally

STEP = ["--set", "marker.mid.dx.knots=[[0,0],[4,0.12]]", "--set", "noise.sigma=0.8"]


class Done:
    """A finished command: exit code, output, time in s and peak memory in MB."""

    def __init__(self, words, timeout=600, limits="", **more):
        self.code, started = "no end", time.monotonic()
        command = [os.fsencode(word) if isinstance(word, (bytes, pathlib.Path)) else str(word).encode() for word in words]
        if limits:
            command = [b"bash", b"-c", limits.encode() + b'; exec "$@"', b"limited"] + command
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        try:
            more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "stdin": subprocess.DEVNULL} | more
            done = subprocess.run(command, timeout=timeout, check=False, **more)
            self.code = done.returncode
            self.text = ((done.stdout or b"") + (done.stderr or b"")).decode(errors="replace")
        except subprocess.TimeoutExpired:
            self.text = ""
        self.seconds = time.monotonic() - started
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.megabytes = after / 1024 if after > before else None

    def line(self, kind="error"):
        """Returns the first line of that kind without what is particular to this computer."""
        lines = [line for line in self.text.splitlines() if line.startswith(kind)]
        return lines[0] if lines else ""

    def says(self, *words):
        return all(word in self.text for word in words)


class Study:
    """The program, a folder for its files, and a small recording."""

    def __init__(self, program, folder):
        self.program, self.folder, self.used = program, folder, 0
        self.base = folder / "base"
        self.simulate("small-1xyz", 12, self.base)

    def run(self, *words, **more):
        return Done([self.program, *words], cwd=self.folder, **more)

    def simulate(self, scenario, frames, out, *settings):
        done = self.run("simulate", scenario, "--frames", frames, "--quiet", "-o", out, *settings)
        assert done.code == 0, done.text

    def fresh(self, name):
        """Returns a path that is not in use."""
        self.used += 1
        return self.folder / f"{name}{self.used}"

    def measured(self, clip, site, *options, **more):
        """Measures into a fresh folder. Returns the finished command and the folder."""
        out = self.fresh("out")
        return self.run("measure", clip, "--site", site, "--quiet", "-o", out, *options, **more), out

    def lies(self, clip, scene, *options):
        """Measures a clip of a scene. Returns the finished command and the tally of its rows."""
        done, out = self.measured(clip, scene / "site.toml", *options)
        tally = Tally()
        tally.add(out, scene / "truth.csv")
        return done, tally

    def ffmpeg(self, clip, video_filter, out, *more):
        subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i", clip, "-vf", video_filter, "-pix_fmt", "gray", "-c:v", "ffv1", *more, out],
                       check=True)

    def still(self):
        scene = self.folder / "still"
        if not scene.exists():
            self.simulate("small-still", 40, scene, "--markers-only", "--codec", "ffv1", *STEP)
        return scene


def rows_of(tally):
    return f"{tally.ok} of {tally.rows} rows ok, {tally.lies} lies"


def behind(study, filters):
    """Measures the still scene behind filters. Returns the sum of lies and a text."""
    scene, texts, lies = study.still(), [], 0
    for video_filter in filters:
        clip = study.folder / "filtered.mkv"
        study.ffmpeg(scene / "video.mkv", video_filter, clip)
        _, tally = study.lies(clip, scene)
        lies += tally.lies
        texts.append(f"`{video_filter}`: {rows_of(tally)}")
    return lies == 0, "; ".join(texts)


def case_1(study):
    return behind(study, ["hqdn3d=4:3:20:15", "tmix=frames=3", "atadenoise"])


def case_2(study):
    scene, clip = study.still(), study.folder / "doubled.mkv"
    study.ffmpeg(scene / "video.mkv", "scale=2048:1024:flags=neighbor", clip)
    _, tally = study.lies(clip, scene)
    return tally.lies == 0, rows_of(tally)


def case_3(study):
    scene, clip = study.still(), study.folder / "mirrored.mkv"
    study.ffmpeg(scene / "video.mkv", "hflip", clip)
    done, out = study.measured(clip, scene / "site.toml")
    warned = [w for w in json.loads((out / "run.json").read_text())["warnings"] if "mirror" in w]
    return bool(warned), f"exit {done.code}; " + (f"`{warned[0]}`" if warned else "no word")


def case_4(study):
    folder = study.fresh("gap")
    shutil.copytree(study.base / "frames", folder)
    for number in (5, 6):
        (folder / f"{number:06d}.png").unlink()
    done, out = study.measured(folder, study.base / "site.toml", "--fps", "10")
    rows = list(csv.DictReader((out / "displacement.csv").open()))
    lost = [row["frame"] for row in rows if row["status"] == "decode-error"]
    last = max(float(row["time_s"]) for row in rows)
    return lost == ["5", "6"] and abs(last - 1.1) < 1e-9, f"exit {done.code}; frames {' and '.join(lost)} `decode-error`; last time {last:.1f} s of 1.1 s"


def case_5(study):
    scene = study.folder / "travel"
    study.simulate("small-travel-5", 40, scene)
    done, _ = study.measured(scene / "frames", scene / "site.toml", "--fps", "10", "--rest", "0:40")
    return done.code == 2, f"exit {done.code}: `{done.line()}`"


def case_6(study):
    clip, memory = study.folder / "long.avi", {}
    for frames in (2000, 6000):
        subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-i", study.base / "frames/%06d.png", "-vf", "scale=512:256,loop=-1:12",
                        "-frames:v", str(frames), "-c:v", "mjpeg", "-q:v", "3", clip], check=True)
        out = study.fresh("out")
        with subprocess.Popen([study.program, "measure", clip, "--site", study.base / "site.toml", "--quiet", "-o", out],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            peak = 0
            while process.poll() is None:
                try:
                    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
                    peak = max([peak] + [int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM")])
                except OSError:
                    pass
                time.sleep(0.02)
        memory[frames] = (peak, (out / "run.mgj").stat().st_size)
    kilobytes = (memory[6000][0] - memory[2000][0]) / 4000
    journal = (memory[6000][1] - memory[2000][1]) / 4000 / 1024
    return kilobytes <= 3 and journal <= 2, f"{max(0, kilobytes):.1f} kB of memory and {journal:.1f} kB of run.mgj for each further frame"


def case_7(study):
    _, out = study.measured(study.base / "frames", study.base / "site.toml", "--fps", "10")
    link, fifo = study.folder / "dangling.csv", study.folder / "pipe.csv"
    link.symlink_to(study.folder / "nothing")
    os.mkfifo(fifo)
    codes = [study.run("export", out, "-o", target, "--replace", timeout=20).code for target in (link, fifo, "/dev/full", out / "run.mgj")]
    whole = link.is_symlink() and fifo.is_fifo() and pathlib.Path("/dev/full").is_char_device() and study.run("solve", out, "--quiet").code == 0
    return whole, f"exits {', '.join(map(str, codes))}; link, FIFO, device and run are {'as before' if whole else 'damaged'}"


def case_8(study):
    clip = study.folder / "late.mkv"
    subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", "10", "-i", study.base / "frames/%06d.png", "-c:v", "ffv1",
                    "-output_ts_offset", "5", clip], check=True)
    done, out = study.measured(clip, study.base / "site.toml")
    _, tally = study.lies(clip, study.base)
    lost = "decode-error" in (out / "displacement.csv").read_text()
    return done.code == 0 and not lost, f"exit {done.code}; {rows_of(tally)}; {'a' if lost else 'no'} `decode-error`"


def case_9(study):
    codes = []
    with open("/dev/full", "wb") as full:
        for words in (["help"], ["--version"], ["simulate", "--list"], ["inspect", "--json", study.base / "frames"],
                      ["measure", study.base / "frames", "--site", study.base / "site.toml", "--fps", "10", "--json", "-o", study.fresh("out")]):
            codes.append(study.run(*words, stdout=full).code)
    return codes == [6] * 5, "exits " + ", ".join(map(str, codes))


def case_10(study):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    folder = study.fresh("huge")
    folder.mkdir()
    header = struct.pack(">IIBBBBB", 2147483647, 2147483647, 8, 0, 0, 0, 0)
    (folder / "1.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IEND", b""))
    done, _ = study.measured(folder, study.base / "site.toml", "--fps", "10", limits="ulimit -v 1000000")
    return done.code == 3 and done.seconds < 2, f"exit {done.code} in {done.seconds:.1f} s within 1 GB of addresses"


def case_11(study):
    site = (study.base / "site.toml").read_text()
    (study.folder / "vast.toml").write_text(site.replace("grating_size_mm = [40.0, 40.0]", "grating_size_mm = [1e7, 1e7]"))
    vast, _ = study.measured(study.base / "frames", study.folder / "vast.toml", "--fps", "10", "--frames", "0:3")
    head, mid = site.split('name = "mid"', 1)
    opening = head[head.rindex("[["):]
    extra = "".join(f'\n{opening}name = "t{number}"{mid}' for number in range(699))
    (study.folder / "many.toml").write_text(site + extra)
    many, _ = study.measured(study.base / "frames", study.folder / "many.toml", "--fps", "10", "--frames", "0:3")
    good = vast.code in (2, 4) and "internal" not in vast.text and many.code in (0, 2, 4) and many.seconds < 20
    return good, f"1e7 mm: exit {vast.code} in {vast.seconds:.1f} s; 700 targets on one print: exit {many.code} in {many.seconds:.1f} s"


def case_12(study):
    fifo = study.folder / "f.mp4"
    os.mkfifo(fifo)
    codes = [study.run(*words, timeout=20).code for words in (["measure", fifo, "--pitch", "10mm"], ["inspect", fifo],
                                                              ["measure", study.base / "frames", "--site", fifo])]
    return codes == [2, 2, 2] or codes == [3, 3, 2], "at once, exits " + ", ".join(map(str, codes))


def case_13(study):
    codes = [study.run("measure", study.base / "frames", "--site", study.base / "site.toml", option, "").code
             for option in ("--camera", "--fps", "--figures", "--stabilised", "-o", "--site")]
    return codes == [2] * 6, "exits " + ", ".join(map(str, codes))


def case_14(study):
    scene = study.folder / "turns"
    study.simulate("small-1xyz", 16, scene, "--markers-only")
    wrong = study.folder / "wrong-camera.toml"
    wrong.write_text(re.sub(r"(?m)^k1 = .*", "k1 = 0.3", (scene / "truth-camera.toml").read_text()))
    _, tally = study.lies(scene / "frames", scene, "--fps", "10", "--camera", wrong)
    return tally.lies == 0 and tally.rows > 0, rows_of(tally)


def case_15(study):
    site = (study.base / "site.toml").read_text()
    head, tail = site.split('name = "mid"', 1)
    wrong = study.folder / "pitch.toml"
    wrong.write_text(head + 'name = "mid"' + tail.replace("pitch_mm = 10.0", "pitch_mm = 11.0", 1))
    done, out = study.measured(study.base / "frames", wrong, "--fps", "10")
    if done.code not in (0, 4, 5):
        return False, f"exit {done.code}: {done.line()}"
    tally = Tally()
    tally.add(out, study.base / "truth.csv")
    warned = [w for w in json.loads((out / "run.json").read_text())["warnings"] if "pitch" in w]
    return tally.lies == 0 and bool(warned), f"{rows_of(tally)}; " + (f"`{warned[0]}`" if warned else "no word")


def case_16(study):
    site = study.base / "site.toml"
    one, _ = study.measured(study.base / "frames", site, "--fps", "10", "--frames", "100:200")
    two, out = study.measured(study.base / "frames", site, "--fps", "10", "--reference-frame", "100")
    good = one.code == two.code == 2 and not (out / "overlay.png").exists() and "IHDR" not in one.text + two.text
    return good, f"exits {one.code}, {two.code}: `{one.line()}`"


def case_17(study):
    done = study.run("measure", b"zz\x1b[31mRED\nline", "--pitch", "10mm")
    site = study.folder / "formula.toml"
    site.write_text((study.base / "site.toml").read_text().replace('"mid"', '"=cmd|calc"'))
    _, out = study.measured(study.base / "frames", site, "--fps", "10")
    table = (out / "displacement.csv").read_text() if (out / "displacement.csv").exists() else ""
    good = "\x1b" not in done.text and len(done.text.strip().splitlines()) == 1 and ",=cmd" not in table
    return good, f"path: `{done.line()}`; a name that is a formula: {'guarded or refused' if ',=cmd' not in table else 'unguarded'}"


def case_18(study):
    scene = study.folder / "shake"
    shake = [word for setting in ("rotation.x.amplitude=0.002", "rotation.x.frequency_hz=5.7", "rotation.x.knots=[[0,0]]", "sensor.readout_s=0.02",
                                  "sensor.fps=10") for word in ("--set", setting)]
    study.simulate("small-still", 30, scene, "--markers-only", *shake)
    done, _ = study.measured(scene / "frames", scene / "site.toml", "--fps", "10")
    return done.seconds < 20, f"30 frames: {done.seconds:.1f} s, exit {done.code}"


def case_19(study):
    words = (study.base / "frames", study.base / "site.toml", "--fps", "10")
    small, _ = study.measured(*words, limits="ulimit -v 280000")
    few, _ = study.measured(*words, "--threads", "1", limits="ulimit -u 1")
    clip = study.folder / "files.mkv"
    subprocess.run(["ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", "10", "-i", study.base / "frames/%06d.png", "-c:v", "ffv1", clip],
                   check=True)
    files, _ = study.measured(clip, study.base / "site.toml", limits="ulimit -n 12")
    good = all(isinstance(done.code, int) and done.code >= 0 and "internal error" not in done.text for done in (small, few, files))
    return good, f"280 MB of addresses: exit {small.code} {short(small)}; one process: exit {few.code} {short(few)}; 12 files: exit {files.code} {short(files)}"


def short(done):
    return f"(`{done.line()}`)" if done.line() else ""


def case_20(study):
    return behind(study, ["median=radius=4", "smartblur=2:1:0", "histeq=strength=0.2"])


def case_21(study):
    lies, rows = 0, []
    for exposure in (0.05, 0.09):
        scene = study.fresh("vibration")
        settings = ("marker.mid.dy.amplitude=0.8", "marker.mid.dy.frequency_hz=27", "marker.mid.dy.knots=[[0,0]]", f"sensor.exposure_s={exposure}", "sensor.fps=10")
        study.simulate("small-still", 20, scene, "--markers-only", *[word for setting in settings for word in ("--set", setting)])
        _, tally = study.lies(scene / "frames", scene, "--fps", "10")
        lies += tally.lies
        rows.append(f"{27 * exposure:.2f} periods: {rows_of(tally)}")
    return lies == 0, "; ".join(rows)


def case_22(study):
    frames, site = study.base / "frames", study.base / "site.toml"
    _, run = study.measured(frames, site, "--fps", "10")
    tries = {
        "`--fps inf`": ["measure", frames, "--site", site, "--fps", "inf"],
        "`--fps 1e-308`": ["measure", frames, "--site", site, "--fps", "1e-308"],
        "`--threads -1`": ["measure", frames, "--site", site, "--fps", "10", "--threads", "-1"],
        "`--readout 10s`": ["measure", frames, "--site", site, "--fps", "10", "--readout", "10s"],
        "`--vibration 1e300mm@1e300Hz`": ["plan", "--vibration", "1e300mm@1e300Hz"],
        "`--span 1e9x1e9m`": ["sheet", "--span", "1e9x1e9m", "-o", study.fresh("sheet")],
        "`--pitch 1e-6mm`": ["sheet", "--pitch", "1e-6mm", "-o", study.fresh("sheet")],
        "`--targets 0`": ["sheet", "--targets", "0", "-o", study.fresh("sheet")],
        "`sensor.defocus_disc_px=1000`": ["simulate", "small-still", "--frames", "2", "--set", "sensor.defocus_disc_px=1000", "-o", study.fresh("sim")],
    }
    accepted = [name for name, words in tries.items() if study.run(*words, timeout=120).code != 2]
    table = study.folder / "twice.csv"
    study.run("export", run, "--markers", "mid,mid", "-o", table)
    is_single = table.read_text().splitlines()[0].count("mid_dx_mm") == 1
    odd = study.folder / os.fsdecode(b"na\xffme")
    shutil.copytree(frames, odd)
    _, out = study.measured(odd, site, "--fps", "10")
    report = (out / "report.html").read_bytes()
    try:
        report.decode()
        valid = True
    except UnicodeDecodeError:
        valid = False
    text = f"{len(tries) - len(accepted)} of {len(tries)} statements refused with exit 2" + (f" (not {', '.join(accepted)})" if accepted else "")
    text += f"; `--markers mid,mid` exports the target {'once' if is_single else 'twice'}"
    return not accepted and valid and is_single, f"{text}; report.html of a name that is no UTF-8 is {'valid' if valid else 'not valid'}"


DEFECTS = {
    1: (case_1, "a camera that averages over time", "40 ok, errors to 89 u", "`cli.camera_processing`"),
    2: (case_2, "video enlarged by repeated pixels", "ok, errors to 242 u", "`cli.camera_processing`"),
    3: (case_3, "mirrored footage of a symmetric layout", "wrong sign without a word", "`detection.LayoutSymmetry`"),
    4: (case_4, "missing images of a folder", "later frames renumbered", "`cli.edge_missing_pictures`"),
    5: (case_5, "`--rest` while the target moves", "39 of 39 wrong, 21 u", "`cli.rest_that_is_none`"),
    6: (case_6, "memory of long runs", "73 kB and 10 kB a frame", "`cli.scale`"),
    7: (case_7, "`export --replace` onto special files", "renames over them", "`cli.edge_export_targets`"),
    8: (case_8, "Matroska file that begins at 5 s", "cut, exit 5", "`cli.edge_video_that_begins_late`"),
    9: (case_9, "standard output that is full", "exits 0 and 1", "`cli.edge_lost_output`"),
    10: (case_10, "PNG header of 2147483647 x 2147483647 px", "2.1 GB, 8 s", "`cli.edge_huge_claims`"),
    11: (case_11, "site files without bounds", "internal error; over 300 s", "`cli.edge_huge_claims`"),
    12: (case_12, "FIFO as input or site", "waits for ever", "`cli.edge_special_files`"),
    13: (case_13, "empty option values", "exit 0, option ignored", "`cli.edge_empty_values`"),
    14: (case_14, "`--camera` of another lens", "5 of 15 off by up to 6.5 u", "`tests/physics/statements_test.cc`"),
    15: (case_15, "a target's pitch 10 % wrong", "no word", "`tests/physics/statements_test.cc`"),
    16: (case_16, "frames that are not there", "exit 4, empty overlay.png", "`cli.frames_that_are_not_there`"),
    17: (case_17, "control characters and formulas", "reach terminal and CSV", "`cli.edge_control_characters`"),
    18: (case_18, "a shaking camera with a rolling shutter", "67 s", "this table"),
    19: (case_19, "limits on memory, processes, files", "SIGSEGV; internal error; signal 9", "`cli.edge_no_threads`, `cli.edge_limits`"),
    20: (case_20, "local contrast, median and similar filters", "ok, errors to 15 u", "`tools/filter-study`"),
    21: (case_21, "several periods of vibration in one exposure", "7.5 u", "this table"),
    22: (case_22, "impossible numbers and names", "accepted", "`cli.edge_impossible_numbers`"),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--cases", default=",".join(map(str, DEFECTS)))
    options = parser.parse_args()
    wrong = 0
    print("| no. | input | at db8380a | now | right | guarded by |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        study = Study(options.program.resolve(), pathlib.Path(folder))
        for number in map(int, options.cases.split(",")):
            case, what, before, guard = DEFECTS[number]
            right, now = case(study)
            wrong += not right
            now = now.replace(folder + "/", "").replace("|", "\\|")
            print(f"| {number} | {what} | {before} | {now} | {'yes' if right else 'NO'} | {guard} |", flush=True)
    return 1 if wrong else 0


sys.exit(main())
