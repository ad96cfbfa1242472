#!/usr/bin/python3
"""Times `moiregauge measure` on files, compared with decoding only and with reading the bytes.

  bench/files.py BIN WORK --frames N --memory-frames N --repeats N > files.json

BIN contains moiregauge and decode_only. WORK is an empty folder for the recordings (some GB). The three programs run in
turn, and the results are medians. Peak memory is that of the largest process (/usr/bin/time).
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

SCENARIO, SIZE = "rig-1xyz", (4096, 2168)
# The principal point is shifted by whole pixels, because the image is larger on all sides.
CAMERA = {"camera.width": 4096, "camera.height": 2168, "camera.cx": 2055.3, "camera.cy": 1072.3}
ENCODINGS = {
    "raw": ("avi", ["-c:v", "rawvideo", "-pix_fmt", "gray"]),
    "ffv1": ("mkv", ["-c:v", "ffv1", "-level", "3", "-slices", "4", "-pix_fmt", "gray"]),
    "h264": ("mkv", ["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"]),
}
RENDERED = 40  # frames; longer recordings repeat them


def run(*command):
    """Returns wall time in s, CPU time in s and peak memory in bytes of a program that must succeed."""
    words = ["/usr/bin/time", "-f", "%e %U %S %M", *map(str, command)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"error: {' '.join(words)}: {done.stderr.strip()}")
    wall, user, system, peak_kib = map(float, done.stderr.split()[-4:])
    return {"wall_s": wall, "cpu_s": user + system, "peak_bytes": 1024 * peak_kib, "output": done.stdout.strip()}


def draw(binaries, folder, frames):
    settings = [word for key, value in CAMERA.items() for word in ("--set", f"{key}={value}")]
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


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--frames", type=int, required=True)
    parser.add_argument("--memory-frames", type=int, required=True)
    parser.add_argument("--repeats", type=int, required=True)
    words = parser.parse_args()
    rendered = min(RENDERED, words.frames)
    drawn = words.work / "drawn"
    draw(words.binaries, drawn, rendered)
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
