"""Measures Aravis's fake camera on the loopback interface, with and without lost packets, and compares its rows with the truth."""
import json
import os

from live_sources import FakeCamera
from trial import MAX_U, Figures, finish, table

IMAGES, FPS, SECONDS = 48, 50, 300
LOST_SHARES = (0.0, 0.01)


def measure_camera(trial, lost_share):
    """Returns the rows, the facts of live.json, and the number of wrong rows."""
    serial = f"T{os.getpid()}"
    camera = FakeCamera(trial.neighbour("fake_camera"), serial, IMAGES, lost_share)
    out = trial.work / f"camera-{lost_share}"
    site = trial.work / "few/site.toml"
    finish([trial.program, "live", f"camera:Aravis-{serial}", "--sensor-region", "0,0,2048,1024", "--fps", FPS, "--packet-size", 9000,
            "--site", site, "--for", f"{max(5, round(SECONDS * trial.scale))}s", "-o", out, "--quiet"])
    camera.end()
    final, published = table(out / "displacement.csv"), table(out / "live.csv")
    wrong = camera.count_wrong(final, MAX_U) + camera.count_wrong(published, MAX_U)
    return final, json.loads((out / "live.json").read_text()), wrong


def camera(trial):
    """2048 x 1024 px from a GigE Vision camera"""
    trial.clip(1)  # for its site
    figures = Figures()
    for lost_share in LOST_SHARES:
        samples, facts, wrong = measure_camera(trial, lost_share)
        lost = facts["lost_frames"]
        sent = int(samples[-1]["frame"]) + 1
        # Frames after the last measured one may be lost too.
        surplus = len(samples) + sum(lost.values()) - sent
        ok = sum(row["status"] == "ok" for row in samples)
        figures.add(f"GigE Vision, 2048 x 1024 px at {FPS} frames/s for {SECONDS} s, {100 * lost_share:.0f} % of packets lost: every complete frame "
                    "measured, incomplete ones counted",
                    f"{len(samples)} of {sent} frames measured, {lost['incomplete']} incomplete, {lost['queue_full']} lost in the queue, "
                    f"{lost['in_camera']} missing, {lost['starting']} while starting",
                    lost["queue_full"] == 0 and 0 <= surplus <= FPS and (lost["incomplete"] > 0 or lost_share == 0))
        figures.add("0 wrong rows", f"{wrong} wrong ({ok} of {len(samples)} ok)", wrong == 0 and 2 * ok > len(samples))
    return figures
