#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Times the page of `moiregauge serve` in headless Chromium, for tools/page-bench.

    page_bench.py MOIREGAUGE WORK [--rows N] [--repeats N]

The record is made up: two sines, noise, gaps and rows that are not ok, in the run directory of a short measured clip.
First plot: from the click on the run until the browser has drawn a frame with its curves. It includes reading the CSV
file, the transfer and unpacking. A step (zoom in, pan, zoom out, show all) lasts from its key until the browser has drawn
the next frame, with all plots and the strip in view. Limits: 1.5 s and 60 ms.

First frame: from the click on an H.264 clip until it is shown, and its markers are, with a new server and browser. Limits:
1 s for HD, 2 s for 4K. Measuring: time of a job that the page shows, relative to the same command in a terminal, in
turns. Limit: 1.05.

Prints tables of the middle and the longest of all repeats. The exit code is 1 if a middle one exceeds its limit.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

import numpy

from visitor import HTML, Browser, Visitor, button, call, entry, insist, make_footage, start_server, stop_server

FPS = 100.0
MAX_FIRST_MS = 1500.0
MAX_STEP_MS = 60.0
SIZES = {"HD": ((1920, 1080), 1000.0), "4K": ((3840, 2160), 2000.0)}  # px, limit in ms
MAX_SLOWER = 1.05
# Keys of a plot. "zoom in" goes to a sixteenth in four steps, "zoom out" back in the same steps, "all" back at once.
STEPS = [("zoom in", "+")] * 4 + [("pan", "ArrowRight"), ("pan", "ArrowLeft")] * 2 + [("zoom out", "-")] * 4 + [("zoom in", "+")] * 4 + [("show all", "0")]
DRAWN = "new Promise((done) => requestAnimationFrame(() => { const c = new MessageChannel(); c.port1.onmessage = done; c.port2.postMessage(0); }))"
TIME_STEPS = """(async () => {
  const canvas = document.querySelector('.results .canvas');
  canvas.scrollIntoView({block: 'start', behavior: 'instant'});
  await new Promise((done) => setTimeout(done, 300));
  canvas.focus({preventScroll: true});
  const times = [];
  for (const [name, key] of %s) {
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 30)));
    const start = performance.now();
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    await %s;
    times.push([name, performance.now() - start]);
  }
  return times;
})()""" % (json.dumps(STEPS), DRAWN)
TIME_FIRST = """(async () => {
  const start = performance.now();
  %s.click();
  while (!document.querySelector('.results .u-over')) await new Promise((done) => setTimeout(done, 2));
  await %s;
  return performance.now() - start;
})()"""


TIME_OUTLINED = """(async () => {
  const start = performance.now();
  %s.click();
  while (!document.querySelector('.stage img')?.naturalWidth) await new Promise((done) => setTimeout(done, 2));
  await %s;
  const shown = performance.now() - start;
  while (document.querySelectorAll('.marker').length < 5) await new Promise((done) => setTimeout(done, 2));
  await %s;
  return [shown, performance.now() - start];
})()"""
JOB_SECONDS = """fetch('/api/jobs', {headers: {'X-Moiregauge-Token': document.querySelector('meta[name=moiregauge-token]').content}})
  .then((answer) => answer.json()).then((known) => known.jobs.map((job) => [job.command, job.seconds]))"""


