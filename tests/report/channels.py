#!/usr/bin/python3
"""Checks what report.html shows of several targets, of `derive` and of `compare`, and its first page on paper.

    channels.py MOIREGAUGE WORK SOURCE

Targets, channels and layers are switched on and off by mouse and keys. The values of every choice of layers are those
that `derive` writes with these layers. Every plot saves its numbers as CSV and its image as PNG. `derive` and `compare`
leave the run's data in the page as they are. Headline, table and plots fit on the first page, whatever the run.
"""
import csv
import itertools
import json
import math
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import time
import zlib

from browser import Browser
from report_in_chromium import EACH, call, columns, insist, look_at_plots, script

FRAMES, FPS, OFFSET_S = 60, 10, 0.137
LAYERS = [("--zero", "0:8"), ("--filter", "lowpass:2.5Hz")]
CHANNELS = ["--channel", "sag = mid.dy - (left.dy + right.dy) / 2", "--channel", "tilt = rotation(left, right)"]


def scenario():
    """Returns the small rig with three targets that vibrate at 0.5 Hz."""
    text = []
    for name, x, y in (("NW", -1, 1), ("NE", 1, 1), ("SW", -1, -1), ("SE", 1, -1)):
        text.append(f'[[marker]]\nname = "{name}"\nrole = "reference"\ncircle_mm = [{128 * x}, {40 * y}]\n'
                    f'circle_diameter_mm = 16\ngrating_mm = [{100 * x}, {40 * y}]\ngrating_size_mm = [30, 30]\npitch_mm = 10\n')
    for name, x, amplitude in (("left", -58, 0.2), ("mid", 0, 0.6), ("right", 58, 0.3)):
        text.append(f'[[marker]]\nname = "{name}"\nrole = "target"\ngrating_mm = [{x}, 0]\ngrating_size_mm = [40, 40]\npitch_mm = 10\n'
                    f'[marker.dy]\namplitude = {amplitude}\nfrequency_hz = 0.5\nscale = 0.2\n')
    return f'base = "small-1xyz"\nframes = {FRAMES}\n' + "".join(text)


def page_of(run):
    return (run / "report.html").read_text(encoding="utf-8")


def unpacked(added):
    """Returns the columns of an added script, by the reader of the samples."""
    body = json.dumps({"columns": added["columns"]})
    return columns(f'<script type="application/json" id="report">{body}</script>'
                   f'<script type="text/plain" id="samples">{added["samples"]}</script>')[1]


def same(value, text, quantum):
    wanted = float(text)
    return (math.isnan(value) and math.isnan(wanted)) or abs(value - wanted) <= 0.5 * quantum + 1e-9 * abs(wanted)


