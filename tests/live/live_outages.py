"""Fills the disk of a run, takes its broker away, and closes its source. Counts the rows that are lost."""
import json
import signal
import subprocess
import time

from live_sources import MotionJpeg, end_after_closings, serve_motion_jpeg
from mqtt_broker import Broker, Subscriber
from trial import FEW, FPS, MAX_LOST_S, Figures, finish, frames_of, insist, longest_gap, run, solve, start, stored_frames, table, whole_rows

DISK = "768k"
BROKER_S, AWAY_S = 10, 60  # with the broker (before and after), and without
CLOSINGS = 50
NS_PER_S = 1e9


def published_frames(errors):
    """Returns the frames in the rows of `--progress json`."""
    lines = [json.loads(line) for line in errors.splitlines() if line.startswith('{"type":"samples"')]
    return {sample[0] for line in lines for sample in line["marker"]["mid"]}


def fill_disk(trial, figures):
    small = trial.work / "small"
    small.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK}", "none", small], capture_output=True, check=False).returncode == 0
    insist(mounted, "this trial mounts a small tmpfs: run it as root")
    try:
        out = small / "out"
        errors = finish(trial.live(out, 1, "--progress", "json"), (6,))
        insist("frames are kept): free space and run again with --resume" in errors, errors)
        shown, unfinished = published_frames(errors), out.with_name("out.unfinished")
        kept = frames_of(solve(trial.program, unfinished, trial.work / "kept"))
        insist(shown and len(kept) == stored_frames(unfinished), "rows of the full disk")
        lost_s = (max(shown) - max(kept)) / FPS
        subprocess.run(["mount", "-o", "remount,size=64m", small], check=True)
        finish(trial.live(out, 1, "--resume", "--for", "10s"))
        final, rows = frames_of(table(out / "displacement.csv")), frames_of(table(out / "live.csv"))
        gap_s = max(longest_gap(final), longest_gap(rows)) / FPS
        figures.add("disk full: exit 6, <= 1 s of rows lost, continues with `--resume`",
                    f"exit 6 after {len(kept)} frames, {max(lost_s, 0):.2f} s of rows not kept; longest gap after `--resume` {gap_s:.2f} s",
                    lost_s <= MAX_LOST_S and gap_s <= MAX_LOST_S and set(kept) <= set(final) and trial.count_wrong(table(out / "displacement.csv")) == 0)
    finally:
        subprocess.run(["umount", small], check=True)


def take_broker_away(trial, figures):
    broker, away_s = Broker(trial.work), max(5, AWAY_S * trial.scale)
    broker.start()
    subscriber, out = Subscriber(broker.port, "bridge"), trial.work / "brokered"
    live = start(trial.live(out, 1, "--publish", f"mqtt://127.0.0.1:{broker.port}/bridge"), stderr=subprocess.PIPE)
    time.sleep(BROKER_S)
    before = len(subscriber.frames())
    broker.stop()
    time.sleep(away_s)
    broker.start()
    time.sleep(BROKER_S)
    live.send_signal(signal.SIGTERM)
    errors = live.communicate(timeout=60)[1]
    insist(live.returncode in (0, 5), f"exit {live.returncode}: {errors}")
    time.sleep(1)
    broker.stop()
    frames = frames_of(table(out / "live.csv"))
    missing = len(set(frames) - subscriber.frames())
    facts = json.loads((out / "live.json").read_text())
    unsent = sum(outlet["lost_rows"] for outlet in facts["outlets"])
    figures.add(f"broker away for {AWAY_S} s: <= 1 s of rows lost",
                f"{missing} of {len(frames)} rows did not arrive ({before} came before), {unsent} lost as counted, "
                f"longest gap {longest_gap(frames) / FPS:.2f} s, {facts['lost_frames']['queue_full']} frames lost",
                before > 0 and missing <= MAX_LOST_S * FPS and longest_gap(frames) <= MAX_LOST_S * FPS and unsent == 0)


def close_source(trial, figures):
    pictures, closings = trial.work / "jpeg", max(3, round(CLOSINGS * trial.scale))
    pictures.mkdir()
    run(["ffmpeg", "-v", "error", "-i", trial.frames / "%06d.png", "-frames:v", 10, "-q:v", 1, "-pix_fmt", "yuvj420p", pictures / "%02d.jpg"])
    server, out = serve_motion_jpeg([path.read_bytes() for path in sorted(pictures.iterdir())]), trial.work / "closed"
    live = start([trial.program, "live", f"http://127.0.0.1:{server.server_port}/", "--site", trial.site, "--patience", "5s", "-o", out, "--quiet"],
                 stderr=subprocess.PIPE)
    errors = end_after_closings(server, live, closings)
    insist(live.returncode == 7 and "the stream was lost" in errors, f"exit {live.returncode}: {errors}")
    facts, rows = json.loads((out / "live.json").read_text()), whole_rows(out / "live.csv")
    at_ns = sorted({int(row["utc_ns"]) for row in rows})
    gap_s = max((b - a) / NS_PER_S for a, b in zip(at_ns, at_ns[1:]))
    lost_s = (MotionJpeg.sent - facts["frames"] - facts["lost_frames"]["starting"]) / MotionJpeg.FPS / closings
    figures.add(f"source closed {CLOSINGS} times: <= 1 s of rows lost each, connects again, exit 7 when it stays away",
                f"{facts['reconnects']} new connections, exit 7; {MotionJpeg.sent} frames sent, {facts['frames']} measured "
                f"({lost_s:.2f} s lost each), longest time between rows {gap_s:.2f} s",
                facts["reconnects"] >= closings - 1 and lost_s <= MAX_LOST_S and gap_s <= MAX_LOST_S and
                frames_of(table(out / "displacement.csv")) == frames_of(rows))


def outages(trial):
    """Disk full, broker away, source closed"""
    trial.clip(max(3 * FEW, int((2 * BROKER_S + AWAY_S + 15) * FPS)))
    figures = Figures()
    fill_disk(trial, figures)
    take_broker_away(trial, figures)
    close_source(trial, figures)
    return figures
