#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the tests: changes one constant at a time, and finds a test that detects the change.

    mutate.py --root CHECKOUT --work FOLDER [--only WORD,...] [--missing] [--labels unit,physics,...] [--most SECONDS]
              [--targets TARGET,...] [--tests REGEX]

Copies the sources to FOLDER and builds one program with all mutations, which an environment variable selects. Runs each
test once without a mutation, to learn which constants it reads. Then runs, for one mutation at a time, the tests that
read its constant, quick ones first and none that takes over --most seconds (20), until one fails. Each result is stored at once in
CHECKOUT/tests/mutations/results.csv, so an interrupted run keeps what it has. Prints the table of all results.
--missing: only mutations that no test has caught, and for which not all tests ran. --labels: only tests with these
labels. --targets: builds only these programs. --tests: only tests whose names match.
"""
import argparse
import csv
import hashlib
import json
import multiprocessing.pool
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

HEADER = """#pragma once
#include <fcntl.h>
#include <unistd.h>
#include <atomic>
#include <cstdio>
#include <cstdlib>
namespace moiregauge {
// A constant that mutation number kNumber changes. Writes its number to the file of MOIREGAUGE_READ when it is first read.
template <int kNumber, class Value>
struct Mutated {
  Value was, instead;
  operator Value() const {
    static const bool is_mutated = [] {
      const char* const value = std::getenv("MOIREGAUGE_MUTATION");
      return value != nullptr && std::atoi(value) == kNumber;
    }();
    static const bool is_noted = [] {
      const char* const path = std::getenv("MOIREGAUGE_READ");
      const int file = path == nullptr ? -1 : ::open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
      if (file >= 0) {
        ::dprintf(file, "%d\\n", kNumber);
        ::close(file);
      }
      return true;
    }();
    return is_noted && is_mutated ? instead : was;
  }
  Value operator+() const { return *this; }
};
}  // namespace moiregauge
"""
LABELS = "unit,physics,paper,real,faults,cli"
COLUMNS = ["file", "constant", "value", "instead", "caught_by", "tried", "commit"]
ALL_TESTS = "all"


def copied(root, work, mutated):
    """Copies the files tracked by git except `mutated`, a text by path, and writes these. Leaves unchanged ones alone, so
    that a second run builds changed files only.

    Removes sources of an earlier copy that are no longer tracked: CMake would find them."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    files = set(filter(None, listed.split("\0")))
    for folder in ("src", "tests", "include", "bench"):
        for old in (work / folder).rglob("*"):
            if old.is_file() and old.relative_to(work).as_posix() not in files | set(mutated):
                old.unlink()
    for name in sorted(files - set(mutated)):
        source, copy = root / name, work / name
        if not source.is_file() or copy.is_file() and copy.read_bytes() == source.read_bytes():
            continue
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, copy)
    for name, text in mutated.items():
        copy = work / name
        if not copy.is_file() or copy.read_text() != text:
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(text)


def read_list(path):
    """Returns the mutations, and the reason why no test detects one, where the list gives it."""
    mutations, reasons = [], {}
    for line in path.read_text().splitlines():
        words, _, reason = line.partition("#")
        if words.split():
            mutations.append(words.split())
            reasons[tuple(words.split())] = reason.strip()
    return mutations, reasons


def switch(root, mutated, number, file, name, value):
    """Makes the value of a constant depend on the mutation number, in `mutated`, a text by path. Returns the original
    value as text."""
    path = f"src/moiregauge/{file}"
    text = mutated.get(path) or (root / path).read_text()
    found = list(re.finditer(rf"^(inline )?constexpr (\w+) {name} = ([^,;]+)([,;])", text, re.M))
    if len(found) != 1:
        sys.exit(f"mutate: {file}: {name} is set {len(found)} times, not once")
    at = found[0]
    more = "" if at[4] == ";" else f" constexpr {at[2]}"
    uses = re.sub(rf"(?<![\w:]){name}\b", f"(+{name})", text[at.end():])  # + gives the value, which std::max() needs
    text = f"{text[:at.start()]}{at[1] or ''}const Mutated<{number}, {at[2]}> {name}{{{at[3]}, {value}}};{more}{uses}"
    if "moiregauge/mutation.h" not in text:
        text = re.sub(r"^#include", '#include "moiregauge/mutation.h"\n#include', text, count=1, flags=re.M)
    mutated[path] = text
    return at[3]


def ctest(work, tests, *more, **variables):
    """Runs tests by their places in the list of the preset's tests. Returns what ctest prints."""
    chosen = ["-I", f"{tests[0]},{tests[0]},1," + ",".join(map(str, tests))] if tests else []
    return subprocess.run(["ctest", "--preset", "check", *chosen, *more], cwd=work, env=os.environ | variables,
                          capture_output=True, text=True, check=False).stdout