def check_layers(program, run, work):
    """Each choice of layers in the page has the values that `derive` writes with these layers."""
    added = json.loads(script(page_of(run), "derived"))
    insist(added["layers"] == ["zero 0:8", "filter lowpass:2.5Hz"], f"{added['layers']}")
    insist(sorted(state["on"] for state in added["states"]) == [list(on) for on in itertools.product([False, True], repeat=2)], "all choices")
    lists = unpacked(added)
    for state in added["states"]:
        layers = [word for on, layer in zip(state["on"], LAYERS) if on for word in layer]
        call(program, "derive", run, *CHANNELS, *layers, "-o", work / "choice.csv", "--quiet")
        with (work / "choice.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        about = json.loads((work / "choice.json").read_text(encoding="utf-8"))
        for channel, unit, statistics, stated in zip(["sag", "tilt"], ["mm", "mrad"], state["channels"], about["channels"]):
            for key, name in [("value", f"{channel}_{unit}"), ("u", f"u_{channel}_{unit}")]:
                quantum = added["columns"][statistics[key]]["quantum"]
                insist(quantum <= 0.05 * stated["u"], f"{name} is rounded to {quantum}")
                insist(len(lists[statistics[key]]) == len(rows) == FRAMES, f"{name} has a value for each row")
                insist(all(same(v, row[name], quantum) for v, row in zip(lists[statistics[key]], rows)), f"{layers}: {name}")
            insist(statistics["peak_to_peak"] == stated["peak_to_peak"] and statistics["ok"] == stated["ok"], f"{layers}: statistics")


def write_reference(clip, path):
    """Writes the record of another sensor: the truth of mid.dy every 20 ms with noise, a bias and another clock."""
    with (clip / "truth.csv").open(encoding="utf-8") as file:
        truth = [(float(row["time_s"]), float(row["dy_mm"])) for row in csv.DictReader(file) if row["marker"] == "mid"]
    noise = random.Random(1)
    lines = ["t,defl"]
    for k in range(50 * FRAMES // FPS - 10):
        at = k / 50
        n = min(len(truth) - 2, int(at * FPS))
        share = (at - truth[n][0]) * FPS
        value = truth[n][1] + share * (truth[n + 1][1] - truth[n][1])
        lines.append(f"{at + OFFSET_S:.4f},{value + 2 + noise.gauss(0, 0.01):.5f}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def check_comparison(run):
    added = json.loads(script(page_of(run), "comparison"))
    lists = unpacked(added)
    with (run / "comparison" / "comparison.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for key, name in [("moiregauge", "moiregauge"), ("reference", "reference"), ("u", "u")]:
        quantum = added["columns"][added["rows"][key]]["quantum"]
        insist(quantum <= 0.05 * added["rms_u"], f"{name} is rounded to {quantum}")
        insist(len(lists[added["rows"][key]]) == len(rows), f"{name} has a value for each row")
        insist(all(same(v, row[name], quantum) for v, row in zip(lists[added["rows"][key]], rows)), f"comparison: {name}")


def images(page, where):
    return page.value(f"[...document.querySelectorAll('{where} canvas')].map((c) => c.toDataURL())")


def settle(page):
    page.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 60)))")


def switch(page, where, label):
    """Clicks a box and returns whether all plots in `where` have changed."""
    page.value(EACH.replace("ACT", "(() => 1)"))
    before = images(page, where)
    page.value(f"[...document.querySelectorAll('{where} .choices label')].find((l) => l.textContent === '{label}').click()")
    settle(page)
    page.value(EACH.replace("ACT", "(() => 1)"))
    after = images(page, where)
    return len(before) != len(after) or all(a != b for a, b in zip(before, after))


def check_switches(page):
    keys = "[...document.querySelectorAll('.together .plot:last-child .keys li')].map((k) => k.textContent).join()"
    insist(page.value(keys) == "mid,right,left,U (k = 2)", f"the largest movement first: {page.value(keys)}")
    insist(switch(page, ".together", "right"), "a target is switched off")
    insist(page.value(keys) == "mid,left,U (k = 2)", "and is no longer in the key")
    page.value("document.querySelector('.together .choices input').focus()")
    page.key(" ")
    settle(page)
    insist(page.value(keys) == "left,U (k = 2)", "the space key switches, too")
    insist(switch(page, ".together", "U (k = 2)"), "bands are switched off")
    insist(page.value(keys) == "left", "and are no longer in the key")
    for text, shown in [("None", ""), ("All", "mid,right,left")]:
        page.value(f"[...document.querySelectorAll('.together .choices button')].find((b) => b.textContent === '{text}').click()")
        settle(page)
        insist(page.value(keys) == shown, f"{text}: {page.value(keys)}")
    cell = "document.querySelector('#derived tbody tr td:nth-child(3)').textContent"
    filtered = page.value(cell)
    rows = "document.querySelector('#derived tbody tr td:last-child').textContent"
    insist(page.value(rows).startswith("46 of"), f"a filter of 7 rows to each side: {page.value(rows)}")
    insist(switch(page, "#derived", "filter lowpass:2.5Hz"), "a layer is switched off")
    insist(page.value(rows).startswith("60 of") and page.value(cell) != filtered, "and the statistics are those without it")
    insist(page.value("[...document.querySelectorAll('#derived .choices input')].map((i) => i.checked).join()") == "true,true,true,false",
           "the other layer stays")
    insist(switch(page, "#derived", "zero 0:8"), "so is the other one")
    insist(switch(page, "#derived", "tilt"), "a channel is switched off")
    insist(page.value("document.querySelectorAll('#derived .plot').length") == 1, "and has no plot")


def saved(folder, name):
    end = time.monotonic() + 20
    while time.monotonic() < end:
        if (folder / name).exists() and (folder / name).stat().st_size > 0:
            return (folder / name).read_bytes()
        time.sleep(0.05)
    raise SystemExit(f"wrong: {name} was not saved: {[path.name for path in folder.iterdir()]}")


def check_files(browser, page, run, folder):
    """Every plot has both buttons; the files hold what the plot shows."""
    browser.downloads_to(folder)
    insist(page.value("[...document.querySelectorAll('.plot')].every((p) => [...p.querySelectorAll('.actions button')].map((b) => b.textContent).join() === 'CSV,PNG')"),
           "every plot has its buttons")
    names = page.value("[...document.querySelectorAll('.actions button')].map((b) => b.getAttribute('aria-label'))")
    insist(len(set(names)) == len(names) and "Save mid: dy, up is positive as CSV" in names, f"every button has a name of its own: {names}")
    page.value("[...document.querySelectorAll('.actions button')].filter((b) => /mid: dy|All targets: dx|Bland/.test(b.getAttribute('aria-label'))).forEach((b) => b.click())")
    with (run / "displacement.csv").open(encoding="utf-8") as file:
        samples = [row for row in csv.DictReader(file) if row["marker"] == "mid"]
    rows = list(csv.DictReader(saved(folder, "clip-mid-dy.csv").decode().splitlines()))
    insist(list(rows[0]) == ["frame", "time_s", "dy_mm", "u_dy_mm", "status"], f"{list(rows[0])}")
    insist(len(rows) == len(samples) == FRAMES, f"{len(rows)} rows")
    for row, sample in zip(rows, samples):
        insist(row["frame"] == sample["frame"] and float(row["time_s"]) == float(sample["time_s"]) and row["status"] == sample["status"], f"{row}")
        insist(abs(float(row["dy_mm"]) - float(sample["dy_mm"])) <= 0.05 * max(1e-3, float(sample["u_dy_mm"])), f"{row} {sample}")
    for name in ["clip-mid-dy.png", "clip-targets-dx.png", "clip-bland-altman.png"]:
        check_image(saved(folder, name), name)
    # A zoomed plot saves the rows that it shows.
    page.value("document.querySelector('#displacement .target .canvas').focus()")
    page.key("+")
    page.value("[...document.querySelectorAll('.actions button')].find((b) => b.getAttribute('aria-label') === 'Save left: dx, right is positive as CSV').click()")
    times = [float(row["time_s"]) for row in csv.DictReader(saved(folder, "clip-left-dx.csv").decode().splitlines())]
    whole = (FRAMES - 1) / FPS  # the middle half: 0.25 to 0.75 of it
    insist(times == [n / FPS for n in range(FRAMES) if 0.25 * whole <= n / FPS <= 0.75 * whole], f"the rows shown: {times}")


def first_row(line, step):
    """Returns the bytes of a PNG's first row: filter, then bytes relative to the pixel before (PNG specification, 9.2)."""
    share = {0: 0, 1: 1, 2: 0, 3: 0.5, 4: 1}[line[0]]
    row = bytearray()
    for k, byte in enumerate(line[1:]):
        row.append((byte + (int(share * row[k - step]) if k >= step else 0)) % 256)
    return row


def check_image(data, name):
    """A PNG of 1800 px on white paper with curves on it."""
    insist(data.startswith(b"\x89PNG"), f"{name} is a PNG")
    width, height, bits, kind = struct.unpack(">IIBB", data[16:26])
    insist(width == 1800 and height > 600 and bits == 8 and kind in (2, 6), f"{name}: {width} x {height}, {bits} bits, kind {kind}")
    body, at = b"", 8
    while at < len(data):
        size, word = struct.unpack(">I4s", data[at:at + 8])
        body += data[at + 8:at + 8 + size] if word == b"IDAT" else b""
        at += 12 + size
    step = 3 if kind == 2 else 4
    insist(set(first_row(zlib.decompress(body)[:1 + step * width], step)) == {255}, f"{name} is on white paper")
    insist(len(data) > 15000, f"{name} is blank")


def first_page(page, path):
    page.pdf(path)
    text = subprocess.run(["pdftotext", "-f", "1", "-l", "1", "-layout", str(path), "-"], capture_output=True, text=True, check=True).stdout
    return text, text.count("Time (s)")  # the label of every plot's abscissa


def crowded(page):
    """Returns the page as one of twelve targets with forty long warnings and thirty sentences."""
    report = json.loads(script(page, "report"))
    report["warnings"] = [f"warning {n} that is long, because it has many words about the cause and the remedy of what it warns of, and more of them" for n in range(40)]
    report["summary"] = report["summary"][:1] + [f"Sentence {n} of the result, which is about as long as those that the program writes on a target." for n in range(30)]
    report["targets"] = [dict(target, name=f"{target['name']} {n}") for n in range(4) for target in report["targets"]]
    return page.replace(script(page, "report"), json.dumps(report).replace("<", "\\u003c"))


def check_paper(browser, run, work):
    page = browser.open((run / "report.html").as_uri())
    text, plots = first_page(page, work / "paper.pdf")
    for words in ["clip", "mid moved up and down by 1.2", "Peak to peak", "right", "Displacement", "dy, up is positive"]:
        insist(words in text, f"'{words}' is on the first page:\n{text}")
    insist(plots == 2, f"{plots} plots are on the first page, not 2")
    insist("more target" not in text and "more warning" not in text, "three targets and their warning have room")
    (work / "crowded.html").write_text(crowded(page_of(run)), encoding="utf-8")
    page = browser.open((work / "crowded.html").as_uri())
    text, plots = first_page(page, work / "crowded.pdf")
    for words in ["mid moved up and down by 1.2", "Warning 0", "more warnings: last page", "more sentences: last page", "Peak to peak", "Displacement"]:
        insist(words in text, f"crowded: '{words}' is on the first page:\n{text}")
    insist(plots == 2, f"crowded: {plots} plots are on the first page, not 2")
    whole = subprocess.run(["pdftotext", str(work / "crowded.pdf"), "-"], capture_output=True, text=True, check=True).stdout
    whole = " ".join(whole.split())
    insist(all(f"Warning {n} that" in whole for n in range(40)) and all(f"Sentence {n} of" in whole for n in range(30)), "all texts are on paper")


def main():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    (work / "three.toml").write_text(scenario(), encoding="utf-8")
    clip, run = work / "clip", work / "run"
    call(program, "simulate", work / "three.toml", "--markers-only", "--quiet", "-o", clip)
    call(program, "measure", clip, "--site", clip / "site.toml", "--fps", FPS, "-o", run, "--quiet")
    before = {name: script(page_of(run), name) for name in ["report", "run", "samples", "overlay"]}
    call(program, "derive", run, *CHANNELS, "--quiet")
    layers = [word for layer in LAYERS for word in layer]
    call(program, "derive", run, *CHANNELS, *layers, "--quiet")
    write_reference(clip, work / "lvdt.csv")
    call(program, "compare", run, work / "lvdt.csv", "--channel", "mid.dy", "--quiet")
    insist({name: script(page_of(run), name) for name in before} == before, "the run's data in the page are as they were")
    check_layers(program, run, work)
    check_comparison(run)
    with Browser(work) as browser:
        page = browser.open((run / "report.html").as_uri(), dark=True)
        look_at_plots(page, 16)
        text = page.value("document.body.innerText")
        for words in ["Channels", "sag = mid.dy", "Comparison", "lvdt.csv", "time offset", "limits of agreement", "coverage of U", "Bland-Altman"]:
            insist(words in text, f"'{words}' is on the page")
        insist(page.value("[...document.querySelectorAll('input')].every((i) => i.labels.length === 1 && i.labels[0].textContent && i.closest('fieldset').querySelector('legend'))"),
               "every box has a label in a group with a name")
        check_files(browser, page, run, work / "saved")
        page.value("[...document.querySelectorAll('.toolbar button')].find((b) => b.textContent === 'All').click()")
        check_switches(page)
        for width in [390, 1600]:
            other = browser.open((run / "report.html").as_uri(), width=width)
            look_at_plots(other, 16)
            insist(other.value("document.documentElement.scrollWidth") <= width, f"nothing hangs over the edge at {width} px")
        check_paper(browser, run, work)
        insist(not browser.errors, f"the browser complains: {browser.errors}")
        insist(not browser.requests, f"the page asks for {browser.requests}")


if __name__ == "__main__":
    main()
