#!/usr/bin/python3
"""Counts the instructions of a frame by callgrind. Unlike times, they do not depend on other load of the machine.

  bench/instructions.py CHAIN_BENCH > instructions.json

Counts the parts of a frame of `precise`, 4104x1012, per frame and per byte of the gratings' windows. Uses AVX2, because
valgrind knows no wider vectors. Takes minutes.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

TRACK = ("moiregauge::internal::track_references(", "moiregauge::internal::track_target(")
# Part: (case to run, functions to count, function that they call once per frame)
PARTS = {
    "tracking": ("tracking", TRACK, "moiregauge::internal::second_view("),
    "tracking and five patches": ("precise", TRACK, "moiregauge::internal::second_view("),
    "pose, displacement and u": ("precise", ("moiregauge::internal::bench::ProductChain::solve_in_scene(",), "moiregauge::internal::fit_frame("),
}
SIZE = "4104x1012"


def calls_of(function, lines):
    """Returns the number of calls of a function according to a callgrind file."""
    names, callee, calls = {}, None, 0
    for line in lines:
        if match := re.match(r"c?fn=\((\d+)\)(?: (.*))?", line):
            if match[2]:
                names[match[1]] = match[2]
            if line.startswith("cfn="):
                callee = names[match[1]]
        elif line.startswith("calls=") and callee and callee.startswith(function):
            calls += int(line[6:].split()[0])
    return calls


def counted(chain_bench, case, functions, once):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind.out"
        done = subprocess.run(
            ["valgrind", "--tool=callgrind", "--collect-atstart=no",
             *(f"--toggle-collect={function}*" for function in functions), f"--callgrind-out-file={out}",
             chain_bench, f"--benchmark_filter=^{case}/{SIZE}/ring$", "--benchmark_min_time=0.0001", "--benchmark_format=json"], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"error: callgrind: {done.stderr.strip()}")
        lines = out.read_text(encoding="utf-8").splitlines()
    total = next(int(line.split()[1]) for line in lines if line.startswith(("summary:", "totals:")))
    row = json.loads(done.stdout)["benchmarks"][0]
    return {"instructions": total / calls_of(once, lines), "bytes": row["bytes"]}


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: bench/instructions.py CHAIN_BENCH")
    json.dump({part: counted(sys.argv[1], *how) for part, how in PARTS.items()}, sys.stdout, indent=1)


if __name__ == "__main__":
    main()
