#!/usr/bin/python3
"""Tests the progress display of a terminal, and Ctrl-C: terminal.py MOIREGAUGE WORK.

`simulate` has far more frames than time. After two seconds a terminal shows the progress and the remaining time. With
--quiet, or if stderr is no terminal, nothing is shown. Ctrl-C stops the command with one line and exit 130, without
truth.csv, which marks a complete folder. The same command then starts again. tests/survival tests stopped runs of
`measure`.
"""
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import time

LONG = ["simulate", "small-1xyz", "--frames", "20000", "-o", "run"]


def until(condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


class OnATerminal:
    """A command with a terminal as stderr, which is read continuously."""

    def __init__(self, words, work):
        self.master, terminal = pty.openpty()
        self.process = subprocess.Popen(words, cwd=work, stdout=subprocess.DEVNULL, stderr=terminal)
        os.close(terminal)
        os.set_blocking(self.master, False)
        self.shown = ""

    def look(self):
        try:
            self.shown += os.read(self.master, 65536).decode()
        except (BlockingIOError, OSError):
            pass
        return self.shown

    def interrupted(self):
        """Sends SIGINT. Returns the exit code and all that was shown."""
        self.process.send_signal(signal.SIGINT)
        assert until(lambda: self.look() is not None and self.process.poll() is not None, 60), "it does not stop"
        self.look()
        return self.process.returncode, self.shown


def simulate(program, work):
    shown = OnATerminal([program, *LONG], work)
    assert until(lambda: re.search(r"simulating \[#*\.*\] \d+/20000 frames, [0-9.]+ fps, \d+ s left", shown.look()), 60), shown.shown
    code, text = shown.interrupted()
    assert code == 130, code
    line = re.search(r"error: stopped at frame \d+ of 20000: run is incomplete: repeat the command to start again", text)
    assert line, text
    assert not (work / "run/truth.csv").exists()
    again = subprocess.run([program, "simulate", "small-1xyz", "--frames", "4", "--markers-only", "-o", "run"], cwd=work,
                           capture_output=True, text=True, check=False)
    assert again.returncode == 0 and not again.stderr, again.stderr
    assert (work / "run/truth.csv").exists() and len(list((work / "run/frames").iterdir())) == 4


def quiet(program, work):
    shown = OnATerminal([program, *LONG[:-1], "quiet", "--quiet"], work)
    assert not until(lambda: shown.look() or shown.process.poll() is not None, 3.5), shown.shown
    code, text = shown.interrupted()
    assert code == 130 and text.strip().startswith("error: stopped") and text.count("\n") == 1, text


def no_terminal(program, work):
    process = subprocess.Popen([program, *LONG[:-1], "pipe"], cwd=work, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(3.5)
    process.send_signal(signal.SIGINT)
    _, shown = process.communicate(timeout=60)
    assert process.returncode == 130 and re.fullmatch(r"error: stopped at frame \d+ of 20000: [^\n]*\n", shown), shown


def main():
    program, work = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    for check in [simulate, quiet, no_terminal]:
        check(program, work)
        shutil.rmtree(work / "quiet", ignore_errors=True)
    shutil.rmtree(work)


if __name__ == "__main__":
    main()
