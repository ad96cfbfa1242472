#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the tests: changes one constant at a time, and finds a test that detects the change.

    mutate.py --root CHECKOUT --work FOLDER [--only WORD] [--missing] [--labels unit,physics,...]

Copies the sources to FOLDER and builds one program with all mutations, which an environment variable selects. Then runs
the tests for one mutation at a time until one fails: quick tests first, and none that takes over 20 s. Each result is
stored at once in CHECKOUT/tests/mutations/results.csv, so an interrupted run keeps what it has. Prints the table of all
results. --missing: only mutations without a result. --labels: only tests with these labels. Stores then what they
detect, and leaves the others without a result.
"""
import argparse
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

HEADER = """#pragma once
#include <cstdlib>
namespace moiregauge {
// Is mutation number n the one to be tried?
inline bool is_mutated(int n) {
  static const int active = [] {
    const char* const value = std::getenv("MOIREGAUGE_MUTATION");
    return value == nullptr ? 0 : std::atoi(value);
  }();
  return n == active;
}
}  // namespace moiregauge
"""
LABELS = "unit,physics,paper,real,faults,cli"
COLUMNS = ["file", "constant", "value", "instead", "caught_by", "commit"]


def copied(root, work):
    """Copies the files tracked by git, except unchanged ones, so that a second run builds changed files only.

    Removes sources of an earlier copy that are no longer tracked: CMake would find them."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    files = set(filter(None, listed.split("\0")))
    for folder in ("src", "tests", "include", "bench"):
        for old in (work / folder).rglob("*"):
            if old.is_file() and old.relative_to(work).as_posix() not in files:
                old.unlink()
    for name in sorted(files):
        source, copy = root / name, work / name
        if not source.is_file() or copy.is_file() and copy.read_bytes() == source.read_bytes():
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, copy)


def read_list(path):
    """Returns the mutations, and the reason why no test detects one, where the list gives it."""
    mutations, reasons = [], {}
    for line in path.read_text().splitlines():
        words, _, reason = line.partition("#")
        if words.split():
            mutations.append(words.split())
            reasons[tuple(words.split())] = reason.strip()
    return mutations, reasons


def switch(work, number, file, name, value):
    """Makes the value of a constant depend on the mutation number. Returns the original value as text."""
    path = work / "src/moiregauge" / file
    text = path.read_text()
    found = list(re.finditer(rf"^(inline )?constexpr ([^;]*\b{name} = )([^,;]+)", text, re.M))
    if len(found) != 1:
        sys.exit(f"mutate: {file}: {name} is set {len(found)} times, not once")
    at = found[0]
    text = (text[:at.start()] + (at[1] or "") + "const " + at[2] + f"is_mutated({number}) ? {value} : {at[3]}" + text[at.end():])
    if "moiregauge/mutation.h" not in text:
        text = re.sub(r"^#include", '#include "moiregauge/mutation.h"\n#include', text, count=1, flags=re.M)
    path.write_text(text)
    return at[3]


def ctest(work, number, tests, *more):
    """Runs tests by their numbers in ctest's list, with one mutation. Returns what ctest prints."""
    environment = dict(os.environ, MOIREGAUGE_MUTATION=str(number))
    chosen = ["-I", f"{tests[0]},{tests[0]},1," + ",".join(map(str, tests))] if tests else []
    return subprocess.run(["ctest", "--preset", "check", "--parallel", "2", *chosen, *more], cwd=work, env=environment,
                          capture_output=True, text=True, check=False).stdout


def stages(work, labels):
    """Runs all tests without a mutation. Returns those that pass within 20 s, as lists of numbers, from quick to slow."""
    printed = ctest(work, 0, [], "-L", "^(" + "|".join(labels) + ")$")
    times = {int(n): float(s) for n, s in re.findall(r"Test +#(\d+): .* Passed +([\d.]+) sec", printed)}
    limits = (0.5, 2.0, 6.0, 20.0)
    print(f"{len(times)} tests pass without a mutation", file=sys.stderr, flush=True)
    return [chosen for low, high in zip((0.0, *limits), limits) if (chosen := sorted(n for n, t in times.items() if low <= t < high))]


def first_failure(work, number, tests):
    """Returns the name of the first test that fails; None if all pass."""
    for stage in tests:
        failed = re.search(r"^\s*\d+ - (\S+).*\((?:Failed|Timeout|SEGFAULT|Subprocess aborted)",
                           ctest(work, number, stage, "--stop-on-failure"), re.M)
        if failed:
            return failed[1]
    return None


def read_results(path):
    """Returns the stored results by (file, constant, wrong value)."""
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as file:
        return {(row["file"], row["constant"], row["instead"]): row for row in csv.DictReader(file)}


def write_results(path, mutations, results):
    """Stores the results in the order of the list. Drops those of mutations that are not in it."""
    fresh = path.with_suffix(".partial")
    with open(fresh, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(results[key] for key in map(tuple, mutations) if key in results)
    fresh.replace(path)


def print_table(mutations, reasons, results):
    print("| file | constant | value | instead | caught by | commit |\n|---|---|---|---|---|---|")
    known = [(results[key], reasons[key] or "none") for key in map(tuple, mutations) if key in results]
    for row, reason in known:
        print("| " + " | ".join(row[column] or reason for column in COLUMNS) + " |")
    caught = sum(bool(row["caught_by"]) for row, _ in known)
    print(f"\n{caught} of {len(known)} mutations are caught. {len(mutations) - len(known)} of {len(mutations)} are not measured.")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", required=True, type=pathlib.Path)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--missing", action="store_true")
    parser.add_argument("--labels", default=LABELS)
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    copied(options.root.resolve(), work)
    (work / "src/moiregauge/mutation.h").write_text(HEADER)
    mutations, reasons = read_list(options.root / "tests/mutations/mutations.txt")
    before = [switch(work, number, *mutation) for number, mutation in enumerate(mutations, 1)]
    launchers = [f"-DCMAKE_{language}_COMPILER_LAUNCHER=ccache" for language in ("C", "CXX")] if "CCACHE_DIR" in os.environ or \
        subprocess.run(["which", "ccache"], capture_output=True, check=False).returncode == 0 else []
    for command in (["cmake", "--preset", "check", *launchers], ["cmake", "--build", "--preset", "check"]):
        done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"mutate: {' '.join(command)}:\n{done.stdout[-4000:]}{done.stderr[-2000:]}")
    tests = stages(work, options.labels.split(","))
    stored = options.root / "tests/mutations/results.csv"
    results = read_results(stored)
    commit = subprocess.run(["git", "-C", options.root, "rev-parse", "--short", "HEAD"], check=True, capture_output=True,
                            text=True).stdout.strip()
    for number, ((file, name, value), was) in enumerate(zip(mutations, before), 1):
        if options.only not in f"{file} {name}" or options.missing and (file, name, value) in results:
            continue
        start = time.monotonic()
        test = first_failure(work, number, tests)
        if test or options.labels == LABELS:
            results[file, name, value] = dict(zip(COLUMNS, (file, name, was, value, test or "", commit)))
            write_results(stored, mutations, results)
        print(f"{number} of {len(mutations)}: {name}: {test or 'none'}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    print_table(mutations, reasons, results)


main()
