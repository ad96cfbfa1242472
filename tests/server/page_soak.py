#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps the live page of `moiregauge serve` open and states the memory of page and server, for tools/page-soak.

    page_soak.py MOIREGAUGE WORK [--minutes N]

A recording at 42 frames/s is replayed as a camera. Every ten seconds it reads the private memory of the server, the heap
and the number of nodes of the page after garbage collection, and the private memory of the page's process. The first
quarter is left to warm up, because the curves show the last minute and caches fill. Over the rest, memory is flat if the
line fitted to it rises by less than 5 % of the mean. The live command itself keeps its observations (docs/cli/live.md),
so its memory is stated and not judged. The exit code is 1 if something is not flat, or if the page fell behind.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "common"))
from memory import descendants, private_bytes  # noqa: E402
from visitor import Browser, Visitor, button, call, labelled, start_server, stop_server

FPS = 42
CLIP_FRAMES = 84  # in one loop
STEP_S = 10.0
MAX_RISE = 0.05  # relative to the mean, from the first quarter to the end
WARM_UP = 0.25  # share of the time
MIB = 2.0 ** 20


def make_clip(program, work, seconds):
    made = work / "made"
    call(program, "simulate", "small-still", "--frames", CLIP_FRAMES, "--quiet", "--codec", "x264", "--quality", 18, "--set", f"sensor.fps={FPS}",
                   "--set", "marker.mid.dy.amplitude=0.5", "--set", "marker.mid.dy.frequency_hz=1.0", "-o", made)
    clip = work / "folder" / "camera.mp4"
    clip.parent.mkdir()
    loops = int(seconds * FPS / CLIP_FRAMES) + 1
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-stream_loop", str(loops), "-i", str(made / "video.mp4"), "-c", "copy", str(clip)], check=True)
    return clip


def start_live(visitor, clip):
    visitor.click(button("Live"))
    visitor.wait(f"document.querySelector('option[value=\"{clip.name}\"]')")
    visitor.choose(labelled("Source"), clip.name)
    visitor.click(button("Start"))
    visitor.wait("Number(document.querySelector('.live').dataset.frames ?? 0) > 10", 60)


def reading(visitor, browser, server):
    visitor.page.send("HeapProfiler.collectGarbage")
    nodes = visitor.page.send("Memory.getDOMCounters")["nodes"]
    pages = [private_bytes(number) for number, words in descendants(browser.process.pid) if "--type=renderer" in words]
    live = [private_bytes(number) for number, words in descendants(server.pid) if " live " in words]
    return {"server": private_bytes(server.pid), "page heap": visitor.page.send("Runtime.getHeapUsage")["usedSize"], "page nodes": nodes,
            "page process": max(pages, default=float("nan")), "live command": max(live, default=float("nan"))}


def rise(times, values):
    """Returns the rise of the fitted line over `times`, as a share of the mean."""
    slope = numpy.polyfit(times, values, 1)[0]
    return slope * (times[-1] - times[0]) / numpy.mean(values)


def judged(times, readings):
    first = next(k for k, at in enumerate(times) if at >= WARM_UP * times[-1])
    print("| what | first | mean after the warm-up | highest | rise |\n|---|---|---|---|---|")
    is_flat = True
    for name in readings[0]:
        values = numpy.array([one[name] for one in readings])
        unit, text = (MIB, " MiB") if name != "page nodes" else (1.0, "")
        change = rise(times[first:], values[first:])
        is_flat = is_flat and (name == "live command" or change < MAX_RISE)
        print(f"| {name} | {values[0] / unit:.1f}{text} | {numpy.mean(values[first:]) / unit:.1f}{text} | {numpy.max(values) / unit:.1f}{text} | {100 * change:+.1f} % |")
    return is_flat


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=60.0)
    words = parser.parse_args()
    program, work = str(pathlib.Path(words.program).resolve()), words.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    seconds = 60.0 * words.minutes
    clip = make_clip(program, work, seconds + 60.0)
    server, address = start_server(program, clip.parent)
    times, readings = [], []
    try:
        with Browser(work) as browser:
            visitor = Visitor(browser.open(address, width=1600, height=950))
            visitor.page.send("Network.disable")  # the inspector would keep every answer
            start_live(visitor, clip)
            begin = time.monotonic()
            shown = int(visitor.value("document.querySelector('.live').dataset.frames"))
            while time.monotonic() - begin < seconds:
                time.sleep(STEP_S)
                readings.append(reading(visitor, browser, server))
                times.append(time.monotonic() - begin)
                if len(times) % 6 == 0:
                    print(f"{times[-1] / 60:4.0f} min", ", ".join(f"{name} {value / MIB:.1f} MiB" for name, value in readings[-1].items() if name != "page nodes"), file=sys.stderr, flush=True)
            rows = int(visitor.value("document.querySelector('.live').dataset.frames")) - shown
            visitor.click(button("Stop"))
    finally:
        stop_server(server)
        shutil.rmtree(work, ignore_errors=True)
    print(f"{times[-1] / 60:.0f} min, {rows} rows came ({rows / times[-1]:.1f} per second)\n")
    return 0 if judged(times, readings) and rows > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
