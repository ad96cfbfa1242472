# SPDX-License-Identifier: Apache-2.0
"""A visitor of the page of `moiregauge serve` in headless Chromium: mouse, keyboard, elements, footage and server."""
import csv
import json
import pathlib
import shutil
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
from browser import Browser  # noqa: E402, F401

FRAMES = 48
DELAY_S = 0.35  # the other sensor's clock minus the camera's
HTML = "document.documentElement"
COMMAND = "document.querySelector('.setup .command code').textContent"


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
