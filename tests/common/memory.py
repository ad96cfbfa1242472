# SPDX-License-Identifier: Apache-2.0
"""Memory of a process and of all that it started, from /proc."""
import pathlib


def private_bytes(process):
    """Returns the private memory of a process in bytes, or NaN if it has ended."""
    try:
        lines = pathlib.Path(f"/proc/{process}/smaps_rollup").read_text(encoding="utf-8").splitlines()
    except OSError:
        return float("nan")
    return 1024.0 * sum(int(line.split()[1]) for line in lines if line.startswith("Private"))


def descendants(process):
    """Returns all processes that a process started, directly or not, with their command lines."""
    parents = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
            parents.setdefault(int(fields[1]), []).append((int(stat.parent.name), (stat.parent / "cmdline").read_text(errors="replace").replace("\0", " ")))
        except OSError:
            continue
    found, rest = [], [process]
    while rest:
        children = parents.get(rest.pop(), [])
        found += children
        rest += [number for number, _ in children]
    return found
