#!/usr/bin/python3
"""Checks `moiregauge batch` with whole, damaged and hostile clips.

    clips.py MOIREGAUGE WORK SOURCE

Each clip has its own exit code, and the displacements of whole clips are those of `measure`, byte for byte. Finished
clips are skipped, killed and stopped ones continue, limits end one clip only. A second batch in the same folder is
refused. Names cannot leave the folder or become markup.
"""
import csv
import json
import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from runs import insist, run, simulate, start  # noqa: E402

FRAMES = 8


def batch(program, *words, expected=0):
    return run([program, "batch", *words], expected)


def table(out):
    with open(out / "batch.csv", newline="") as file:
        return {row["run"]: row for row in csv.DictReader(file)}


def exits(out):
    return {name: int(row["exit_code"]) for name, row in table(out).items()}


def changed(out):
    """Returns when each clip's state was written."""
    return {path.stem: path.stat().st_mtime_ns for path in (out / ".batch/state").iterdir()}


def make_clip(program, work, repeats=1):
    """Makes a clip that shows the same frames `repeats` times. Returns it and its site file."""
    simulate(program, work / "scene", "small-1xyz", FRAMES)
    video = work / "whole.mkv"
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", "10", "-stream_loop", str(repeats - 1), "-i", work / "scene/frames/%06d.png",
         "-c:v", "ffv1", video])
    return video, work / "scene/site.toml"


