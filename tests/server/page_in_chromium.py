#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Uses the page of `moiregauge serve` in headless Chromium, with the mouse and the keyboard of a visitor.

    page_in_chromium.py MOIREGAUGE WORK

A new user drops a clip and reaches its report with at most eight clicks and without typing. The numbers are those of the
command that the page shows, byte for byte. Then come markers, areas, zero and rest, the queue, results, channels,
another sensor, solving again, exports, the table of runs, and the live page. Both themes, 390 px and 1600 px, the tab
order, names for screen readers, and names of files that look like HTML are checked.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import time

from page_looks import check_access, check_looks
from visitor import (COMMAND, DELAY_S, FRAMES, HTML, Browser, Visitor, button, call, entry, insist, labelled, make_footage, start_server,
                     stop_server)

MAX_CLICKS = 8
PIECE = 8 << 20  # bytes that the page sends in one request
HOSTILE = "<img src=x onerror=alert(1)>.mp4"
TEXT = "document.body.innerText"
INSPECTED = f"Number({HTML}.dataset.inspected ?? 0)"


def after_inspection(visitor, act):
    """Acts, then waits until the frame is inspected again."""
    before = visitor.value(INSPECTED)
    act()
    visitor.wait(f"{INSPECTED} > {before} && !document.querySelector('[aria-busy]')")


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


def check_dropped_folder(visitor, clip, folder, work):
    """A folder of photographs is one entry. What cannot be stored is named."""
    photographs = work / "photographs"
    (photographs / "inner").mkdir(parents=True)
    subprocess.run(["ffmpeg", "-loglevel", "error", "-i", str(clip), "-frames:v", "12", str(photographs / "p%02d.png")], check=True)
    shutil.copy(photographs / "p01.png", photographs / "inner" / "p01.png")
    visitor.drop(photographs)
    visitor.wait(f"{entry('photographs')} && document.querySelector('.clip-head h2').textContent === 'photographs'", 30)
    visitor.wait("document.querySelectorAll('.marker').length >= 5 && !document.querySelector('[aria-busy]')", 30)
    made, stored = sorted(photographs.glob("*.png")), sorted((folder / "photographs").iterdir())
    insist([path.read_bytes() for path in made] == [path.read_bytes() for path in stored], f"all photographs are stored: {stored}")
    insist("a folder in a folder is not received" in visitor.value(TEXT), "the page says why the inner folder is missing")


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


def check_picture(visitor):
    """The picture next to the curves has no camera motion, unless it is wanted as filmed."""
    image = "document.querySelector('.picture-window img')"
    visitor.wait(f"{image}.naturalWidth > 0 && {image}.style.transform.startsWith('matrix3d')")
    corners = visitor.value(f"(() => {{ const a = {image}.getBoundingClientRect(), b = {image}.parentElement.getBoundingClientRect(); return [a.left - b.left, a.top - b.top, a.right - b.right]; }})()")
    insist(max(map(abs, corners)) < 1.0, f"the picture of a camera at rest is in its place: {corners} px")
    visitor.click("document.querySelector('.side-picture input')")
    visitor.wait(f"{image}.style.transform === '' && /as filmed/.test(document.querySelector('.side-picture figcaption').textContent)")


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
    check_picture(visitor)
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


def check_hostile(visitor, clip, folder):
    """A file's name that looks like HTML stays text."""
    shutil.copy(clip, folder / HOSTILE)
    visitor.wait(entry(HOSTILE))
    visitor.click(entry(HOSTILE))
    visitor.wait("document.querySelectorAll('.marker').length >= 5", 30)
    insist(visitor.value("document.querySelector('.clip-head h2').textContent") == HOSTILE, "the name is shown as it is")
    insist(visitor.value("document.querySelectorAll('img[onerror], img[src=x]').length") == 0, "and makes no element")
    insist(HOSTILE in visitor.value(COMMAND), "the command quotes it")


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
            check_dropped_folder(visitor, clip, folder, work)
            check_resumed_upload(visitor, folder, work)
            done("uploads")
            check_looks(browser, address)
            done("looks")
            # Chromium logs every refusal, the inner folder of check_dropped_folder() too, and the connection that check_resumed_upload() breaks. A live source has no picture before its first frame, and its run none before it ends.
            errors = [text for text in browser.errors if not any(part in text for part in ("/api/live-frame", "/api/thumbnail", "photographs%2Finner", "ERR_CONNECTION_RESET"))]
            insist(not errors, f"the browser complains: {errors}")
            outside = [url for url in browser.requests if not url.startswith((address, "blob:" + address, "data:"))]
            insist(not outside, f"the page asks for {outside}")
    finally:
        stop_server(server)


def main():
    program, work = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    visit(program, work)


if __name__ == "__main__":
    main()
