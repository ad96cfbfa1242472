#!/usr/bin/python3
"""Tests sources and outlets of `moiregauge live`: a pipe, a camera and a stream on the loopback interface, alarms.

    live_outlets.py MOIREGAUGE WORK SOURCE FAKE_CAMERA

The environment variable CLOSINGS is the number of times that the stream closes (default 3).
"""
import csv
import http.server
import json
import os
import pathlib
import subprocess
import sys
import threading
import time

from runs import insist, rows, run, simulate, start

program, work, _ = start()
fake_camera = pathlib.Path(sys.argv[4])
FPS = 10
simulate(program, work / "scene", "small-1x", 60)
scene, site = work / "scene/frames", work / "scene/site.toml"
TRUTH_FILE = work / "scene/truth.csv"
with open(TRUTH_FILE, newline="") as file:
    TRUTH = {int(row["frame"]): row for row in csv.DictReader(file)}


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def an_alarm_fires_and_its_recording_measures_to_the_same_rows():
    out, lines = work / "alarmed", work / "rows.lp"
    level_mm, hold_s = 1.3, 0.2  # reached after the first scene is solved, until then rows are untrusted
    done = run([program, "live", scene, "--site", site, "--fps", FPS, "--pace", "max", "-o", out, "--alarm",
                f"mid.dy > {level_mm} mm for {hold_s} s", "--record", "1s", "--publish", f"influx:{lines}"])
    alarms = table(work / "alarmed-alarms/alarms.csv")
    insist(len(alarms) == 1 and alarms[0]["state"] == "raised", f"one alarm is raised: {alarms}")
    first = min(frame for frame, row in TRUTH.items() if float(row["dy_mm"]) > level_mm)
    due = first + round(hold_s * FPS)
    insist(due <= int(alarms[0]["frame"]) <= due + 2, f"raised in frame {alarms[0]['frame']}, due in {due}")
    insist("alarm raised: mid.dy > 1.3 mm for 0.2 s" in done.stderr, "stderr states the alarm")
    written = lines.read_text().splitlines()
    insist(sum(line.startswith("moiregauge,marker=mid") for line in written) == 60, "one line per row")
    insist(sum(line.startswith("moiregauge_alarm") for line in written) == 1, "one line per alarm")
    recordings = list((work / "alarmed-alarms").glob("*.mkv"))
    insist(len(recordings) == 1, f"one recording: {recordings}")
    run([program, "measure", recordings[0], "--site", site, "-o", work / "recording", "--quiet"])
    live = {round(float(row["time_s"]), 3): row for row in table(out / "displacement.csv")}
    measured = table(work / "recording/displacement.csv")
    # The reference frame, 1 s before the alarm, the alarm, 1 s after it.
    insist(len(measured) == 1 + 2 * FPS + 1 or len(measured) == 2 * FPS + 1, f"{len(measured)} frames are recorded")
    for row in measured:
        same = live[round(float(row["time_s"]), 3)]
        insist(row["status"] == "ok", f"not ok: {row}")
        for axis in "dx_mm", "dy_mm":
            # Both runs see the same pixels of the markers. Only the key frames of their scenes differ, which is part of u.
            difference = abs(float(row[axis]) - float(same[axis]))
            insist(difference <= float(same["u_" + axis]) + 1e-6, f"{axis} differs by {difference}: {row}, {same}")


def a_pipe_measures_to_the_rows_of_its_file():
    y4m = work / "clip.y4m"
    run(["ffmpeg", "-v", "error", "-framerate", FPS, "-i", scene / "%06d.png", "-pix_fmt", "gray", "-strict", "-1", y4m])
    run([program, "measure", y4m, "--site", site, "-o", work / "of-file", "--quiet"])
    with open(y4m, "rb") as stream:
        done = subprocess.run([program, "live", "-", "--site", site, "-o", work / "of-pipe", "--quiet"], stdin=stream, capture_output=True,
                              text=True, check=False)
    insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
    insist(rows(work / "of-pipe") == rows(work / "of-file"), "a pipe gives other rows than its file")


