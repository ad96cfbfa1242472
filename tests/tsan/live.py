#!/usr/bin/env python3
"""Runs `moiregauge live` under the thread sanitizer.

    live.py MOIREGAUGE WORK_DIR

The frame path, the thread that solves scenes, all outlets, the alarm's recording and the files run at the same time. A race ends the
program with exit code 66.
"""
import atexit
import http.server
import json
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request

from races import Races

program, work = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(work, ignore_errors=True)
work.mkdir(parents=True)
insist = Races(work).insist
FRAMES, LOOPS = 8, 1600  # 1280 s at 10 frames/s: longer than the longest wait


def run(*words, expected=0, **more):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **more)
    insist(done.returncode == expected, f"exit {done.returncode}, expected {expected}: {words}\n{done.stdout}{done.stderr}")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Live:
    """A run of `live` whose output is collected, so that it never waits for this script."""

    def __init__(self, *words, stdin=None):
        self.process = subprocess.Popen([program, "live", *map(str, words)], stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # after a failed check
        self.out, self.err = [], []
        self.readers = [threading.Thread(target=lines.extend, args=(stream,), daemon=True)
                        for lines, stream in ((self.out, self.process.stdout), (self.err, self.process.stderr))]
        for reader in self.readers:
            reader.start()

    def until(self, condition, what, seconds=1200):
        """Waits. That can be long: the thread that solves has a low priority, and rests for nine times as long as it solved."""
        end = time.monotonic() + seconds
        while not condition():
            insist(self.process.poll() is None, f"the run ended before {what}: exit {self.process.returncode}\n{''.join(self.err)}")
            insist(time.monotonic() < end, f"not within {seconds} s: {what}\n{''.join(self.err)}")
            time.sleep(0.02)

    def newest(self):
        newest = next((line for line in reversed(self.out) if line.startswith('{"type":"frame"')), '{"scenes": 0}')
        return json.loads(newest)

    def end(self, number=signal.SIGINT, expected=(0, 4, 5)):
        """Ends the run and returns its exit code. 4 and 5: no row or few rows are ok, because the clip repeats itself and the first scene
        takes long here."""
        if number is not None:
            self.process.send_signal(number)
        self.process.wait(1200)
        for reader in self.readers:
            reader.join()
        insist(self.process.returncode in expected, f"exit {self.process.returncode}\n{''.join(self.err)}")
        return self.process.returncode


class Peer(http.server.BaseHTTPRequestHandler):
    """Receives line protocol, and sends a stream of frames. Both fail again and again, so that the program tries again."""
    requests = connections = 0
    frames = []

    def do_POST(self):
        self.rfile.read(int(self.headers["Content-Length"]))
        Peer.requests += 1
        self.send_response(503 if Peer.requests % 3 == 0 else 204)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def do_GET(self):
        Peer.connections += 1
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace;boundary=frame")
        self.end_headers()
        try:
            for jpeg in self.frames * 3:
                self.wfile.write(b"--frame\r\nContent-type: image/jpeg\r\nContent-length: %d\r\n\r\n" % len(jpeg) + jpeg + b"\r\n")
                time.sleep(0.1)
        except OSError:
            pass

    def log_message(self, *_):
        pass


def started_peer():
    peer = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Peer)
    threading.Thread(target=peer.serve_forever, daemon=True).start()
    return peer


def poll(url, stop):
    while not stop.is_set():
        try:
            urllib.request.urlopen(url, timeout=5).read()
        except OSError:  # before it listens, and after the end
            time.sleep(0.05)


