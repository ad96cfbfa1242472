#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Times the plots of `moiregauge serve` with 10^6 samples in headless Chromium, for tools/page-bench.

    page_bench.py MOIREGAUGE WORK [--rows N] [--repeats N]

The record is made up: two sines, noise, gaps and rows that are not ok, in the run directory of a short measured clip.
First plot: from the click on the run until the browser has drawn a frame with its curves. It includes reading the CSV
file, the transfer and unpacking. A step (zoom in, pan, zoom out, show all) lasts from its key until the browser has drawn
the next frame, with all plots and the strip in view. Prints a table of the middle and the longest of all repeats.
The exit code is 1 if a middle one exceeds its limit. Limits: 1.5 s and 60 ms.
"""
import argparse
import json
import pathlib
import shutil
import statistics
import sys

import numpy

from visitor import Browser, call, entry, make_footage, start_server, stop_server

FPS = 100.0
MAX_FIRST_MS = 1500.0
MAX_STEP_MS = 60.0
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
    clip, _, _ = make_footage(program, work)
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
    return 0 if table(words.rows, first, steps) else 1


if __name__ == "__main__":
    sys.exit(main())
