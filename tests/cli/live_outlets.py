#!/usr/bin/python3
"""Tests sources and outlets of `moiregauge live`: a pipe, a camera and a stream on the loopback interface, alarms.

    live_outlets.py MOIREGAUGE WORK SOURCE FAKE_CAMERA

The environment variable CLOSINGS is the number of times that the stream closes (default 3).
"""
import csv
import json
import os
import pathlib
import subprocess
import sys

from live_sources import FakeCamera, difference_of, end_after_closings, serve_motion_jpeg, table
from runs import insist, rows, run, simulate, start

program, work, _ = start()
fake_camera = pathlib.Path(sys.argv[4])
FPS = 10
simulate(program, work / "scene", "small-1x", 60)
scene, site = work / "scene/frames", work / "scene/site.toml"
TRUTH_FILE = work / "scene/truth.csv"
with open(TRUTH_FILE, newline="") as file:
    TRUTH = {int(row["frame"]): row for row in csv.DictReader(file)}


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
    measured = table(work / "recording/displacement.csv")
    # The reference frame, 1 s before the alarm, the alarm, 1 s after it.
    insist(len(measured) == 1 + 2 * FPS + 1 or len(measured) == 2 * FPS + 1, f"{len(measured)} frames are recorded")
    largest, bad = difference_of(measured, table(out / "displacement.csv"))
    insist(not bad, f"not ok: {bad}")
    insist(largest <= 1, f"a row of the recording differs by {largest} u")


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
    serial, lost_share = f"T{os.getpid()}", 0.01
    camera = FakeCamera(fake_camera, serial, 24, lost_share)
    out = work / "camera"
    run([program, "live", f"camera:Aravis-{serial}", "--sensor-region", "0,0,1024,512", "--fps", 20, "--packet-size", 9000, "--site", site,
         "--for", "4s", "-o", out, "--quiet"])
    camera.end()
    facts = json.loads((out / "live.json").read_text())
    samples = table(out / "displacement.csv")
    lost = facts["lost_frames"]
    insist(lost["incomplete"] > 0, f"no incomplete frame at {lost_share} lost packets: {lost}")
    insist(facts["settings"]["sensor_region_px"] == "0,0,1024,512", f"settings: {facts['settings']}")
    numbers = [int(row["frame"]) for row in samples]
    insist(numbers[-1] + 1 <= len(numbers) + sum(lost.values()), f"{numbers[-1] + 1} frames, {len(numbers)} measured, lost {lost}")
    ok = sum(row["status"] == "ok" for row in samples)
    insist(ok >= 10, f"only {ok} rows are ok")
    # 6 u: of some hundred values the largest is 3 to 4 u.
    insist(camera.count_wrong(samples, 6) == 0, "rows are wrong: a frame was measured that is not whole")


def a_stream_that_closes_is_opened_again_and_one_that_stays_away_ends_the_run(closings):
    pictures = work / "jpeg"
    pictures.mkdir()
    run(["ffmpeg", "-v", "error", "-i", scene / "%06d.png", "-frames:v", 10, "-q:v", 1, "-pix_fmt", "yuvj420p", pictures / "%02d.jpg"])
    server = serve_motion_jpeg([path.read_bytes() for path in sorted(pictures.iterdir())])
    out = work / "stream"
    command = [program, "live", f"http://user:secret@127.0.0.1:{server.server_port}/", "--site", site, "--patience", "2s", "-o", out, "--quiet"]
    live = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE, text=True)
    errors = end_after_closings(server, live, closings)
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
