#!/usr/bin/python3
"""Times report.html: writing by the program, and display in a browser.

  bench/report_page.py BINARIES WORK [--put DOCUMENT]

Runs report_bench, opens its pages in headless Chromium (tests/report/browser.py), and prints JSON. --put also replaces
the section of these figures in docs/performance.md. Times are medians of three in ms, on this machine.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "report"))
from browser import Browser  # pylint: disable=wrong-import-position

RUNS = ((20000, 3), (1000000, 1))
REPEATS = 3
TITLE = "## The report"
# JavaScript: times zoom and pan of the plots in view, until they are drawn.
ZOOM = """(async () => {
  document.querySelector('#displacement .canvas').focus();
  const times = [];
  for (const key of ['+', '+', '+', '0', '+', 'ArrowRight', 'ArrowLeft', '0']) {
    const start = performance.now();
    document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    await new Promise((done) => setTimeout(done));
    times.push(performance.now() - start);
  }
  return times.sort((a, b) => a - b)[times.length >> 1];
})()"""


def measured(binaries, work, frames, targets):
    file = work / f"{frames}x{targets}.html"
    wrote = [json.loads(subprocess.run([binaries / "report_bench", str(frames), str(targets), file], check=True, text=True,
                                       capture_output=True).stdout) for _ in range(REPEATS)]
    shown = []
    for _ in range(REPEATS):
        with Browser(work) as browser:
            page = browser.open(file.as_uri())
            shown.append((float(page.value("document.documentElement.dataset.firstPlotMs")), page.value(ZOOM)))
    return {"frames": frames, "targets": targets, "bytes": wrote[0]["bytes"],
            "write_ms": 1e3 * statistics.median(w["seconds"] for w in wrote),
            "first_plot_ms": statistics.median(first for first, _ in shown), "zoom_ms": statistics.median(zoom for _, zoom in shown)}


def section(rows):
    lines = [TITLE, "", "`report.html` of made-up runs with gaps (`bench/report_bench.cc`), shown by Chromium without a graphics card. Written: words, spectra,",
             "peaks, packing, all in memory. First plot: from the beginning of navigation. Zoom: the middle one of eight steps, all plots in view redrawn.",
             "These are milliseconds of this machine.", "",
             "| frames | targets | written in | file | first plot after | zoom |", "|---|---|---|---|---|---|"]
    lines += [f"| {row['frames']} | {row['targets']} | {row['write_ms']:.0f} ms | {row['bytes'] / 1e6:.2f} MB | {row['first_plot_ms']:.0f} ms | "
              f"{row['zoom_ms']:.0f} ms |" for row in rows]
    return "\n".join(lines) + "\n"


def put(document, rows):
    text = document.read_text(encoding="utf-8")
    before, _, rest = text.partition(f"\n{TITLE}\n")
    if rest:
        _, mark, after = rest.partition("\n## ")
        after = mark[1:] + after
    else:
        before, mark, after = text.partition("\n## What would be next")
        after = mark[1:] + after
    document.write_text(f"{before}\n{section(rows)}\n{after}", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--put", type=pathlib.Path)
    words = parser.parse_args()
    rows = [measured(words.binaries, words.work, frames, targets) for frames, targets in RUNS]
    if words.put:
        put(words.put, rows)
    print(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
