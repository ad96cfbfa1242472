#!/usr/bin/python3
"""Computes ratios within one run of the benchmarks, and compares them with their limits.

  bench/ratios.py CHAIN_JSON [MORE_CHAIN_JSON ...] [--files FILES_JSON]

CHAIN_JSON is the output of chain_bench (aggregates), one file per instruction set. FILES_JSON is the output of
bench/files.py. Prints a Markdown table. Ends 1 if a limit is not met.

Times depend on the machine, ratios within one run do not. A ratio counts only if no frame is lost and the error is not
larger than that of the reference implementation. The error is the scatter around the mean of the frames, without the
common noise of the reference frame. The scatter of n frames has a relative standard error of 1 / sqrt(2 (n - 1)), which
is allowed.
"""
import argparse
import json
import math
import operator
import sys
from dataclasses import dataclass

SMALL, LARGE = "4104x1012", "4096x2168"
MIB = 1024 * 1024


@dataclass
class Limit:
    """Limit of a ratio: at least N times as fast, or at most a share."""
    value: float
    least: bool
    of: str = ""

    def holds(self, reached):
        return (operator.ge if self.least else operator.le)(reached, self.value)

    def words(self):
        return f"{'>=' if self.least else '<='} {self.value:g}{'x' if self.least else ''}{self.of}"


def at_least(value):
    return Limit(value, True)


def at_most(value, of=""):
    return Limit(value, False, of)


@dataclass
class Row:
    work: str
    gate: Limit
    aim: Limit
    reached: float
    for_aim: float = math.nan  # ratio for the aim, if it differs from that of the gate
    error: str = ""
    spoilt: str = ""  # reason why the ratio does not count

    def verdict(self):
        if self.spoilt or not self.gate.holds(self.reached):
            return "**fails**" + (": " + self.spoilt if self.spoilt else "")
        return "aim" if self.aim.holds(self.reached if math.isnan(self.for_aim) else self.for_aim) else "gate"

    def markdown(self):
        other = "" if math.isnan(self.for_aim) else f"; {self.for_aim:.3g}{self.aim.of}"
        reached = f"{self.reached:.3g}{'x' if self.gate.least else self.gate.of}{other}"
        return f"| {self.work} | {self.gate.words()} | {self.aim.words()} | {reached} | {self.error} | {self.verdict()} |"


