"""Raises alarms in a replayed recording. Measures the delay to the broker, and measures the alarms' recordings."""
import signal
import subprocess
import time

from live_sources import difference_of
from mqtt_broker import Broker, Subscriber
from trial import FEW, Figures, finish, insist, shown_frame, start, table

FPS, SECONDS = 42, 60
LEVEL_MM, RELEASE_MM, HOLD_S = 1.275, 1.125, 0.2  # between two steps of the movement, so that noise decides nothing
CLEAR_S = 1.0  # as the program requires
MAX_PERIODS = 2
NS_PER_S = 1e9


def due_frames(trial, frames):
    """Returns the frames in which the true movement raises an alarm (docs/cli/live.md, "Alarms")."""
    due, since, is_raised = [], None, False
    for n in range(frames):
        moved_mm = trial.truth[shown_frame(n, FEW)][1] - trial.truth[0][1]
        would_change = moved_mm <= RELEASE_MM if is_raised else moved_mm > LEVEL_MM
        if not would_change:
            since = None
            continue
        since = n if since is None else since
        if (n - since) / FPS >= (CLEAR_S if is_raised else HOLD_S) - 1e-6:
            if not is_raised:
                due.append(n)
            since, is_raised = None, not is_raised
    return due


def alarm(trial):
    """Alarms and their recordings"""
    frames = FPS * (SECONDS + 10)
    trial.clip(frames)
    broker = Broker(trial.work)
    broker.start()
    subscriber, out = Subscriber(broker.port, "bridge"), trial.work / "alarmed"
    words = trial.live(out, 1, "--publish", f"mqtt://127.0.0.1:{broker.port}/bridge", "--alarm", f"mid.dy > {LEVEL_MM} mm for {HOLD_S} s until {RELEASE_MM} mm",
                       "--record", "1s")
    words[words.index("--fps") + 1] = str(FPS)
    live = start(words, stderr=subprocess.PIPE)
    time.sleep(max(15, SECONDS * trial.scale))
    live.send_signal(signal.SIGTERM)
    errors = live.communicate(timeout=60)[1]
    insist(live.returncode in (0, 5), f"exit {live.returncode}: {errors}")
    utc_ns = {int(row["frame"]): int(row["utc_ns"]) for row in table(out / "live.csv")}
    raised = [(at, message) for at, message in subscriber.below("alarm") if message.get("state") == "raised"]
    due = [frame for frame in due_frames(trial, max(utc_ns)) if frame in utc_ns]
    late = [(at - utc_ns[frame]) / NS_PER_S * FPS for frame, (at, _) in zip(due, raised)]
    frames_off = max((abs(frame - message["frame"]) for frame, (_, message) in zip(due, raised)), default=0)
    figures = Figures()
    figures.add(f"an alarm fires within {MAX_PERIODS} frame periods", f"{len(raised)} alarms at {FPS} frames/s, {len(due)} due; at the broker after "
                f"{max(late, default=99):.2f} periods at most ({1000 * max(late, default=99) / FPS:.1f} ms), at most {frames_off} frames from the true one",
                len(raised) == len(due) > 1 and max(late) <= MAX_PERIODS)
    largest, bad, rows = 0.0, 0, 0
    recordings = sorted((trial.work / "alarmed-alarms").glob("*.mkv"))
    for recording in recordings:
        finish([trial.program, "measure", recording, "--site", trial.site, "-o", trial.work / recording.stem, "--quiet"])
        measured = table(trial.work / recording.stem / "displacement.csv")
        difference, not_ok = difference_of(measured, table(out / "displacement.csv"))
        largest, bad, rows = max(largest, difference), bad + len(not_ok), rows + len(measured)
    broker.stop()
    figures.add("its recording measures to the same rows (within u)",
                f"{len(recordings)} recordings, {rows} rows, {bad} not ok, largest difference {largest:.2f} u",
                len(recordings) == len(raised) and bad == 0 and largest <= 1)
    return figures
