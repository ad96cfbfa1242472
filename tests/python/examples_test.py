#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every Python example of a page in a folder with clip.mp4: examples_test.py PROGRAM PAGE...

An example is a ```python fence. All examples of a page run in page order in one interpreter, because later ones use the names of
earlier ones.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

os.environ["MPLBACKEND"] = "Agg"  # no window

FENCE = re.compile(r"^```python\n(.*?)^```", re.M | re.S)


def main():
    program, pages = sys.argv[1], [pathlib.Path(page).resolve() for page in sys.argv[2:]]
    with tempfile.TemporaryDirectory(prefix="moiregauge-examples-") as folder:
        subprocess.run([program, "simulate", "small-1xyz", "--frames", "40", "--markers-only", "--seed", "7", "--codec", "x264",
                        "--quality", "8", "--quiet", "-o", folder], check=True)
        os.chdir(folder)
        os.rename("video.mp4", "clip.mp4")
        for page in pages:
            examples = FENCE.findall(page.read_text(encoding="utf-8"))
            if not examples:
                sys.exit(f"error: the page has no example: {page}: put one into a ```python fence")
            names = {}
            for number, text in enumerate(examples, 1):
                print(f"{page.name}, example {number}", flush=True)
                exec(compile(text, f"{page.name}, example {number}", "exec"), names)  # pylint: disable=exec-used


if __name__ == "__main__":
    main()
