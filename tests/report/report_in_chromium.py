#!/usr/bin/python3
"""Checks report.html in a browser.

    report_in_chromium.py MOIREGAUGE WORK SOURCE

The page requests no other file and reports no errors. Plots are drawn, and zoom and pan apply to all of them. Keys have
the functions of the mouse. Text has enough contrast in light and dark themes. The page can be printed. The numbers are
those of displacement.csv. A refused run and a run without time are reported as such.
"""
import base64
import csv
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import zlib

from browser import Browser


LAST_DIGIT_MM = 0.51e-6  # half of the last digit of displacement.csv


def insist(truth, what):
    if not truth:
        raise SystemExit(f"wrong: {what}")


def call(program, *arguments, exit_code=0):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, errors="replace", check=False)
    insist(done.returncode == exit_code, f"{arguments}: exit {done.returncode}\n{done.stderr}")


def script(page, name):
    return re.search(rf'<script type="[^"]+" id="{name}">(.*?)</script>', page, re.DOTALL).group(1)


def columns(page):
    """Reads the columns as specified in packed_columns.h. Shares no code with the page's own reader."""
    report = json.loads(script(page, "report"))
    data = zlib.decompress(base64.b64decode(script(page, "samples")))
    at = 0
    lists = []
    for column in report["columns"]:
        last, values = 0, []
        for _ in range(column["count"]):
            digits = shift = 0
            while True:
                byte = data[at]
                at += 1
                digits |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    break
            if digits == 0:
                values.append(math.nan)
                continue
            digits -= 1
            last += -(digits + 1) // 2 if digits & 1 else digits // 2
            values.append(last * column["quantum"])
        lists.append(values)
    insist(at == len(data), "nothing is left over behind the columns")
    return report, lists