def every_complete_frame_of_a_camera_is_measured():
    serial, images, lost_share = f"T{os.getpid()}", 24, 0.01
    camera = subprocess.Popen([fake_camera, serial, str(images), str(lost_share)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    truth = []
    for line in camera.stdout:
        words = line.split()
        if words[0] != "truth":
            break
        truth.append((float(words[2]), float(words[3])))
    out = work / "camera"
    run([program, "live", f"camera:Aravis-{serial}", "--sensor-region", "0,0,1024,512", "--fps", 20, "--packet-size", 9000, "--site", site,
         "--for", "4s", "-o", out, "--quiet"])
    camera.stdin.close()
    camera.wait(timeout=20)
    facts = json.loads((out / "live.json").read_text())
    samples = table(out / "displacement.csv")
    lost = facts["lost_frames"]
    insist(lost["incomplete"] > 0, f"no incomplete frame at {lost_share} lost packets: {lost}")
    insist(facts["settings"]["sensor_region_px"] == "0,0,1024,512", f"settings: {facts['settings']}")
    numbers = [int(row["frame"]) for row in samples]
    insist(numbers[-1] + 1 <= len(numbers) + sum(lost.values()), f"{numbers[-1] + 1} frames, {len(numbers)} measured, lost {lost}")
    # The images repeat, and the first one is unknown. For one of them, every ok row must be true. 6 u: of some hundred
    # values the largest is 3 to 4 u.
    def is_true(first):
        for row in samples:
            now, then = truth[(first + int(row["frame"])) % images], truth[(first + numbers[0]) % images]
            for axis, index in ("dx_mm", 0), ("dy_mm", 1):
                u = float(row["u_" + axis])
                if row["status"] == "ok" and u > 0 and abs(float(row[axis]) - (now[index] - then[index])) > 6 * u:
                    return False
        return True
    ok = sum(row["status"] == "ok" for row in samples)
    insist(ok >= 10, f"only {ok} rows are ok")
    insist(any(is_true(first) for first in range(images)), "rows are wrong: a frame was measured that is not whole")


class MotionJpeg(http.server.BaseHTTPRequestHandler):
    """Sends ten frames per connection at 20 frames/s, and closes it."""
    frames = []
    connections = 0

    def do_GET(self):
        type(self).connections += 1
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace;boundary=ffmpeg")
        self.end_headers()
        try:
            for jpeg in self.frames[:10]:
                self.wfile.write(b"--ffmpeg\r\nContent-type: image/jpeg\r\nContent-length: %d\r\n\r\n" % len(jpeg) + jpeg + b"\r\n")
                time.sleep(0.05)
        except OSError:
            pass

    def log_message(self, *_):
        pass


def a_stream_that_closes_is_opened_again_and_one_that_stays_away_ends_the_run(closings):
    pictures = work / "jpeg"
    pictures.mkdir()
    run(["ffmpeg", "-v", "error", "-i", scene / "%06d.png", "-frames:v", 10, "-q:v", 1, "-pix_fmt", "yuvj420p", pictures / "%02d.jpg"])
    MotionJpeg.frames = [path.read_bytes() for path in sorted(pictures.iterdir())]
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), MotionJpeg)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    out = work / "stream"
    command = [program, "live", f"http://user:secret@127.0.0.1:{server.server_port}/", "--site", site, "--patience", "2s", "-o", out, "--quiet"]
    live = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE, text=True)
    begin = time.monotonic()
    while MotionJpeg.connections <= closings and time.monotonic() - begin < 10 + 3 * closings:
        time.sleep(0.05)
    server.shutdown()
    server.server_close()
    _, errors = live.communicate(timeout=60)
    insist(live.returncode == 7, f"exit {live.returncode}: {errors}")
    insist("the stream was lost" in errors and "secret" not in errors, errors)
    facts = json.loads((out / "live.json").read_text())
    insist(facts["reconnects"] >= closings - 1, f"{facts['reconnects']} reconnects after {closings} closed connections")
    insist(facts["end"] == "source lost", facts["end"])
    for path in out.iterdir():
        insist(b"secret" not in path.read_bytes(), f"{path} contains the password")


an_alarm_fires_and_its_recording_measures_to_the_same_rows()
a_pipe_measures_to_the_rows_of_its_file()
every_complete_frame_of_a_camera_is_measured()
a_stream_that_closes_is_opened_again_and_one_that_stays_away_ends_the_run(int(os.environ.get("CLOSINGS", "3")))