def readers(work, labels, names):
    """Runs each test without a mutation. Returns, by mutation as text, the (seconds, place) of the tests that read its
    constant and pass. Stores this in the work folder, and reads it from there if the programs are older."""
    stored = work / f"readers-{'-'.join(labels)}-{hashlib.sha256(names.encode()).hexdigest()[:12]}.json"
    newest = max(file.stat().st_mtime for file in (work / "build/check/bin").iterdir())
    if stored.exists() and stored.stat().st_mtime > newest:
        return json.loads(stored.read_text())
    label = "^(" + "|".join(labels) + ")$"
    only = ["-L", label] + (["-R", names] if names else [])  # an empty expression matches no test
    every, chosen = (re.findall(r"Test +#(\d+):", ctest(work, [], "--show-only", *more)) for more in ([], only))
    places = [n for n, number in enumerate(every, 1) if number in set(chosen)]
    found = {}
    with tempfile.TemporaryDirectory() as folder, multiprocessing.pool.ThreadPool(2) as pool:
        def tried(place):
            return place, ctest(work, [place], MOIREGAUGE_READ=f"{folder}/{place}")
        for place, printed in pool.imap_unordered(tried, places):
            file = pathlib.Path(folder, str(place))
            seconds = re.search(r" Passed +([\d.]+) sec", printed)
            if seconds and file.exists():
                for mutation in set(file.read_text().split()):
                    found.setdefault(mutation, []).append((float(seconds[1]), place))
    stored.write_text(json.dumps(found))
    return found


def first_failure(work, number, tests):
    """Returns the name of the first test that fails, of tests from quick to slow; None if all pass."""
    while tests:
        until = 4.0 * tests[0][0] + 0.5  # a stage: a failure among quick tests spares the slow ones
        stage = [place for seconds, place in tests if seconds <= until]
        tests = [t for t in tests if t[0] > until]
        failed = re.search(r"^\s*\d+ - (\S+).*\((?:Failed|Timeout|SEGFAULT|Subprocess aborted)",
                           ctest(work, stage, "--parallel", "2", "--stop-on-failure", MOIREGAUGE_MUTATION=str(number)), re.M)
        if failed:
            return failed[1]
    return None


def read_results(path):
    """Returns the stored results by (file, constant, wrong value). `tried`: number and kind of the tests that passed."""
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
    known = [(results[key], reasons[key]) for key in map(tuple, mutations) if key in results]
    for row, reason in known:
        verdict = row["caught_by"] or f"none of {row['tried']}" + (f": {reason}" if reason else "")
        print(f"| {row['file']} | {row['constant']} | {row['value']} | {row['instead']} | {verdict} | {row['commit']} |")
    left = [(row, reason) for row, reason in known if not row["caught_by"]]
    print(f"\n{len(known) - len(left)} of {len(mutations)} mutations are caught.", end="")
    if len(known) - len(left) < len(mutations):
        print(f" Of the others, {sum(bool(reason) for _, reason in left)} state why none can be, "
              f"{sum(not reason for _, reason in left)} give no reason, "
              f"and {len(mutations) - len(known)} were not measured.", end="")
    print()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", required=True, type=pathlib.Path)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--missing", action="store_true")
    parser.add_argument("--labels", default=LABELS)
    parser.add_argument("--most", default=20.0, type=float)
    parser.add_argument("--targets", default="")
    parser.add_argument("--tests", default="")
    options = parser.parse_args()
    work = options.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    root, mutated = options.root.resolve(), {"src/moiregauge/mutation.h": HEADER}
    mutations, reasons = read_list(root / "tests/mutations/mutations.txt")
    before = [switch(root, mutated, number, *mutation) for number, mutation in enumerate(mutations, 1)]
    copied(root, work, mutated)
    launchers = [f"-DCMAKE_{language}_COMPILER_LAUNCHER=ccache" for language in ("C", "CXX")] if "CCACHE_DIR" in os.environ or \
        subprocess.run(["which", "ccache"], capture_output=True, check=False).returncode == 0 else []
    chosen = ["--target", *options.targets.split(",")] if options.targets else []
    for command in (["cmake", "--preset", "check", *launchers], ["cmake", "--build", "--preset", "check", *chosen]):
        done = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"mutate: {' '.join(command)}:\n{done.stdout[-4000:]}{done.stderr[-2000:]}")
    tests = readers(work, options.labels.split(","), options.tests)
    stored = options.root / "tests/mutations/results.csv"
    results = read_results(stored)
    commit = subprocess.run(["git", "-C", options.root, "rev-parse", "--short", "HEAD"], check=True, capture_output=True,
                            text=True).stdout.strip()
    for number, ((file, name, value), was) in enumerate(zip(mutations, before), 1):
        old = results.get((file, name, value))
        is_known = old and (old["caught_by"] or old["tried"].endswith(ALL_TESTS))
        if options.missing and is_known or not any(word in f"{file} {name}" for word in options.only.split(",")):
            continue
        start = time.monotonic()
        chosen = sorted(test for test in tests.get(str(number), []) if test[0] < options.most)
        test = first_failure(work, number, chosen)
        kind = ALL_TESTS
        if options.labels != LABELS or options.most < 20.0 or options.tests:
            kind = f"{options.labels.replace(',', '/')} under {options.most:g} s"
        row = (file, name, was, value, test or "", f"{len(chosen)} tests, {kind}", commit)
        results[file, name, value] = dict(zip(COLUMNS, row))
        write_results(stored, mutations, results)
        print(f"{number} of {len(mutations)}: {name}: {test or 'none'} of {len(chosen)}: "
              f"{time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    print_table(mutations, reasons, results)


main()
