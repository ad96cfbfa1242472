#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Takes the two pictures of docs/desk.md from the page of `moiregauge serve`, for tools/serve-pictures.

    page_pictures.py MOIREGAUGE WORK PICTURES
"""
import pathlib
import shutil
import subprocess
import sys
import time

from visitor import HTML, Browser, Visitor, button, entry, make_footage, start_server, stop_server


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


if __name__ == "__main__":
    made = pathlib.Path(sys.argv[2]).resolve()
    made.mkdir(parents=True)
    take_pictures(str(pathlib.Path(sys.argv[1]).resolve()), made, pathlib.Path(sys.argv[3]).resolve())