def make_hostile(video, site, where):
    """Writes twenty damaged or hostile clips. Returns the exit codes that each may have."""
    whole = video.read_bytes()
    where.mkdir(parents=True)
    shutil.copy(site, where / "site.toml")
    files = {
        "empty.mp4": (b"", {3}), "text.mp4": (b"no video\n" * 50, {3}), "zeros.mkv": (bytes(5000), {3}),
        "playlist.mp4": (b"#EXTM3U\n#EXTINF:10,\nfile:///etc/passwd\n", {3}),
        "concat.mp4": (b"ffconcat version 1.0\nfile /etc/passwd\n", {3}),
        "header.mkv": (whole[:300], {3}), "half.mkv": (whole[: len(whole) // 2], {3, 4, 5}),
        "tail.mkv": (whole[len(whole) // 2:], {3}), "noise.avi": (bytes(i * 97 % 251 for i in range(20000)), {3}),
        "png.mp4": (b"\x89PNG\r\n\x1a\n" + bytes(100), {3}),
        "huge.tif": (b"II*\0\x08\0\0\0\xff\xff" + b"\xff" * 200, {3}),
        "riff.avi": (b"RIFF\xff\xff\xff\xffAVI LIST" + b"\xff" * 400, {3}),
        "moov.mov": (b"\x7f\xff\xff\xffmoov" + bytes(100), {3}),
        "$(touch pwned).mkv": (whole[:2000], {3}), "`id`;'\".mkv": (whole[:2000], {3}),
        "new\nline.mkv": (whole[:2000], {3}), "<script>alert(1)<'.mkv": (whole[:2000], {3}),
        "\udcff\udcfe.mkv": (whole[:2000], {3}),
    }
    expected = {}
    for name, (content, codes) in files.items():
        path = where / name
        path.write_bytes(content)
        expected[os.fsencode(path)] = codes
    os.mkfifo(where / "fifo.mp4")
    expected[os.fsencode(where / "fifo.mp4")] = {3}
    middle = bytearray(whole)
    middle[len(whole) // 3: len(whole) // 3 + 4000] = bytes(4000)
    (where / "middle.mkv").write_bytes(middle)
    expected[os.fsencode(where / "middle.mkv")] = {3, 4, 5}
    return expected


def check_hostile(program, work, video, site):
    clips, out = work / "clips", work / "out"
    expected = make_hostile(video, site, clips / "bad")
    insist(len(expected) == 20, "twenty clips are damaged or hostile")
    for folder in ("one", "two"):
        (clips / folder).mkdir()
        os.link(video, clips / folder / "a.mkv")
        shutil.copy(site, clips / folder / "site.toml")
    os.link(video, clips / "one/...mkv")  # hidden, so it is named
    done = batch(program, clips, clips / "one/...mkv", "-o", out, "--time-limit", "60s", expected=5)
    insist("3 measured" in done.stdout, f"the final lines count the clips: {done.stdout}")
    names = [json.loads(line) for line in (out / ".batch/clips.jsonl").read_text().splitlines()[1:]]
    codes = exits(out)
    insist(len(names) == len(codes) == 23, f"each clip has one row: {len(names)}, {len(codes)}")
    for clip in names:
        path = bytes.fromhex(clip["input_hex"]) if "input_hex" in clip else os.fsencode(clip["input"])
        insist(codes[clip["name"]] in expected.get(path, {0}), f"exit {codes[clip['name']]} of {path}")
    for name in ("half", "middle", "text"):
        run([program, "measure", clips / "bad" / f"{name}.{'mp4' if name == 'text' else 'mkv'}", "--site", site, "-o", work / name, "--quiet"], codes[name])
    run([program, "measure", video, "--site", site, "-o", work / "plain", "--quiet"])
    plain = (work / "plain/displacement.csv").read_bytes()
    for name in ("a-one", "a-two", "__-one"):  # another clip is __, too
        insist((out / name / "displacement.csv").read_bytes() == plain, f"{name} has the displacements of measure")
    inside = {path.name for path in out.iterdir()} - {"batch.csv", "catalogue.sqlite", "index.html", ".batch"}
    insist(inside <= {clip["name"] for clip in names}, f"only run directories are in OUT: {inside}")
    insist(not list(work.glob("**/pwned")), "no shell reads a name")
    page = (out / "index.html").read_text()
    insist("<script>alert" not in page and page.count("</script>") == 2, "no name is markup")
    return out, clips


def check_skipped(program, out, clips):
    before = changed(out)
    batch(program, clips, clips / "one/...mkv", "-o", out, "--time-limit", "60s", expected=5)
    insist(changed(out) == before, "finished and failed clips are skipped")
    batch(program, clips / "bad/half.mkv", clips / "one", "-o", out, "--retry", expected=5)
    differing = {name for name, time_ns in changed(out).items() if time_ns != before[name]}
    insist(differing == {"half"} or (differing == set() and exits(out)["half"] == 5), f"--retry repeats failed clips only: {differing}")
    batch(program, clips / "two", "-o", out, "--frames", "0:5", expected=5)
    insist(table(out)["a-two"]["frames"] == "5", "another option measures again")


def check_catalogue(program, out):
    done = batch(program, "-o", out, "--query", "SELECT outcome, count(*) AS n FROM runs GROUP BY outcome ORDER BY n DESC LIMIT 1")
    insist(done.stdout.startswith("outcome,n\nfailed,"), done.stdout)
    rows = table(out)
    with sqlite3.connect(out / "catalogue.sqlite") as database:
        for name, ok, peak_to_peak, u in database.execute("SELECT run, ok, peak_to_peak_dy_mm, u_dy_mm FROM targets"):
            insist(int(rows[name]["ok"]) == ok, "number of ok rows")
            insist(abs(float(rows[name]["peak_to_peak_dy_mm"]) - peak_to_peak) <= 5.1e-7, "six decimals")
            insist(abs(float(rows[name]["U_dy_mm"]) - 2 * u) <= 5.1e-7, "U = 2 u")
        insist(database.execute("SELECT count(*) FROM runs").fetchone() == (23,), "each clip is a run")


def long_clips(work, site, count, frames):
    """Links images forwards and backwards into long clips, so that there is time to stop them."""
    for n in range(count):
        clip = work / f"long/clip{n}"
        clip.mkdir(parents=True)
        shutil.copy(site, clip / "site.toml")
        for i in range(frames):
            at = i % (2 * FRAMES - 2)
            os.link(work / f"scene/frames/{min(at, 2 * FRAMES - 2 - at):06d}.png", clip / f"{i:06d}.png")
    return work / "long"


def started(program, clips, out):
    process = subprocess.Popen([program, "batch", clips, "-o", out, "--fps", "10", "--jobs", "2"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    for _ in range(2000):
        if any((out / f"clip{n}.unfinished/run.mgj").exists() for n in range(2)):
            break
        time.sleep(0.02)
    time.sleep(0.3)
    return process


def children(process):
    done = subprocess.run(["pgrep", "-P", str(process)], capture_output=True, text=True, check=False)
    return [int(word) for word in done.stdout.split()]


def check_interrupt(program, work, site):
    clips, out = long_clips(work, site, 2, 120), work / "stopped"
    batch(program, clips, "-o", work / "reference", "--fps", "10")
    process = started(program, clips, out)
    refused = batch(program, clips, "-o", out, "--fps", "10", expected=2)
    insist("another batch is working" in refused.stderr, refused.stderr)
    running = children(process.pid)
    insist(running, "clips are in progress")
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60)
    insist(process.returncode == 130 and "same command" in stderr, f"exit {process.returncode}: {stderr}")
    insist(not any(pathlib.Path(f"/proc/{pid}").exists() for pid in running), "Ctrl-C stops all clips")
    process = started(program, clips, out)
    running = children(process.pid)
    process.kill()
    process.communicate()
    deadline = time.time() + 10
    while any(pathlib.Path(f"/proc/{pid}/exe").exists() for pid in running) and time.time() < deadline:
        time.sleep(0.02)
    insist(not any(pathlib.Path(f"/proc/{pid}/exe").exists() for pid in running), "clips die with the batch")
    batch(program, clips, "-o", out, "--fps", "10")
    for n in range(2):
        insist((out / f"clip{n}/displacement.csv").read_bytes() == (work / f"reference/clip{n}/displacement.csv").read_bytes(),
               f"clip{n} after a stop and a kill is as without")
    return clips


def check_measured_elsewhere(program, work, clips):
    """A batch waits for a clip that a `measure` started by hand is measuring, and then continues it."""
    out = work / "shared"
    batch(program, clips / "clip1", "-o", out, "--fps", "10")
    by_hand = subprocess.Popen([program, "measure", clips / "clip0", "--site", clips / "clip0/site.toml", "--fps", "10", "-o", out / "clip0", "--quiet"],
                               stderr=subprocess.DEVNULL)
    while not (out / "clip0.unfinished/run.mgj").exists():
        insist(by_hand.poll() is None, "measure has begun")
        time.sleep(0.02)
    by_hand.send_signal(signal.SIGSTOP)
    process = subprocess.Popen([program, "batch", clips, "-o", out, "--fps", "10"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(1.0)
    insist(process.poll() is None and not (out / ".batch/state/clip0.json").exists(), "the batch waits for clip0")
    by_hand.send_signal(signal.SIGINT)
    by_hand.send_signal(signal.SIGCONT)
    stdout, stderr = process.communicate(timeout=120)
    insist(by_hand.wait(timeout=60) == 130, "the other process is not disturbed")
    insist(process.returncode == 0 and "(1 finished before)" in stdout and "2 measured" in stdout, f"both clips are measured: {stdout}{stderr}")
    insist((out / "clip0/displacement.csv").read_bytes() == (work / "reference/clip0/displacement.csv").read_bytes(), "clip0 is as without")


def check_limits(program, work, clips):
    out = work / "limited"
    batch(program, clips / "clip0", "-o", out, "--fps", "10", "--time-limit", "0.3s", expected=4)
    row = table(out)["clip0"]
    insist(row["exit_code"] == "130" and "raise --time-limit" in row["message"], f"time limit: {row}")
    batch(program, clips / "clip0", "-o", out, "--fps", "10")
    insist(table(out)["clip0"]["exit_code"] == "0", "a higher limit continues")
    if "LSAN_OPTIONS" in os.environ and b"__asan_init" in pathlib.Path(program).read_bytes():
        return  # the shadow memory of the sanitizer counts, too
    out = work / "starved"
    batch(program, clips / "clip0", "-o", out, "--fps", "10", "--memory-limit", "8MB", expected=4)
    row = table(out)["clip0"]
    insist(row["exit_code"] not in ("0", "5"), f"memory limit: {row}")
    batch(program, clips / "clip0", "-o", out, "--fps", "10", "--memory-limit", "4GB")


def main():
    program, work, _ = start()
    program = str(pathlib.Path(program).resolve())
    video, site = make_clip(program, work)
    out, clips = check_hostile(program, work, video, site)
    check_skipped(program, out, clips)
    check_catalogue(program, out)
    clips = check_interrupt(program, work, site)
    check_measured_elsewhere(program, work, clips)
    check_limits(program, work, clips)


if __name__ == "__main__":
    main()