class Chain:
    """The medians of one run of chain_bench."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
        self.context = content["context"]
        aggregates = {kind: {row["run_name"]: row for row in content["benchmarks"] if row.get("aggregate_name") == kind}
                      for kind in ("mean", "median")}
        self.medians = aggregates["median"]
        for name, row in self.medians.items():  # a median would hide a single lost frame
            row["lost"] = aggregates["mean"][name]["lost"]

    @property
    def vectors(self):
        return {"avx2": "AVX2", "avx3": "AVX-512"}.get(self.context["simd"], self.context["simd"])

    def case(self, name, size, memory):
        try:
            return self.medians[f"{name}/{size}/{memory}"]
        except KeyError:
            raise SystemExit(f"error: no median of {name}/{size}/{memory}: run chain_bench with repetitions and all cases")

    def has(self, case, size):
        """Returns True if the run has the case (name, memory)."""
        return f"{case[0]}/{size}/{case[1]}" in self.medians

    def seconds(self, name, size, memory):
        row = self.case(name, size, memory)
        return row["cpu_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[row["time_unit"]]

    def share(self, ours, yardstick, size):
        """Returns the time of `ours` divided by that of `yardstick`; each is (name, memory)."""
        return self.seconds(ours[0], size, ours[1]) / self.seconds(yardstick[0], size, yardstick[1])

    def errors(self, ours, yardstick, size, unit):
        """Returns the errors as text, and the reason why the comparison does not count (empty: it counts)."""
        mine, other = (self.case(name, size, memory) for name, memory in (ours, yardstick))
        spoilt = ""
        for (name, _), case in ((ours, mine), (yardstick, other)):
            if case["lost"] > 0:
                spoilt = f"{name} lost {100 * case['lost']:.2g} % of the frames"
        scale, shown = (1000, "um") if unit == "mm" else (1, unit)
        texts = []
        for axis in ("x", "y"):
            a, b = (case[f"scatter_{axis}_{unit}"] for case in (mine, other))
            if not spoilt and not a <= b * (1 + 1 / math.sqrt(2 * (mine["error_frames"] - 1))):  # also true for NaN
                spoilt = f"less exact along {axis}"
            texts.append(f"{scale * a:.2g} / {scale * b:.2g}")
        return f"{', '.join(texts)} {shown}", spoilt


def chain_rows(chain):
    textbook = ("textbook", "ring")
    narrow = chain.vectors == "AVX2"  # half the lanes
    for case, size, gate, aim in (("precise", SMALL, 80 if narrow else 120, 400), ("precise", LARGE, 190 if narrow else 280, 800),
                                  ("two-stage", SMALL, 40, 400), ("two-stage", LARGE, 100, 900)):
        ours = (case, "ring")
        yield Row(f"whole chain of `{case}` with u, frames in memory, {size}, {chain.vectors}, against the textbook chain", at_least(gate),
                  at_least(aim), 1 / chain.share(ours, textbook, size), math.nan, *chain.errors(ours, textbook, size, "mm"))
    for size in (SMALL, LARGE):
        in_cache = (260 if narrow else 400) if size == SMALL else (600 if narrow else 900)
        for memory, place, gate in (("ring", "in the last-level cache", in_cache), ("cold", "cold", 200)):
            ours = ("tracking", memory)
            yield Row(f"tracking chain, windows {place}, {size}, {chain.vectors}, against the textbook chain", at_least(gate),
                      at_most(0.25, " of a pass"), 1 / chain.share(ours, textbook, size),
                      chain.share(ours, ("floor", "ring"), size), *chain.errors(ours, textbook, size, "mm"))
    ours = ("detection", "ring")
    yield Row(f"first detection in the full frame, {LARGE}, {chain.vectors}, share of the textbook chain", at_most(0.2), at_most(0.03),
              chain.share(ours, textbook, LARGE), math.nan,
              *chain.errors(ours, ("textbook detection", "ring"), LARGE, "px"))


def peer_rows(chain):
    """A whole frame of `precise` without u against OpenCV's tracker on the same gratings, where the run has that case."""
    ours, peer = ("patches precise", "ring"), ("patches lucas-kanade", "ring")
    for size in (SMALL, LARGE):
        if chain.has(peer, size):
            yield Row(f"whole frame of `precise`, {size}, {chain.vectors}, against OpenCV's Lucas-Kanade tracker on its five gratings alone", at_least(10),
                      at_least(20), 1 / chain.share(ours, peer, size), math.nan, *chain.errors(ours, peer, size, "px"))


def file_rows(measured):
    for name, file in measured["files"].items():
        wall = {program: file[program]["wall_s"] for program in ("measure", "decode", "bytes")}
        if name == "raw":
            yield Row("`measure` of raw 4096x2168, wall time against one pass over the file's bytes", at_most(20),
                      at_most(3), wall["measure"] / wall["bytes"])
        else:
            yield Row(f"`measure` of {name} 4096x2168, wall time against decoding alone", at_most(1.10), at_most(1.03),
                      wall["measure"] / wall["decode"])
    memory = measured["memory"]
    more = (memory["measure"]["peak_bytes"] - memory["decode"]["peak_bytes"]) / MIB
    yield Row(f"{memory['frames']}-frame run, peak memory beyond the decoder's", at_most(200, " MiB"),
              at_most(64, " MiB"), more)


def table(rows):
    head = "| work | gate | aim | reached | scatter along x, y, ours / the other's | verdict |\n|---|---|---|---|---|---|\n"
    return head + "".join(row.markdown() + "\n" for row in rows)


def rows_of(chains, files_path):
    rows = [row for chain in chains for row in (*chain_rows(chain), *peer_rows(chain))]
    if files_path:
        with open(files_path, encoding="utf-8") as file:
            rows += file_rows(json.load(file))
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("chain", nargs="+")
    parser.add_argument("--files")
    words = parser.parse_args()
    rows = rows_of([Chain(path) for path in words.chain], words.files)
    print(table(rows), end="")
    return 1 if any(row.verdict().startswith("**fails") for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