def check_numbers(run):
    report, lists = columns((run / "report.html").read_text(encoding="utf-8"))
    with (run / "displacement.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for target in report["targets"]:
        mine = [row for row in rows if row["marker"] == target["name"]]
        for key, name in [("dx", "dx_mm"), ("dy", "dy_mm"), ("ux", "u_dx_mm"), ("uy", "u_dy_mm")]:
            column = target["rows"][key]
            half = 0.5 * report["columns"][column]["quantum"] + 1e-12
            insist(len(lists[column]) == len(mine), f"{key} has a value for each row")
            for value, row in zip(lists[column], mine):
                wanted = float(row[name])
                insist(abs(value - wanted) <= half or (math.isnan(value) and math.isnan(wanted)), f"{name}: {value}, {wanted}")
        for axis, name in [("dx", "dx_mm"), ("dy", "dy_mm")]:
            ok = [float(row[name]) for row in mine if row["status"] == "ok"]
            for key, wanted in [("lowest", min(ok)), ("highest", max(ok))]:
                insist(abs(target[key][axis] - wanted) <= LAST_DIGIT_MM, f"{key} {axis}: {target[key][axis]}, {wanted}")
        words = [report["statuses"][int(code)]["word"] for code in lists[target["rows"]["status"]]]
        insist(words == [row["status"] for row in mine], "statuses")


# JavaScript: number of pixels of a canvas that differ from its most frequent colour.
INK = """(canvas) => {
  const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  const counts = new Map();
  pixels.forEach((p) => counts.set(p, (counts.get(p) ?? 0) + 1));
  return pixels.length - Math.max(...counts.values());
}"""
# JavaScript: scrolls all canvases into view one by one, because plots are drawn when visible, and applies ACT to them.
EACH = """(async () => {
  const found = [];
  for (const figure of document.querySelectorAll('figure.plot, figure.strip')) {
    figure.scrollIntoView();
    for (let n = 0; n < 100 && !figure.querySelector('canvas'); ++n) await new Promise((done) => setTimeout(done, 20));
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done, 30)));
    found.push(ACT(figure.querySelector('canvas')));
  }
  return found;
})()"""
SHOWN = "document.querySelector('.shown').textContent"
PICTURES = "[...document.querySelectorAll('#displacement canvas, #camera canvas')].map((c) => c.toDataURL())"


def look_at_plots(page, least):
    ink = page.value(EACH.replace("ACT", f"({INK})"))
    insist(len(ink) >= least, f"{len(ink)} plots and strips, not {least}")
    insist(min(ink) > 500, f"a plot is blank: {ink}")


def middle_of_first_plot(page):
    page.value("document.querySelector('#displacement .plot').scrollIntoView({block: 'center'})")
    return page.value("(() => { const r = document.querySelector('#displacement .u-over').getBoundingClientRect();"
                      " return [r.left, r.width, r.top + r.height / 2]; })()")


def check_zoom(page):
    left, width, y = middle_of_first_plot(page)
    insist(page.value(SHOWN) == "the whole record is shown", "all is shown at first")
    whole = page.value(PICTURES)
    page.drag(left + 0.25 * width, left + 0.5 * width, y)
    page.wait(f"{SHOWN} !== 'the whole record is shown'", 5)
    zoomed = page.value(SHOWN)
    first, last = (float(number) for number in re.findall(r"[\d.]+", zoomed)[:2])
    insist(abs(first - 0.25 * 4.7) < 0.1 and abs(last - 0.5 * 4.7) < 0.1, f"what was dragged over is shown: {zoomed}")
    page.value("document.querySelector('#camera').scrollIntoView()")
    page.value("new Promise((done) => setTimeout(done, 200))")
    insist(all(a != b for a, b in zip(whole, page.value(PICTURES))), "all plots over time follow")
    middle_of_first_plot(page)
    page.drag(left + 0.5 * width, left + 0.7 * width, y, modifiers=8)
    insist(page.value(SHOWN) not in (zoomed, "the whole record is shown"), "Shift and drag moves")
    page.double_click(left + 0.5 * width, y)
    page.wait(f"{SHOWN} === 'the whole record is shown'", 5)
    page.mouse("mouseWheel", left + 0.5 * width, y, deltaX=0, deltaY=-120)
    page.wait(f"{SHOWN} !== 'the whole record is shown'", 5)
    page.value("document.querySelector('#displacement .canvas').focus()")
    page.key("0")
    page.wait(f"{SHOWN} === 'the whole record is shown'", 5)
    page.key("+")
    page.wait(f"{SHOWN} !== 'the whole record is shown'", 5)
    page.value("[...document.querySelectorAll('.toolbar button')].find((b) => b.textContent === 'All').click()")
    page.wait(f"{SHOWN} === 'the whole record is shown'", 5)
    page.mouse("mouseMoved", left + 0.4 * width, y)
    page.wait("/mm, ok/.test(document.querySelector('#displacement .readout').textContent)", 5)


def luminance(colour):
    def linear(part):
        part = int(part) / 255
        return part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4
    red, green, blue = (linear(part) for part in re.findall(r"\d+", colour)[:3])
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def check_contrast(page, theme):
    """Checks the contrast: at least 4.5 for text and 3 for lines (WCAG 2.1)."""
    pairs = page.value("""(() => {
      const of = (selector, key) => getComputedStyle(document.querySelector(selector))[key];
      const probe = document.body.appendChild(document.createElement('i'));
      const variable = (name) => (probe.style.color = `var(${name})`, getComputedStyle(probe).color);
      const card = of('section', 'backgroundColor');
      const texts = ['--ink', '--ink-soft', '--good', '--fair', '--bad'].map((name) => [name, variable(name), card, 4.5]);
      const lines = Array.from({length: 12}, (_, n) => n + 1).map((n) => [`--series-${n}`, variable(`--series-${n}`), card, 3]);
      probe.remove();
      return [...texts, ...lines];
    })()""")
    for name, ink, paper, least in pairs:
        light, dark = sorted([luminance(ink), luminance(paper)], reverse=True)
        insist((light + 0.05) / (dark + 0.05) >= least, f"{theme}: {name} {ink} on {paper} has too little contrast")
    return pairs[0][2]


def check_ranges(page, run):
    """Compares the table of ranges with displacement.csv: half of its last digit and that of two values are allowed."""
    cells = page.value("[...document.querySelectorAll('#ranges tbody tr')].map((line) => [...line.children].map((c) => c.textContent))")
    with (run / "displacement.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "ok"]
    insist(len(cells) == 2 * len({row["marker"] for row in rows}), "two lines per target")
    for target, axis, distance, *_ in cells:
        values = [float(row[f"{axis}_mm"]) for row in rows if row["marker"] == target]
        digits = len(distance.partition(".")[2])
        insist(abs(float(distance) - (max(values) - min(values))) <= 0.5 * 0.1**digits + 2.0 * LAST_DIGIT_MM, f"{target} {axis}: {distance}, {max(values) - min(values)}")


def check_measured(browser, run, work):
    page = browser.open((run / "report.html").as_uri())
    insist(page.value("document.documentElement.dataset.state") == "ready", "the page is drawn")
    check_ranges(page, run)
    look_at_plots(page, 8)
    text = page.value("document.body.innerText")
    for words in ["mid moved", "1.70", "U (k = 2)", "steady", "Welch", "Camera motion",
                  "print", "SHA-256", "Uncertainty budget", "Settings"]:
        insist(words in text, f"'{words}' is on the page")
    insist(page.value("[...document.querySelectorAll('#picture img')].every((i) => i.naturalWidth > 100)"), "the picture is there")
    insist(page.value("[...document.querySelectorAll('.canvas, .strip canvas')].every((c) => c.getAttribute('role') === 'img' && "
                      "(c.getAttribute('aria-label') || c.getAttribute('aria-labelledby')))"), "every plot has a name")
    check_zoom(page)
    light = check_contrast(page, "light")
    before = page.value("document.querySelector('#displacement canvas').toDataURL()")
    page.theme(dark=True, still=True)
    page.value("new Promise((done) => setTimeout(done, 300))")
    insist(check_contrast(page, "dark") != light, "dark is another theme")
    middle_of_first_plot(page)
    insist(page.value("document.querySelector('#displacement canvas').toDataURL()") != before, "plots follow the theme")
    page.pdf(work / "report.pdf")
    insist((work / "report.pdf").read_bytes().startswith(b"%PDF") and (work / "report.pdf").stat().st_size > 50000, "it prints")
    insist(page.value("document.documentElement.dataset.theme") is None, "and is as before after that")
    narrow = browser.open((run / "report.html").as_uri(), width=400)
    look_at_plots(narrow, 8)
    insist(narrow.value("document.documentElement.scrollWidth") <= 400, "nothing hangs over the edge of a telephone")


def check_others(browser, refused, timeless):
    page = browser.open((refused / "report.html").as_uri())
    text = page.value("document.body.innerText")
    for words in ["Not measured", "Why there is no result", "Four reference circles", "What to do", "What was found"]:
        insist(words in text, f"refused: '{words}' is on the page")
    insist("Displacement" not in page.value("[...document.querySelectorAll('h2')].map((h) => h.textContent).join()"), "no empty plots")
    page = browser.open((timeless / "report.html").as_uri())
    look_at_plots(page, 6)
    insist("There is no spectrum of dx and dy, because the frames have no times, so measure with --fps." in page.value("document.body.innerText"), "why no spectrum")


def main():
    program, work, _source = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    # This name would end a script or title element if it were not escaped.
    clip = work / "</script><b>clip"
    clip.parent.mkdir(parents=True)
    call(program, "simulate", "small-1xyz", "--frames", 48, "--markers-only", "--quiet", "--set", "marker.mid.dy.amplitude=0.5",
         "--set", "marker.mid.dy.frequency_hz=1.7", "-o", clip)
    call(program, "measure", clip, "--site", clip / "site.toml", "--fps", 10, "-o", work / "run", "--quiet")
    shutil.rmtree(work / "grey", ignore_errors=True)
    (work / "grey").mkdir()
    subprocess.run(["ffmpeg", "-loglevel", "error", "-f", "lavfi", "-i", "color=gray:size=320x240", "-frames:v", "2",
                    str(work / "grey" / "%d.png")], check=True)
    call(program, "measure", work / "grey", "--pitch", "10mm", "-o", work / "refused", "--quiet", exit_code=4)
    call(program, "measure", clip, "--site", clip / "site.toml", "--frames", "0:6", "-o", work / "timeless", "--quiet")
    insist((work / "run" / "report.html").stat().st_size - len(script((work / "run" / "report.html").read_text(), "overlay")) < 300000,
           "the page itself is small")
    check_numbers(work / "run")
    with Browser(work) as browser:
        check_measured(browser, work / "run", work)
        check_others(browser, work / "refused", work / "timeless")
        insist(not browser.errors, f"the browser complains: {browser.errors}")
        insist(not browser.requests, f"the page asks for {browser.requests}")


if __name__ == "__main__":
    main()