def all_outlets_until_ctrl_c():
    peer = started_peer()
    mqtt, metrics, stop = free_port(), free_port(), threading.Event()
    for _ in range(3):
        threading.Thread(target=poll, args=(f"http://127.0.0.1:{metrics}/metrics", stop), daemon=True).start()
    live = Live(clip, "--site", site, "--pace", 1, "-o", work / "outlets", "--json", "--progress", "json", "--preview", work / "newest.jpg",
                "--listen", f"127.0.0.1:{metrics}", "--publish", f"influx:{work / 'rows.lp'}", "--publish",
                f"influx+http://127.0.0.1:{peer.server_port}/write", "--publish", f"mqtt://127.0.0.1:{mqtt}/bridge", "--alarm", ALARM,
                "--record", "1s")
    live.until(lambda: live.newest()["scenes"] >= 1, "the first scene")
    # The broker is absent at first, present for a while, and then away again.
    broker = subprocess.Popen(["mosquitto", "-p", str(mqtt)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    atexit.register(broker.kill)
    published = live.newest()["frames"]
    live.until(lambda: live.newest()["frames"] >= published + 50, "50 frames with a broker")
    live.until(lambda: live.newest()["scenes"] >= 2, "the second scene")  # it replaces the first one while frames are measured
    live.until(lambda: list((work / "outlets-alarms").glob("*.mkv")), "a recording of an alarm")
    broker.kill()
    broker.wait()
    live.end()
    stop.set()
    peer.shutdown()
    facts = json.loads((work / "outlets/live.json").read_text())
    insist({outlet["name"] for outlet in facts["outlets"]} >= {"mqtt", "influx", "metrics"}, facts["outlets"])
    insist(Peer.requests > 3, f"{Peer.requests} requests of InfluxDB")


def rows(folder):
    path = folder / "live.csv"
    return path.read_text().count("\n") if path.exists() else 0


def segments_are_finished_while_the_next_one_grows():
    """Also after a kill that leaves two unfinished segments: both are finished in the background of the resumed run."""
    folder = work / "segments"
    words = [clip, "--site", site, "--pace", 2, "--segment", "3s", "--quota", "1GB", "-o", folder, "--quiet"]
    live = Live(*words)

    def two_are_unfinished():
        unfinished = [path for path in folder.glob("*.unfinished") if rows(path) > 3]
        return len(unfinished) >= 2
    live.until(two_are_unfinished, "two unfinished segments")
    live.end(signal.SIGKILL, expected=(-signal.SIGKILL,))
    before = {path.name for path in folder.glob("*.unfinished")}
    live = Live(*words, "--resume")
    live.until(lambda: len([path for path in folder.glob("segment-??????")]) >= 3, "three finished segments")
    live.end(signal.SIGTERM)
    insist(not list(folder.glob("*.unfinished")), f"unfinished segments are left of {before}")


def a_pipe_and_a_stream():
    feed = subprocess.Popen(["ffmpeg", "-nostdin", "-loglevel", "error", "-i", clip, "-frames:v", "40", "-pix_fmt", "gray", "-f", "yuv4mpegpipe",
                             "-strict", "-1", "-"], stdout=subprocess.PIPE)
    Live("-", "--site", site, "-o", work / "pipe", "--quiet", stdin=feed.stdout).end(None)
    feed.wait()
    (work / "jpeg").mkdir()
    run("ffmpeg", "-nostdin", "-loglevel", "error", "-i", work / "scene/video.mp4", "-q:v", 1, "-pix_fmt", "yuvj420p", work / "jpeg/%02d.jpg")
    Peer.frames = [path.read_bytes() for path in sorted((work / "jpeg").iterdir())]
    peer = started_peer()
    live = Live(f"http://127.0.0.1:{peer.server_port}/", "--site", site, "--patience", "60s", "-o", work / "stream", "--json")
    live.until(lambda: Peer.connections >= 3 and live.newest()["scenes"] >= 1, "a scene and two lost connections")
    live.end()
    peer.shutdown()


def frames_that_wait():
    run(program, "live", clip, "--site", site, "--pace", "max", "--for", "4s", "--segment", "1s", "-o", work / "waiting", "--quiet")


# One thread: frames that oneTBB passes from thread to thread seem to race, because it is not built with the sanitizer.
run(program, "simulate", "small-1x", "--frames", FRAMES, "--markers-only", "--codec", "x264", "--quality", 12, "--threads", 1, "--quiet", "-o", work / "scene")
site, clip = work / "scene/site.toml", work / "clip.mp4"
run("ffmpeg", "-nostdin", "-loglevel", "error", "-stream_loop", LOOPS - 1, "-i", work / "scene/video.mp4", "-c", "copy", clip)
ALARM = "mid.dy > 0.2 mm for 0.2 s"
for test in all_outlets_until_ctrl_c, segments_are_finished_while_the_next_one_grows, a_pipe_and_a_stream, frames_that_wait:
    begin = time.monotonic()
    test()
    insist(True, test.__name__)
    print(f"{test.__name__}: {time.monotonic() - begin:.1f} s", flush=True)
