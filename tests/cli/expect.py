#!/usr/bin/python3
"""Runs one command in an empty directory and compares exit code, output and files with the expected ones.

    expect.py --work DIR --exit N [--setup SHELL] [--stdout REGEX]... [--stderr REGEX]... [--error-lines N]
              [--writes PATH]... [--leaves-out PATH]... -- COMMAND ARGUMENTS...
--work        directory; it is emptied, and --setup and the command run in it
--stdout/err  a Python regular expression that must be found (^ and $ match at lines)
--error-lines number of lines of stderr that start with `error: `
--writes      path below DIR that must exist and not be empty;  --leaves-out path below DIR that must not exist
A process that a sanitizer stopped never counts as expected.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--exit", required=True, type=int)
    parser.add_argument("--setup", default="")
    parser.add_argument("--error-lines", type=int)
    for many in ["--stdout", "--stderr", "--writes", "--leaves-out"]:
        parser.add_argument(many, action="append", default=[])
    parser.add_argument("command", nargs="+")
    return parser.parse_args()


def disagreements(wanted, done):
    if done.returncode != wanted.exit:
        yield f"exit code {done.returncode}, expected {wanted.exit}"
    if re.search(r"AddressSanitizer|LeakSanitizer|runtime error:", done.stderr):
        yield "a sanitizer spoke"
    for stream, patterns in [("stdout", wanted.stdout), ("stderr", wanted.stderr)]:
        for pattern in patterns:
            if not re.search(pattern, getattr(done, stream), re.MULTILINE):
                yield f"{stream} does not match: {pattern}"
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    if wanted.error_lines is not None and len(errors) != wanted.error_lines:
        yield f"{len(errors)} lines on stderr start with 'error: ', expected {wanted.error_lines}"
    for name in wanted.writes:
        path = wanted.work / name
        if not path.exists() or (path.is_file() and path.stat().st_size == 0):
            yield f"missing or empty: {name}"
    for name in wanted.leaves_out:
        if (wanted.work / name).exists():
            yield f"should not be there: {name}"


def main():
    wanted = arguments()
    shutil.rmtree(wanted.work, ignore_errors=True)
    wanted.work.mkdir(parents=True)
    if wanted.setup:
        subprocess.run(["bash", "-euo", "pipefail", "-c", wanted.setup], cwd=wanted.work, check=True)
    done = subprocess.run(wanted.command, cwd=wanted.work, capture_output=True, text=True, errors="replace",
                          stdin=subprocess.DEVNULL, check=False)
    wrong = list(disagreements(wanted, done))
    if wrong:
        print("command:", *wanted.command)
        print("--- stdout ---", done.stdout, "--- stderr ---", done.stderr, "--- wrong ---", *wrong, sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
