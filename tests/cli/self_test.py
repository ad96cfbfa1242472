#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks `moiregauge --self-test`: self_test.py MOIREGAUGE. It passes, and it fails where no file can be written."""
import os
import re
import resource
import subprocess
import sys
import tempfile


def self_test(program, folder, limit=None):
    def limited():
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return subprocess.run([program, "--self-test"], env={**os.environ, "TMPDIR": folder}, capture_output=True, text=True, check=False,
                          preexec_fn=limited)


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="moiregauge-") as folder:
        done = self_test(program, folder)
        assert done.returncode == 0, done.stderr
        figures = re.fullmatch(r"self-test passed: moiregauge [0-9.]+ measured 20 frames of a video, 19 samples ok, "
                               r"largest error (0\.00\d\d) mm \(([0-9.]+) u\)\n", done.stdout)
        assert figures and float(figures[1]) > 0 and 0 < float(figures[2]) < 5, done.stdout
        assert os.listdir(folder) == [], "files are left"
        done = self_test(program, os.path.join(folder, "nowhere"))
        assert done.returncode == 1 and re.fullmatch(r"error: the self-test failed: .*set TMPDIR.*\n", done.stderr), done.stderr
        done = self_test(program, folder, limit=100_000)  # less than the video
        assert done.returncode == 1 and done.stderr.startswith("error: the self-test failed: "), done.stderr
        assert done.stderr.count("\n") == 1 and done.stdout == "", done.stderr
        assert os.listdir(folder) == [], "files are left"


if __name__ == "__main__":
    main()
