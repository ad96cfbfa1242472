#!/usr/bin/python3
"""Compares speed with the stored figures of bench/guard.csv, so that no change loses it unnoticed.

  bench/guard.py CHAIN_JSON [MORE_CHAIN_JSON ...] --file FILE_JSON --stored bench/guard.csv [--update COMMIT]

CHAIN_JSON is the output of chain_bench (aggregates), one file per instruction set. A figure is the textbook chain's time
divided by that of a case, within one run. FILE_JSON is the output of bench/files.py --guard. Its figure is the share of
decoding in the CPU time of `measure`. The limit is four fifths of the stored figure. Prints a table. Ends 1 if a figure
is below its limit. --update: stores the figures instead.
"""
import argparse
import csv
import json
import sys

from ratios import LARGE, SMALL, Chain

CASES = [(name, size) for name in ("tracking", "precise", "two-stage") for size in (SMALL, LARGE)] + [("detection", LARGE)]
LIMIT = 0.8  # of the stored figure; repeated runs differ by up to a tenth
COLUMNS = ["case", "size", "vectors", "times", "commit"]


def figures(chains):
    """Returns how many times faster than the textbook chain each case is, by (case, size, vectors)."""
    found = {}
    for chain in chains:
        for name, size in CASES:
            if chain.case(name, size, "ring")["lost"] > 0:
                sys.exit(f"error: {name} {size} lost frames, so its speed is none")
            found[name, size, chain.vectors] = 1.0 / chain.share((name, "ring"), ("textbook", "ring"), size)
    return found


def file_figure(path):
    """Returns how much of the CPU time of `measure` is decoding, by (case, size, vectors)."""
    with open(path, encoding="utf-8") as file:
        times = json.load(file)["h264"]
    times_decoding = times["decode"]["cpu_s"] / times["measure"]["cpu_s"]
    return {("measure of an H.264 file, decoding = 1x", SMALL, "widest"): times_decoding}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("chains", nargs="+")
    parser.add_argument("--file", required=True)
    parser.add_argument("--stored", required=True)
    parser.add_argument("--update", metavar="COMMIT")
    options = parser.parse_args()
    now = figures([Chain(path) for path in options.chains]) | file_figure(options.file)
    if options.update:
        with open(options.stored, "w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(COLUMNS)
            table.writerows([*key, f"{times:.3g}", options.update] for key, times in now.items())
        return 0
    with open(options.stored, newline="", encoding="utf-8") as file:
        stored = {(row["case"], row["size"], row["vectors"]): row for row in csv.DictReader(file)}
    slow = 0
    print("| case | size | vectors | stored, textbook chain = 1x | now | verdict |\n|---|---|---|---|---|---|")
    for key, times in now.items():
        old = stored.get(key)
        was = f"{old['times']}x at {old['commit']}" if old else "none"
        is_slow = old is not None and times < LIMIT * float(old["times"])
        slow += is_slow
        print(f"| {' | '.join(key)} | {was} | {times:.3g}x | {'**SLOWER**' if is_slow else 'ok'} |")
    print(f"\nSpeed: {slow} of {len(now)} figures are below {LIMIT:g} of the stored ones")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
