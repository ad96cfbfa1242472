#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs all commands of docs/how-do-i.md in page order: how_do_i.py MOIREGAUGE PAGE.

A command is one line of a ```sh fence. All run in one temporary folder, with the program as `moiregauge` in the path. A command must
end with 0, or with the code of its trailing comment `# exit N`. The first one that does not ends the test, with its exit code and
stderr. Fences of other languages are not run.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

MAX_SECONDS = 300  # per command: instrumented builds are slow
EXIT = re.compile(r"\s# exit (\d+)$")


def commands_of(page):
    """Returns (line number, command) of every line in a ```sh fence."""
    commands, language = [], None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```"):
            language = line[3:].strip() if language is None else None
        elif language == "sh" and line.strip() and not line.startswith("#"):
            commands.append((number, line))
    if language is not None:
        sys.exit(f"error: a fence is not closed: {page}: add ```")
    if not commands:
        sys.exit(f"error: the page has no commands: {page}: put them into ```sh fences")
    return commands


def run(command, work, path):
    """Returns what is wrong with the command, or nothing."""
    expected = EXIT.search(command)
    code = int(expected[1]) if expected else 0
    try:
        done = subprocess.run(["bash", "-c", command], cwd=work, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                              timeout=MAX_SECONDS, env={**os.environ, "PATH": path, "LC_ALL": "C.UTF-8"})
    except subprocess.TimeoutExpired:
        return f"no end after {MAX_SECONDS} s"
    return "" if done.returncode == code else f"exit {done.returncode}, not {code}\n{done.stderr}"


def main():
    program, page = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    commands = commands_of(page)
    with tempfile.TemporaryDirectory(prefix="moiregauge-how-do-i-") as folder:
        tools, work = pathlib.Path(folder) / "bin", pathlib.Path(folder) / "work"
        tools.mkdir()
        work.mkdir()
        (tools / "moiregauge").symlink_to(program)
        for number, command in commands:
            begin = time.monotonic()
            problem = run(command, work, f"{tools}:{os.environ['PATH']}")
            print(f"{time.monotonic() - begin:6.1f} s  {command}", flush=True)
            if problem:
                sys.exit(f"error: a command of the page fails: {page.name}:{number}: {command}: {problem}")
    print(f"{len(commands)} commands")


if __name__ == "__main__":
    main()
