#!/usr/bin/python3
"""Checks that all links of the documentation to files of this repository, and to headings in them, are valid."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)")


def headings(path):
    """Returns the anchors of a page as GitHub names them: lower case, dashes for spaces, no punctuation."""
    names = set()
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            words = line.lstrip("#").strip().lower()
            names.add(re.sub(r"[^\w\- ]", "", words).replace(" ", "-"))
    return names


def broken_in(path):
    text = re.sub(r"`[^`]*`", "", path.read_text(encoding="utf-8"))
    for target in LINK.findall(text):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, heading = target.partition("#")
        goal = (path.parent / name).resolve() if name else path
        if not goal.exists():
            yield f"{target}: there is no such file"
        elif heading and goal.suffix == ".md" and heading not in headings(goal):
            yield f"{target}: there is no such heading"


def main():
    files = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    broken = [f"{name}: {problem}" for name in files if (ROOT / name).exists() for problem in broken_in(ROOT / name)]
    print("\n".join(broken) or f"{len(files)} files, all links lead somewhere")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
