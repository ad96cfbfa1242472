#!/usr/bin/python3
"""Times `moiregauge measure` on files, compared with decoding only and with reading the bytes.

  bench/files.py BIN WORK --frames N --memory-frames N --repeats N > files.json
  bench/files.py BIN WORK --frames N --repeats N --guard > guarded.json

BIN contains moiregauge and decode_only. WORK is an empty folder for the recordings (some GB). The three programs run in
turn, and the results are medians. Peak memory is that of the largest process. --guard: only one file, in H.264. Its
residuals exceed the noise of its key frame in most frames, so that all that a codec's errors can set off is in it.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

SCENARIO, SIZE = "rig-1xyz", (4096, 2168)
# The principal point is shifted by whole pixels, because the image is larger on all sides.
CAMERA = {"camera.width": 4096, "camera.height": 2168, "camera.cx": 2055.3, "camera.cy": 1072.3}
ENCODINGS = {
    "raw": ("avi", ["-c:v", "rawvideo", "-pix_fmt", "gray"]),
    "ffv1": ("mkv", ["-c:v", "ffv1", "-level", "3", "-slices", "4", "-pix_fmt", "gray"]),
    "h264": ("mkv", ["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"]),
}
GUARDED = ["-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p"]
RENDERED = 40  # frames; longer recordings repeat them


def run(*command):
    """Returns wall time in s, CPU time in s and peak memory in bytes of a program that must succeed."""
    words = list(map(str, command))
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        begin = time.monotonic()
        process = subprocess.Popen(words, stdout=output, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0), errors.seek(0)
        if process.returncode != 0:
            sys.exit(f"error: {' '.join(words)}: {errors.read().strip()}")
        return {"wall_s": wall, "cpu_s": usage.ru_utime + usage.ru_stime, "peak_bytes": 1024.0 * usage.ru_maxrss,
                "output": output.read().strip()}


def draw(binaries, folder, frames, *settings):
    run(binaries / "moiregauge", "simulate", SCENARIO, *settings, "--frames", frames, "-o", folder, "--quiet")


def encode(drawn, path, arguments, frames, rendered):
    """Writes a recording that repeats the rendered frames. They are encoded once."""
    once = path.with_name("once-" + path.name)
    run("ffmpeg", "-loglevel", "error", "-y", "-framerate", "10", "-i", drawn / "frames" / "%06d.png", *arguments, once)
    rounds = -(-frames // rendered)
    run("ffmpeg", "-loglevel", "error", "-y", "-stream_loop", rounds - 1, "-i", once, "-frames:v", frames, "-c", "copy",
        path)
    once.unlink()


def times_of(binaries, path, site, repeats):
    def measure():
        return run(binaries / "moiregauge", "measure", path, "--site", site, "--quiet", "-o", path.with_suffix(".out"))

    programs = {"measure": measure, "decode": lambda: run(binaries / "decode_only", path),
                "bytes": lambda: run(binaries / "decode_only", "--bytes", path)}
    results = {name: [] for name in programs}
    for _ in range(repeats):
        for name, program in programs.items():
            results[name].append(program())
    return {name: {key: statistics.median(r[key] for r in rows) for key in ("wall_s", "cpu_s", "peak_bytes")}
            for name, rows in results.items()} | {"frames": int(results["decode"][0]["output"])}


def guarded(binaries, work, frames, repeats):
    """Returns the times of the file of --guard."""
    drawn, path = work / "drawn", work / "guarded.mkv"
    draw(binaries, drawn, min(RENDERED, frames), "--markers-only")
    encode(drawn, path, GUARDED, frames, min(RENDERED, frames))
    return times_of(binaries, path, drawn / "site.toml", repeats)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--frames", type=int, required=True)
    parser.add_argument("--memory-frames", type=int)
    parser.add_argument("--repeats", type=int, required=True)
    parser.add_argument("--guard", action="store_true")
    words = parser.parse_args()
    if words.guard:
        json.dump({"h264": guarded(words.binaries, words.work, words.frames, words.repeats)}, sys.stdout, indent=1)
        return
    if words.memory_frames is None:
        parser.error("--memory-frames is missing")
    rendered = min(RENDERED, words.frames)
    drawn = words.work / "drawn"
    settings = [word for key, value in CAMERA.items() for word in ("--set", f"{key}={value}")]
    draw(words.binaries, drawn, rendered, *settings)
    files = {}
    for name, (ending, arguments) in ENCODINGS.items():
        path = words.work / f"{name}.{ending}"
        encode(drawn, path, arguments, words.frames, rendered)
        files[name] = times_of(words.binaries, path, drawn / "site.toml", words.repeats)
        path.unlink()
    path = words.work / "memory.mkv"
    encode(drawn, path, ENCODINGS["h264"][1], words.memory_frames, rendered)
    memory = times_of(words.binaries, path, drawn / "site.toml", 1)
    path.unlink()
    json.dump({"size": SIZE, "files": files, "memory": memory}, sys.stdout, indent=1)


if __name__ == "__main__":
    main()