def write_record(run, rows):
    """Replaces the samples of a measured run by `rows` made-up ones."""
    rng = numpy.random.default_rng(26)
    time_s = numpy.arange(rows) / FPS
    dx = 0.2 * numpy.sin(2 * numpy.pi * 0.7 * time_s) + 0.01 * rng.standard_normal(rows)
    dy = numpy.sin(2 * numpy.pi * 0.01 * time_s) + 0.3 * numpy.sin(2 * numpy.pi * 3.1 * time_s) + 0.01 * rng.standard_normal(rows)
    header, row = (run / "displacement.csv").read_text(encoding="utf-8").splitlines()[:2]
    marker = row.split(",")[2]
    kind = rng.random(rows)
    lines = [header]
    for k in range(rows):
        if kind[k] < 0.001:
            lines.append(f"{k},{time_s[k]:.6f},{marker},,,,,occluded")
        else:
            status = "ok" if kind[k] > 0.002 else "suspect"
            lines.append(f"{k},{time_s[k]:.6f},{marker},{dx[k]:.6f},{dy[k]:.6f},0.003000,0.003100,{status}")
    (run / "displacement.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def measured(browser, address):
    page = browser.open(address, width=1600, height=950)
    page.wait(f"Boolean({entry('bridge.mp4')})", 30)
    first_ms = page.value(TIME_FIRST % (entry("bridge.mp4"), DRAWN))
    return first_ms, page.value(TIME_STEPS)


def first_frames(program, work, clip, repeats):
    """Prints the times until the picture of a clip is shown, and its markers. Returns true if they are within their limits."""
    print("| first frame | middle | longest | limit of the middle |\n|---|---|---|---|")
    fits = True
    for name, ((width, height), limit) in SIZES.items():
        folder = work / name
        folder.mkdir()
        scale = f"scale={width}:{width // 2},pad={width}:{height}:0:{(height - width // 2) // 2}:color=gray"
        subprocess.run(["ffmpeg", "-loglevel", "error", "-i", str(clip), "-vf", scale, "-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p",
                        str(folder / "bridge.mp4")], check=True)
        times = []
        for _ in range(repeats):
            server, address = start_server(program, folder)
            try:
                with Browser(work) as browser:
                    page = browser.open(address, width=1600, height=950)
                    page.wait(f"Boolean({entry('bridge.mp4')})", 30)
                    times.append(page.value(TIME_OUTLINED % (entry("bridge.mp4"), DRAWN, DRAWN)))
            finally:
                stop_server(server)
        for what, some in zip(("picture", "markers outlined"), zip(*times)):
            fits &= statistics.median(some) <= limit
            print(f"| {name}, {width} x {height} px, H.264: {what} | {statistics.median(some):.0f} ms | {max(some):.0f} ms | {limit:.0f} ms |")
    return fits


def slowdown(program, work, clip, repeats):
    """Prints how much longer a measurement takes that the page shows. Returns true if that is within its limit."""
    folder = work / "slow"
    folder.mkdir()
    shutil.copy(clip, folder / "command.mp4")
    for n in range(repeats):
        shutil.copy(clip, folder / f"page{n}.mp4")
    ratios = []
    server, address = start_server(program, folder)
    try:
        for n in range(repeats):
            with Browser(work) as browser:
                visitor = Visitor(browser.open(address, width=1600, height=950))
                visitor.click(entry(f"page{n}.mp4"))
                visitor.click(button("Yes, right"))
                visitor.click(button("Measure"))
                visitor.wait(f"{HTML}.dataset.results", 300)
                (seconds,) = [job_s for command, job_s in visitor.value(JOB_SECONDS) if f"page{n}.mp4" in command]
            begin = time.monotonic()
            call(program, "measure", "command.mp4", "--pitch", "10mm", "--quiet", "--restart", "-o", f"command{n}", cwd=folder)
            ratios.append((seconds, time.monotonic() - begin))
    finally:
        stop_server(server)
    insist(len(ratios) == repeats, "all jobs were timed")
    ratio = statistics.median(page / command for page, command in ratios)
    print(f"""| measuring a clip of {statistics.median(command for _, command in ratios):.1f} s while the page shows it | middle | limit |
|---|---|---|
| time relative to the command | {ratio:.3f} | {MAX_SLOWER} |""")
    return ratio <= MAX_SLOWER


def table(rows, first, steps):
    names = list(dict.fromkeys(name for name, _ in STEPS))
    lines = [("first plot", first, MAX_FIRST_MS)] + [(name, [ms for step, ms in steps if step == name], MAX_STEP_MS) for name in names]
    print(f"| {rows} rows | middle | longest | limit of the middle |\n|---|---|---|---|")
    for name, values, limit in lines:
        print(f"| {name} | {statistics.median(values):.0f} ms | {max(values):.0f} ms | {limit:.0f} ms |")
    return all(statistics.median(values) <= limit for _, values, limit in lines)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    words = parser.parse_args()
    program, work = str(pathlib.Path(words.program).resolve()), words.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    clip, long_clip, _ = make_footage(program, work)
    fits = first_frames(program, work, clip, words.repeats)
    print()
    fits &= slowdown(program, work, long_clip, words.repeats)
    print()
    folder = work / "folder"
    folder.mkdir()
    shutil.move(clip, folder / clip.name)
    call(program, "measure", clip.name, "--pitch", "10mm", "--quiet", cwd=folder)
    write_record(folder / f"{clip.stem}-moiregauge", words.rows)
    server, address = start_server(program, folder)
    first, steps = [], []
    try:
        for _ in range(words.repeats):
            with Browser(work) as browser:
                first_ms, some = measured(browser, address)
                first.append(first_ms)
                steps += some
    finally:
        stop_server(server)
    return 0 if table(words.rows, first, steps) and fits else 1


if __name__ == "__main__":
    sys.exit(main())
