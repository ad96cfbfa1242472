#!/usr/bin/python3
"""Checks that web/dist/report.html is the bundle of the current web/src, by the fingerprint of web/vite.config.js."""
import hashlib
import pathlib
import re
import sys

WEB = pathlib.Path(__file__).resolve().parent.parent.parent / "web"


def fingerprint():
    names = ["package-lock.json", "tsconfig.json", "vite.config.js", *(f"src/{path.name}" for path in (WEB / "src").iterdir())]
    hashed = hashlib.sha256()
    for name in sorted(names):
        hashed.update(f"{name}\n".encode())
        hashed.update((WEB / name).read_bytes())
        hashed.update(b"\n")
    return hashed.hexdigest()


def main():
    page = (WEB / "dist" / "report.html").read_text(encoding="utf-8")
    found = re.search(r"Bundled from web/ as of ([0-9a-f]{64})", page)
    if found and found.group(1) == fingerprint():
        return 0
    print("web/dist/report.html is not the bundle of web/src: run tools/web (it needs Node) and commit what it makes")
    return 1


if __name__ == "__main__":
    sys.exit(main())
