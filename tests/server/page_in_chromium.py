#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Uses the page of `moiregauge serve` in headless Chromium, with the mouse and the keyboard of a visitor.

    page_in_chromium.py MOIREGAUGE WORK [--pictures DIR]

A new user drops a clip and reaches its report with at most eight clicks and without typing. The numbers are those of the
command that the page shows, byte for byte. Then come markers, areas, zero and rest, the queue, results, channels,
another sensor, solving again, exports, the table of runs, and the live page. Both themes, 390 px and 1600 px, the tab
order, names for screen readers, and names of files that look like HTML are checked.

With --pictures it only takes the two pictures of docs/desk.md (tools/serve-pictures).
"""
import csv
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
from browser import Browser  # noqa: E402

MAX_CLICKS = 8
FRAMES = 48
DELAY_S = 0.35  # the other sensor's clock minus the camera's
PIECE = 8 << 20  # bytes that the page sends in one request
HOSTILE = "<img src=x onerror=alert(1)>.mp4"
HTML = "document.documentElement"


def insist(truth, what):
    if not truth:
        raise SystemExit(f"wrong: {what}")


def call(program, *arguments, cwd=None):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, errors="replace", check=False, cwd=cwd)
    insist(done.returncode == 0, f"{arguments}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


class Visitor:
    """A visitor of one page: counts clicks and keys. Elements are JavaScript expressions."""

    def __init__(self, page):
        self.page = page
        self.clicks = self.keys = 0

    def value(self, expression):
        return self.page.value(expression)

    def wait(self, condition, seconds=20):
        self.page.wait(f"Boolean({condition})", seconds)

    def box(self, element):
        self.wait(element)
        self.value(f"{element}.scrollIntoView({{block: 'center', behavior: 'instant'}})")
        found = self.value(f"(() => {{ const r = {element}.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; }})()")
        insist(found[2] > 0 and found[3] > 0, f"{element} is visible")
        return found

    def click(self, element):
        self.wait(f"{element} && !{element}.disabled")
        left, top, width, height = self.box(element)
        self.press(left + width / 2, top + height / 2)

    def press(self, x, y):
        self.clicks += 1
        self.page.mouse("mouseMoved", x, y)
        self.page.mouse("mousePressed", x, y, button="left", clickCount=1, buttons=1)
        self.page.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def drag(self, element, start, end):
        """From one point to another, as shares of the element's width and height."""
        left, top, width, height = self.box(element)
        points = [(left + x * width, top + y * height) for x, y in (start, end)]
        self.page.mouse("mouseMoved", *points[0])
        self.page.mouse("mousePressed", *points[0], button="left", clickCount=1, buttons=1)
        for share in (0.4, 0.8, 1.0):
            self.page.mouse("mouseMoved", *(a + share * (b - a) for a, b in zip(*points)), button="left", buttons=1)
        self.page.mouse("mouseReleased", *points[1], button="left", clickCount=1)

    def drop(self, *files, at=(300, 300)):
        data = {"items": [], "files": [str(path) for path in files], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.page.send("Input.dispatchDragEvent", type=kind, x=at[0], y=at[1], data=data)

    def key(self, key):
        self.keys += 1
        code = {"Tab": 9, "Enter": 13, "ArrowRight": 39, "Escape": 27}.get(key, 0)
        text = {"text": "\r"} if key == "Enter" else {}
        self.page.send("Input.dispatchKeyEvent", type="keyDown", key=key, code=key, windowsVirtualKeyCode=code, **text)
        self.page.send("Input.dispatchKeyEvent", type="keyUp", key=key, code=key, windowsVirtualKeyCode=code)

    def type_into(self, element, text):
        """Replaces the text of a field and leaves the field."""
        self.value(f"({element}.focus(), {element}.select())")
        self.page.send("Input.insertText", text=text)
        self.value(f"{element}.blur()")

    def choose(self, element, value):
        self.wait(element)
        self.value(f"(() => {{ const s = {element}; s.value = {json.dumps(value)}; s.dispatchEvent(new Event('change')); }})()")


def button(text, inside="document"):
    return f"[...{inside}.querySelectorAll('button')].find((b) => b.textContent === {json.dumps(text)} && b.offsetParent)"


def labelled(label):
    return f"document.querySelector('[aria-label={json.dumps(label)}]')"


def entry(path):
    return f"[...document.querySelectorAll('.entries button')].find((b) => b.dataset.path === {json.dumps(path)})"


TEXT = "document.body.innerText"
INSPECTED = f"Number({HTML}.dataset.inspected ?? 0)"
COMMAND = "document.querySelector('.setup .command code').textContent"


def after_inspection(visitor, act):
    """Acts, then waits until the frame is inspected again."""
    before = visitor.value(INSPECTED)
    act()
    visitor.wait(f"{INSPECTED} > {before} && !document.querySelector('[aria-busy]')")


# ---------------------------------------------------------------------------------------------------------------- steps


def check_first_use(visitor, clip, folder, program):
    """From an empty folder to the report."""
    insist("Drop a clip" in visitor.value(TEXT), "an empty folder is explained")
    visitor.drop(clip)
    visitor.wait(f"document.querySelectorAll('.marker').length >= 5", 30)
    visitor.wait("/256\\.0 mm/.test(document.querySelector('.distance').textContent)")
    insist((folder / clip.name).read_bytes() == clip.read_bytes(), "the upload is the file")
    visitor.click(button("Yes, right"))
    visitor.click(button("Measure"))
    visitor.wait("document.querySelectorAll('.growing canvas').length === 2")
    visitor.wait(f"{HTML}.dataset.results", 60)
    visitor.click(button("Report"))
    visitor.wait(f"{HTML}.dataset.report")
    tabs = [target["url"] for target in visitor.page.browser.send("Target.getTargets")["targetInfos"]]
    insist(any("/report/" in url for url in tabs), f"the report has a tab of its own: {tabs}")
    visitor.page.send("Page.bringToFront")  # a page behind another gets no clicks
    insist(visitor.clicks <= MAX_CLICKS and visitor.keys == 0, f"{visitor.clicks} clicks and {visitor.keys} keys up to the report")
    print(f"clip to report: {visitor.clicks} clicks, {visitor.keys} keys")
    insist("peak to peak" in visitor.value(TEXT) and "U with k = 2" in visitor.value(TEXT), "the result is stated with U")
    run = folder / f"{clip.stem}-moiregauge"
    call(program, "measure", clip.name, "--pitch", "10mm", "-o", folder.parent / "by-command", "--quiet", cwd=folder)
    for name in ("displacement.csv", "site.toml"):
        insist((run / name).read_bytes() == (folder.parent / "by-command" / name).read_bytes(), f"{name} of page and command are the same bytes")
    return run


def check_resumed_upload(visitor, folder, work):
    """The connection breaks after the first piece, then the page is closed. Both times the upload resumes where it stopped."""
    record = work / "record.csv"
    record.write_text("time_s,mm\n" + "".join(f"{k / 100:.2f},{k % 977 / 1000:.3f}\n" for k in range(800000)), encoding="utf-8")
    insist(PIECE < record.stat().st_size < 2 * PIECE, "two pieces")
    page, sent = visitor.page, visitor.page.browser.requests
    page.pause_requests(f"*/api/upload*offset={PIECE}*")
    visitor.drop(record)
    page.fail_request()
    page.fail_request()
    insist(not (folder / record.name).exists(), "an upload that is not complete is not in the folder")
    page.send("Page.reload")
    page.release_requests()
    page.wait(f"{HTML}?.dataset.state === 'ready'")
    before = len(sent)
    visitor.drop(record)
    end = time.monotonic() + 30
    while not (folder / record.name).exists():
        insist(time.monotonic() < end, "the upload ends")
        page.value("1")
    offsets = [int(found[1]) for url in sent[before:] if (found := re.search(r"/api/upload\?.*offset=(\d+)", url))]
    insist(offsets == [PIECE], f"only the second piece is sent again: {offsets}")
    insist((folder / record.name).read_bytes() == record.read_bytes(), "the upload is the file")
    visitor.wait("!document.querySelector('.uploads li')")
    (folder / record.name).unlink()


def check_markers(visitor, folder, program):
    visitor.click("document.querySelector('#tab-setup')")
    visitor.wait("document.querySelectorAll('.marker').length >= 5 && !document.querySelector('[aria-busy]')")
    labels = visitor.value("[...document.querySelectorAll('.marker')].map((m) => m.getAttribute('aria-label'))")
    insist(sum("reference" in text for text in labels) == 4 and sum("target" in text for text in labels) == 1, f"roles in words: {labels}")
    insist(visitor.value("document.querySelector('.scale-bar text').textContent").endswith("mm"), "a scale bar")
    insist(visitor.value("document.querySelectorAll('.expected tbody td').length") == 2, "expected U of the target")
    after_inspection(visitor, lambda: visitor.click(labelled("Larger pitch")))
    insist("307.2" in visitor.value("document.querySelector('.distance').textContent"), "12 mm instead of 10 mm gives 1.2 times the distance")
    after_inspection(visitor, lambda: visitor.type_into(labelled("Distance R1 to R2 by tape in mm"), "256"))
    insist(visitor.value(f"{labelled('Pitch of the gratings in mm')}.value") == "10", "the distance by tape sets the pitch")
    visitor.click("document.querySelector('.marker.target polygon')")
    after_inspection(visitor, lambda: (visitor.type_into("document.querySelector('.popover input')", "midspan"), visitor.key("Escape")))
    insist("--name T1=midspan" in visitor.value(COMMAND), "the new name is in the command")
    visitor.click("document.querySelector('[data-marker=R4] polygon')")
    after_inspection(visitor, lambda: visitor.click(button("Ignore", "document.querySelector('.popover')")))
    insist("--ignore R4" in visitor.value(COMMAND), "an ignored marker is in the command")
    after_inspection(visitor, lambda: visitor.choose(labelled("Role of R4"), "reference"))
    visitor.click(button("Save as site.toml"))
    visitor.wait("document.querySelector('.message')")
    sites = list(folder.glob("*.site.toml"))
    insist(len(sites) == 1 and "midspan" in sites[0].read_text(), "the site file has the new name")
    call(program, "inspect", f"{sites[0].name.removesuffix('.site.toml')}.mp4", "--site", sites[0].name, "-o", folder.parent / "inspected", "--quiet", cwd=folder)
    after_inspection(visitor, lambda: visitor.click(button("As found")))


def check_areas_and_times(visitor):
    visitor.click(button("Ignore here"))
    after_inspection(visitor, lambda: visitor.drag("document.querySelector('.drawing')", (0.4, 0.3), (0.6, 0.7)))
    insist("--exclude-region" in visitor.value(COMMAND), "an ignored area is in the command")
    insist("No target" in visitor.value("document.querySelector('.expected').textContent"), "the target in it is not used")
    after_inspection(visitor, lambda: visitor.click(labelled("Remove this area: Ignore")))
    visitor.click(button("Look here"))
    after_inspection(visitor, lambda: visitor.drag("document.querySelector('.drawing')", (0.02, 0.02), (0.98, 0.98)))
    insist("--region" in visitor.value(COMMAND), "an area to look at is in the command")
    after_inspection(visitor, lambda: visitor.click(labelled("Remove this area: Look only here")))
    visitor.click(button("Select"))
    after_inspection(visitor, lambda: visitor.click(labelled("Next frame")))
    insist("--reference-frame 1" in visitor.value(COMMAND), "another frame becomes the reference frame")
    after_inspection(visitor, lambda: visitor.click(labelled("Previous frame")))
    for lane, start, end in (("zero", 0.0, 0.25), ("rest", 0.5, 1.0)):
        visitor.drag(f"document.querySelector('.lane.{lane} .lane-track')", (start, 0.5), (end, 0.5))
    # A frame is 8 px wide here, and the pointer moves in whole pixels.
    insist(re.search(rf"--zero 0:1[123] --rest 2[345]:{FRAMES}$", visitor.value(COMMAND)), f"zero and rest: {visitor.value(COMMAND)}")
    visitor.wait("/not at rest/.test(document.querySelector('.status-line').textContent)")
    visitor.click(labelled("Remove Rest"))
    visitor.click(labelled("Remove Zero"))
    insist("--zero" not in visitor.value(COMMAND), "removed again")


def check_queue(visitor, long_clip, folder):
    """Two clips queue. The first is stopped and resumed."""
    shutil.copy(long_clip, folder / "long.mp4")
    shutil.copy(long_clip, folder / "second.mp4")
    for name in ("long.mp4", "second.mp4"):
        visitor.wait(entry(name))
        visitor.click(entry(name))
        visitor.click(button("Measure"))
        visitor.wait(f"{HTML}.dataset.step === 'measure'")
    visitor.wait("/waiting/.test(document.querySelector('.queue').textContent)")
    visitor.click(entry("long.mp4"))
    visitor.wait("/of \\d+ frames/.test(document.querySelector('.facts')?.textContent)")
    visitor.click(button("Stop"))
    visitor.click(button("Resume"))
    visitor.click(entry("second.mp4"))
    visitor.wait("document.querySelector('.clip-head h2').textContent === 'second.mp4'")
    visitor.click(button("Stop"))
    visitor.wait(button("Resume"))
    visitor.wait(f"({entry('long.mp4')}.querySelector('.state.done'))", 60)


def check_results(visitor, run, lvdt, downloads):
    visitor.click(entry("bridge.mp4"))
    visitor.wait(f"{HTML}.dataset.results && document.querySelector('.results .u-over')")
    shown = "document.querySelector('.shown').textContent"
    insist(visitor.value(shown) == "the whole record is shown", "all is shown at first")
    visitor.drag("document.querySelector('.results .u-over')", (0.25, 0.5), (0.6, 0.5))
    visitor.wait(f"{shown} !== 'the whole record is shown'")
    visitor.click(labelled("Show all"))
    visitor.wait(f"{shown} === 'the whole record is shown'")
    left, top, width, height = visitor.box("document.querySelector('.results .u-over')")
    visitor.press(left + 0.5 * width, top + 0.5 * height)
    visitor.wait(f"{HTML}.dataset.sampleMarkers")
    middle = int(visitor.value(f"{HTML}.dataset.sampleFrame"))
    insist(abs(middle - FRAMES / 2) <= 2, f"the frame of the clicked sample: {middle}")
    insist(int(visitor.value(f"{HTML}.dataset.sampleMarkers")) == 5 and visitor.value("document.querySelectorAll('.results .marker').length") == 5, "with its markers")
    insist("dx" in visitor.value("document.querySelector('.values').textContent"), "and its values")
    check_channels(visitor)
    check_sensor(visitor, run, lvdt)
    check_files(visitor, downloads)
    check_solve(visitor, run)


def check_channels(visitor):
    visitor.click(labelled("Zero is the mean over the shown range"))
    visitor.choose(labelled("Filter"), "lowpass")
    visitor.type_into(labelled("Frequency of the filter in Hz"), "3")
    visitor.click(button("Show channels"))
    visitor.wait("document.querySelector('#derived canvas')", 30)
    text = visitor.value("document.querySelector('#derived').innerText")
    insist("T1_dy" in text and "lowpass" in text and "\u00b1" in text, f"channels, layers and U: {text[:300]}")


def check_sensor(visitor, run, lvdt):
    left, top, width, height = visitor.box("document.querySelector('.drop.slim')")
    visitor.drop(lvdt, at=(left + width / 2, top + height / 2))
    visitor.wait(f"!{button('Align and compare')}.disabled")
    visitor.click(button("Align and compare"))
    visitor.wait("document.querySelector('#comparison canvas')", 30)
    facts = json.loads((run / "comparison" / "comparison.json").read_text())
    insist(abs(facts["offset_s"]["value"] - DELAY_S) < 0.01, f"offset of the clocks: {facts['offset_s']}")
    insist("time offset" in visitor.value("document.querySelector('#comparison').innerText"), "the figures are shown")


def check_files(visitor, downloads):
    visitor.click(button("displacement.csv"))
    visitor.click(button("Excel"))
    wanted = [downloads / "bridge-moiregauge-displacement.csv", downloads / "bridge-moiregauge.xlsx"]
    end = time.monotonic() + 20
    while not all(path.exists() for path in wanted):
        insist(time.monotonic() < end, f"downloads: {sorted(path.name for path in downloads.iterdir())}")
        time.sleep(0.1)


def check_solve(visitor, run):
    before = (run / "displacement.csv").read_bytes()
    visitor.click(labelled("Zero: the shown range"))
    visitor.value(f"delete {HTML}.dataset.results")
    visitor.click(button("Solve again"))
    visitor.wait(f"{HTML}.dataset.results", 30)
    config = json.loads((run / "run.json").read_text())["config"]
    insist(config["zero"] and (run / "displacement.csv").read_bytes() != before, "solved again with another zero")


def check_table(visitor):
    visitor.click(button("Table of runs"))
    visitor.wait("document.querySelectorAll('.batch tbody tr').length >= 2")
    visitor.click(button("dy: peak to peak (mm)", "document.querySelector('.batch')"))
    insist(visitor.value("document.querySelector('[aria-sort=descending]').textContent") == "dy: peak to peak (mm)", "sorted by movement")


def check_live(visitor):
    visitor.click(button("Live"))
    visitor.choose(labelled("Source"), "long.mp4")
    visitor.click("document.querySelector('.live .check input')")
    visitor.type_into(labelled("Limit of the alarm in mm"), "0.1")
    insist("--alarm '|T1.dy| > 0.1 mm'" in visitor.value("document.querySelector('.live .command code').textContent"), "the alarm is in the command")
    visitor.click(button("Start"))
    visitor.wait("Number(document.querySelector('.live').dataset.frames ?? 0) > 10", 30)
    visitor.wait("document.querySelectorAll('.live .growing canvas').length === 2")
    visitor.wait("document.querySelector('.lamp.raised')", 20)
    visitor.wait("document.querySelector('.live-picture').naturalWidth > 100")
    insist("%" in visitor.value("document.querySelector('.meter output').textContent"), "focus in words")
    visitor.click(button("Stop"))
    visitor.wait("/Ended/.test(document.querySelector('.live-state h3').textContent)", 30)


NAMELESS = """[...document.querySelectorAll('button, input, select, textarea, [role=img], [tabindex="0"]')].filter((e) => e.offsetParent !== null || e.namespaceURI.endsWith('svg'))
  .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.closest('label')?.textContent.trim()))
  .map((e) => e.outerHTML.slice(0, 120))"""


def check_access(visitor):
    """Every control has a name, and the keyboard reaches it in the order of the page."""
    insist(not visitor.value(NAMELESS), f"controls without a name: {visitor.value(NAMELESS)}")
    insist(visitor.value("[...document.querySelectorAll('img')].every((i) => i.hasAttribute('alt'))"), "images have alternative texts")
    visitor.value("(document.activeElement?.blur(), window.getSelection()?.removeAllRanges(), document.querySelector('.skip').focus())")
    reached = []
    for _ in range(14):
        visitor.key("Tab")
        reached.append(visitor.value("(() => { const a = document.activeElement; const r = a.getBoundingClientRect();"
                                     " return [(a.getAttribute('aria-label') || a.textContent).trim().slice(0, 40), a.matches(':focus-visible') && getComputedStyle(a).outlineStyle]; })()"))
    insist(len({name for name, _ in reached}) >= 10, f"Tab moves through the page: {reached}")
    insist(all(ring == "solid" for _, ring in reached), f"the focus is visible: {reached}")


def luminance(colour):
    parts = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def check_contrast(visitor, theme):
    """WCAG 2.1: 4.5 for text on cards, panels and the page."""
    colours = visitor.value(f"Object.fromEntries(['ink', 'ink-soft', 'good', 'bad', 'link', 'card', 'back', 'panel', 'action', 'action-ink', 'fair']"
                            f".map((name) => [name, getComputedStyle({HTML}).getPropertyValue('--' + name).trim()]))")
    pairs = [(ink, paper) for ink in ("ink", "ink-soft", "good", "bad", "link", "fair") for paper in ("card", "back", "panel")] + [("action-ink", "action")]
    for ink, paper in pairs:
        light, dark = sorted([luminance(colours[ink]), luminance(colours[paper])], reverse=True)
        insist((light + 0.05) / (dark + 0.05) >= 4.5, f"{theme}: {ink} on {paper} has too little contrast")


def check_looks(browser, address):
    """Light and dark, 1600 px and 390 px: nothing overhangs, and the switch overrules the system."""
    for width, height in ((1600, 950), (390, 844)):
        for theme in ("light", "dark"):
            visitor = Visitor(browser.open(address, width=width, height=height, dark=theme == "dark"))
            insist(visitor.value(f"{HTML}.dataset.theme") == theme, f"{theme} as the system")
            check_contrast(visitor, theme)
            for step, ready in (("setup", "document.querySelectorAll('.marker').length >= 5"), ("results", "document.querySelector('.results .u-over')")):
                if step == "setup":
                    visitor.click(entry("bridge.mp4"))
                visitor.click(f"document.querySelector('#tab-{step}')")
                visitor.wait(ready)
                if (step, width) == ("results", 390):
                    inner = visitor.value("(() => { const t = document.querySelector('.headline .wide'); return [t.scrollWidth - t.clientWidth, t.querySelectorAll('td').length,"
                                          " [...t.querySelectorAll('td')].every((c) => c.getBoundingClientRect().right <= innerWidth && getComputedStyle(c, '::before').content.length > 2)]; })()")
                    insist(inner[0] <= 0 and inner[1] >= 6 and inner[2], f"the table of results needs no sideways scroll, and each value has its heading: {inner}")
                overhang = visitor.value("document.querySelector('#main').scrollWidth - document.querySelector('#main').clientWidth")
                insist(overhang <= 0, f"{step} at {width} px: {overhang} px overhang")
    visitor.click("document.querySelector('#theme')")
    insist(visitor.value(f"{HTML}.dataset.theme") == "light", "the switch overrules the system")
    visitor.click("document.querySelector('#theme')")
    visitor.click("document.querySelector('#theme')")


def check_hostile(visitor, clip, folder):
    """A file's name that looks like HTML stays text."""
    shutil.copy(clip, folder / HOSTILE)
    visitor.wait(entry(HOSTILE))
    visitor.click(entry(HOSTILE))
    visitor.wait("document.querySelectorAll('.marker').length >= 5", 30)
    insist(visitor.value("document.querySelector('.clip-head h2').textContent") == HOSTILE, "the name is shown as it is")
    insist(visitor.value("document.querySelectorAll('img[onerror], img[src=x]').length") == 0, "and makes no element")
    insist(HOSTILE in visitor.value(COMMAND), "the command quotes it")


def make_footage(program, work):
    made = work / "made"
    call(program, "simulate", "small-still", "--frames", FRAMES, "--quiet", "--codec", "x264", "--quality", 18, "--set", "marker.mid.dy.amplitude=0.5",
         "--set", "marker.mid.dy.frequency_hz=1.1", "-o", made)
    clip = work / "bridge.mp4"
    shutil.copy(made / "video.mp4", clip)
    long_clip = work / "long.mp4"
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-stream_loop", "79", "-i", clip, "-c", "copy", str(long_clip)], check=True)
    with (made / "truth.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["marker"] == "mid"]
    lvdt = work / "lvdt.csv"
    lvdt.write_text("time_s,mm\n" + "".join(f"{float(row['time_s']) + DELAY_S:.4f},{float(row['dy_mm']):.5f}\n" for row in rows), encoding="utf-8")
    return clip, long_clip, lvdt


def start_server(program, folder):
    server = subprocess.Popen([program, "serve", str(folder), "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    address = server.stdout.readline().strip()
    insist(address.startswith("http://127.0.0.1:"), f"the server prints its address: {address}")
    return server, address


def stop_server(server):
    server.send_signal(signal.SIGINT)
    try:
        server.wait(20)
    except subprocess.TimeoutExpired:
        server.kill()


def save_picture(page, path):
    """Saves what is visible with 256 colours."""
    time.sleep(1.0)
    raw = path.with_suffix(".raw.png")
    page.screenshot(raw, whole=False)
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", str(raw), "-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=none", str(path)], check=True)
    raw.unlink()


def take_pictures(program, work, pictures):
    clip, _, _ = make_footage(program, work)
    folder = work / "bridge"
    folder.mkdir()
    shutil.copy(clip, folder / "bridge.mp4")
    server, address = start_server(program, folder)
    try:
        with Browser(work) as browser:
            visitor = Visitor(browser.open(address, width=1360, height=800))
            visitor.click(entry("bridge.mp4"))
            visitor.wait("document.querySelectorAll('.marker').length >= 5", 30)
            visitor.click("document.querySelector('.marker.target polygon')")
            save_picture(visitor.page, pictures / "serve-setup.png")
            visitor.key("Escape")
            visitor.click(button("Measure"))
            visitor.wait(f"{HTML}.dataset.results", 60)
            visitor.click("document.querySelector('.results .u-over')")
            visitor.wait(f"{HTML}.dataset.sampleMarkers")
            visitor.value("document.querySelector('#main').scrollTo(0, 0)")
            save_picture(visitor.page, pictures / "serve-results.png")
    finally:
        stop_server(server)


def visit(program, work):
    clip, long_clip, lvdt = make_footage(program, work)
    folder = work / "folder"
    folder.mkdir()
    server, address = start_server(program, folder)
    started = time.monotonic()

    def done(what):
        print(f"{time.monotonic() - started:5.1f} s  {what}", flush=True)

    try:
        with Browser(work) as browser:
            browser.downloads_to(work / "downloads")
            visitor = Visitor(browser.open(address, width=1600, height=950))
            run = check_first_use(visitor, clip, folder, program)
            done("first use")
            check_markers(visitor, folder, program)
            check_areas_and_times(visitor)
            done("set up")
            check_queue(visitor, long_clip, folder)
            done("queue")
            check_results(visitor, run, lvdt, work / "downloads")
            check_access(visitor)
            done("results")
            check_table(visitor)
            check_live(visitor)
            done("table and live")
            check_hostile(visitor, clip, folder)
            check_resumed_upload(visitor, folder, work)
            done("resumed upload")
            check_looks(browser, address)
            done("looks")
            # Chromium logs every refusal, and the connection that check_resumed_upload() breaks. A live source has no picture before its first frame, and its run none before it ends.
            errors = [text for text in browser.errors if not any(part in text for part in ("/api/live-frame", "/api/thumbnail", "ERR_CONNECTION_RESET"))]
            insist(not errors, f"the browser complains: {errors}")
            outside = [url for url in browser.requests if not url.startswith((address, "blob:" + address, "data:"))]
            insist(not outside, f"the page asks for {outside}")
    finally:
        stop_server(server)


def main():
    program, work = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    if "--pictures" in sys.argv:
        take_pictures(program, work, pathlib.Path(sys.argv[sys.argv.index("--pictures") + 1]).resolve())
    else:
        visit(program, work)


if __name__ == "__main__":
    main()
