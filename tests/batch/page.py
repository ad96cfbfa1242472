#!/usr/bin/python3
"""Checks index.html of a batch in a browser.

    page.py MOIREGAUGE WORK SOURCE

The page requests no other file and reports no errors. It draws a part of many clips at first, and more when it is
scrolled. It filters, searches and sorts. No name of a clip, target or message becomes markup.
"""
import json
import os
import pathlib
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "report"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from clips import batch  # noqa: E402
from browser import Browser  # noqa: E402
from runs import insist, simulate, start  # noqa: E402

CLIPS = 250
ATTACK = "</script><img src=x onerror=\"document.title='owned'\"><script>document.title='owned'</script>"


def many_clips(program, work):
    """Copies one measured clip, and gives every fifth copy an attack as path and message."""
    simulate(program, work / "scene", "small-1xyz", 4)
    out = work / "out"
    batch(program, work / "scene", "-o", out, "--fps", "10")
    own = out / ".batch"
    header = (own / "clips.jsonl").read_text().splitlines()[0]
    state = json.loads((own / "state/scene.json").read_text())
    lines = [header]
    for n in range(CLIPS):
        is_bad = n % 5 == 0
        lines.append(json.dumps({"name": f"clip{n:03d}", "input": f"/x/{ATTACK if is_bad else n}.mkv"}))
        mine = dict(state, exit_code=3, message=ATTACK) if is_bad else state
        (own / f"state/clip{n:03d}.json").write_text(json.dumps(mine))
        if not is_bad:
            (out / f"clip{n:03d}").mkdir()
            for name in ("run.json", "displacement.csv", "report.html"):
                os.link(out / "scene" / name, out / f"clip{n:03d}" / name)
    (own / "clips.jsonl").write_text("\n".join(lines) + "\n")
    shutil.rmtree(own / "slurm")
    batch(program, "--collect", "-o", out, expected=5)
    return out


def rows(page):
    return page.value("document.querySelectorAll('#rows tr').length")


def press(page, text):
    page.value(f"[...document.querySelectorAll('button')].find((b) => b.textContent.startsWith('{text}')).click()")


def check(page):
    insist(page.value("document.title") == "moiregauge batch", "no name is markup")
    insist(page.value("document.querySelectorAll('#rows img, #rows script').length") == 0, "no element comes from a name")
    insist(page.value("document.querySelector('h1').textContent") == f"{CLIPS} clips", "number of clips")
    insist(rows(page) < CLIPS, f"a part is drawn at first: {rows(page)}")
    page.value("window.scrollTo(0, document.body.scrollHeight)")
    page.wait(f"(window.scrollTo(0, document.body.scrollHeight), document.querySelectorAll('#rows tr').length === {CLIPS})")
    insist(page.value("document.querySelectorAll('#rows svg path').length") == CLIPS * 4 // 5, "each measured target has a plot")
    insist(page.value("[...document.querySelectorAll('#rows svg path')].every((p) => p.getAttribute('d').startsWith('M'))"), "plots have lines")
    press(page, "failed")
    insist(rows(page) == CLIPS // 5, "the filter of outcomes")
    press(page, "all")
    page.value("(() => { const i = document.querySelector('input'); i.value = 'clip123'; i.dispatchEvent(new Event('input')); })()")
    insist(rows(page) == 1, "the search")
    link = page.value("document.querySelector('#rows a').getAttribute('href')")
    insist(link == "clip123/report.html", f"the link leads to the report: {link}")
    page.value("(() => { const i = document.querySelector('input'); i.value = ''; i.dispatchEvent(new Event('input')); })()")
    press(page, "clip")
    press(page, "clip")
    insist(page.value("document.querySelector('#rows td:nth-child(2)').textContent").startswith(f"clip{CLIPS - 1}"), "sorted backwards")


def main():
    program, work, _ = start()
    out = many_clips(program, work)
    with Browser(work) as browser:
        for dark in (False, True):
            check(browser.open(f"file://{out.resolve()}/index.html", width=1300, height=800, dark=dark))
        insist(not browser.errors, f"errors: {browser.errors}")
        insist(not browser.requests, f"requests: {browser.requests}")


if __name__ == "__main__":
    main()
