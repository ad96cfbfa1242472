#!/usr/bin/python3
"""Checks the committed bundles of web/: each is that of the current sources, by the fingerprint of web/vite.config.js. The page of
`moiregauge serve` has no inline script or style, never writes HTML from text, and has the report's colours."""
import hashlib
import pathlib
import re
import sys

WEB = pathlib.Path(__file__).resolve().parent.parent.parent / "web"
REPORT_FOLDERS = ["src"]
SERVE_FOLDERS = ["src", "src/serve", "src/serve/parts", "src/serve/setup", "src/serve/results"]
# Ways of writing text as HTML or code. Names of files and markers come from strangers.
FORBIDDEN = re.compile(r"\b(innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval|new Function|srcdoc|createContextualFragment)\b")
COLOUR = re.compile(r"(--(?:series|status|ink|good|fair|bad)[\w-]*): (#\w+);")


def fingerprint(folders):
    names = ["package-lock.json", "tsconfig.json", "vite.config.js"]
    names += [f"{folder}/{path.name}" for folder in folders for path in (WEB / folder).iterdir() if path.is_file()]
    hashed = hashlib.sha256()
    for name in sorted(names):
        hashed.update(f"{name}\n".encode())
        hashed.update((WEB / name).read_bytes())
        hashed.update(b"\n")
    return hashed.hexdigest()


def problems():
    for name, folders in [("report.html", REPORT_FOLDERS), ("app.js", SERVE_FOLDERS)]:
        found = re.search(r"Bundled from web/ as of ([0-9a-f]{64})", (WEB / "dist" / name).read_text(encoding="utf-8"))
        if not found or found.group(1) != fingerprint(folders):
            yield f"web/dist/{name} is not the bundle of web/src: run tools/web (it needs Node) and commit what it makes"
    folders = {str(path.parent.relative_to(WEB)) for path in (WEB / "src").rglob("*") if path.is_file()}
    if folders != set(SERVE_FOLDERS):
        yield f"the fingerprint covers {SERVE_FOLDERS}, but the sources are in {sorted(folders)}: change web/vite.config.js and this test"
    page = (WEB / "dist" / "serve.html").read_text(encoding="utf-8")
    if page != (WEB / "src" / "serve" / "page.html").read_text(encoding="utf-8"):
        yield "web/dist/serve.html is not that of web/src: run tools/web and commit what it makes"
    if re.search(r"<style|\bstyle=|<script(?![^>]*\bsrc=)|\bon\w+=", page):
        yield "web/dist/serve.html has inline script or style, which its policy forbids"
    for path in sorted((WEB / "src").rglob("*.ts")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if FORBIDDEN.search(line):
                yield f"{path.relative_to(WEB.parent)}:{number}: {FORBIDDEN.search(line).group(0)} writes text as HTML or code: use textContent"
    shared = [COLOUR.findall((WEB / "src" / name).read_text(encoding="utf-8")) for name in ("colours.css", "dark.css")]
    own = [COLOUR.findall((WEB / "src" / name).read_text(encoding="utf-8")) for name in ("page.css", "plots.css", "serve/serve.css")]
    if any(own) or min(map(len, shared)) < 20 or [name for name, _ in shared[0]] != [name for name, _ in shared[1]]:
        yield "a colour that has a meaning is not in both web/src/colours.css and web/src/dark.css, or is elsewhere too"


def main():
    found = list(problems())
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
