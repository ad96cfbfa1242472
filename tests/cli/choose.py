"""Tests the choice of markers by `measure`, `inspect` and `solve`, and the site file that `inspect` writes.

Each choice is compared with a site file that says the same, or with the same choice made later by `solve`.
"""
import csv
import json
import re
import shutil
import subprocess
import tomllib

from runs import insist, rows, run, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-six-slip", 12, "--set", "marker.NE.dy.scale=0")
frames, site = work / "run/frames", work / "run/site.toml"
SCALE = ["--fps", "10", "--quiet"]


def measure(name, *options):
    run([program, "measure", frames, *SCALE, "-o", work / name, *options])


def solve(name, of, *options):
    run([program, "solve", work / of, "--quiet", "-o", work / name, *options])


def markers(name):
    return {marker["name"]: marker["role"] for marker in json.loads((work / name / "run.json").read_text())["markers"]}


def refused(part, *words, code=2):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    lines = done.stderr.splitlines()
    insist(done.returncode == code and len(lines) == 1 and part in lines[0], f"exit {done.returncode}: {words}\n{done.stderr}")


def apart(a, b):
    """Returns the largest difference of two runs in the u of the first one. The reference frame has none."""
    columns = ("dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm")
    pairs = zip(rows(work / a, columns), rows(work / b, columns), strict=True)
    values = [(list(map(float, x)), list(map(float, y))) for x, y in pairs]
    return max(abs(x[k] - y[k]) / x[k + 2] for x, y in values for k in (0, 1) if x[k + 2] > 0)


# A choice gives the run that a site file with this choice gives.
names = [marker["name"] for marker in tomllib.loads(site.read_text())["reference"]]
four = [name for name in names if name not in ("W", "E")]
insist(len(names) == 6 and len(four) == 4, f"references {names}")
blocks = re.split(r"(?m)^(?=\[)", site.read_text())
(work / "four.toml").write_text("".join(block for block in blocks if not re.search(r'name = "(W|E)"', block)))
measure("by-site", "--site", work / "four.toml")
measure("by-choice", "--site", site, "--ignore", "W,E")
measure("by-list", "--site", site, "--references", ",".join(four))
for name in ("by-choice", "by-list"):
    insist(rows(work / name) == rows(work / "by-site"), f"{name} differs from the site file")
insist(json.loads((work / "by-choice/run.json").read_text())["config"]["choice"]["ignored"] == ["W", "E"], "config.choice")

# `solve` chooses as well, without the frames. Second-order terms and noise at window edges remain.
measure("all", "--site", site)
solve("later", "all", "--ignore", "W,E", "--name", "mid=midspan")
insist(markers("later") == {**{name: "reference" for name in four}, "midspan": "target"}, f"markers {markers('later')}")
insist(apart("by-site", "later") < 0.3, f"dropped later: {apart('by-site', 'later')} u")
measure("two-stage", "--site", site, "--method", "two-stage")
measure("two-stage-four", "--site", work / "four.toml", "--method", "two-stage")
solve("two-stage-later", "two-stage", "--ignore", "W,E")
insist(apart("two-stage-four", "two-stage-later") < 0.3, f"two-stage: {apart('two-stage-four', 'two-stage-later')} u")

# A reference becomes a target, which does not move.
measure("watched", "--site", site, "--targets", "mid,W,E")
solve("watched-later", "all", "--targets", "mid,W,E")
for name in ("watched", "watched-later"):
    with open(work / name / "displacement.csv", newline="") as file:
        moved = [row for row in csv.DictReader(file) if row["marker"] == "W" and row["frame"] != "0"]
    insist(len(moved) == 11 and {row["status"] for row in moved} == {"ok"}, f"{name}: {moved}")
    insist(max(abs(float(row[f"d{a}_mm"])) / float(row[f"u_d{a}_mm"]) for row in moved for a in "xy") < 4, f"{name}: W moves")
refused("its circle was not read in every frame", program, "solve", work / "two-stage", "--references", ",".join([*four, "mid"]),
        "--targets", "W", "-o", work / "refused")

# Without a site file the names are those of `inspect`. A region limits what is found.
measure("detected", "--pitch", "10mm")
some = ["--ignore", "T1,T3", "--name", "T2=midspan"]
measure("detected-some", "--pitch", "10mm", *some)
insist(markers("detected-some") == {**{f"R{k}": "reference" for k in (1, 2, 3, 4)}, "midspan": "target"}, "detected-some")
solve("detected-later", "detected", *some)
insist(markers("detected-later") == markers("detected-some"), "detected-later")
insist(apart("detected-some", "detected-later") < 0.3, f"detected: {apart('detected-some', 'detected-later')} u")
# Targets that are fixed become references, and lower u.
six = ["--references", "R1,R2,R3,R4,T1,T3", "--targets", "T2"]
measure("six", "--pitch", "10mm", *six)
solve("six-later", "detected", *six)
insist(list(markers("six").values()).count("reference") == 6 and markers("six") == markers("six-later"), f"{markers('six')}")
insist(apart("six", "six-later") < 0.5, f"six references: {apart('six', 'six-later')} u")
insist(json.loads((work / "six/run.json").read_text())["references_verified"], "six references check each other")
inspected = work / "inspected"
command = [program, "inspect", frames, "--pitch", "10mm"]
run([*command, "-o", inspected, "--exclude-region", "0,0,200,512"])
found = json.loads((inspected / "inspect.json").read_text())
insist(all(circle["x_px"] >= 200 for circle in found["circles"]), f"circles {found['circles']}")
run([*command, "-o", inspected, "--region", "200,0,824,512"])
insist(json.loads((inspected / "inspect.json").read_text())["circles"] == found["circles"], "--region")

# The site file has short numbers, and it measures the same.
draft = work / "draft.toml"
run([*command, "-o", inspected, "--write-site", draft, "--ignore", "T3", "--name", "T2=midspan"])
text = draft.read_text()
values = tomllib.loads(text)
insist([marker["name"] for marker in values["reference"]] == ["R1", "R2", "R3", "R4"], "references of the draft")
insist([marker["name"] for marker in values["target"]] == ["T1", "midspan"] and "# name = \"C1\"" in text and "# name = \"G1\"" in text, text)
insist(max(map(len, re.findall(r"\d+\.\d+", text))) <= 8, f"long numbers:\n{text}")
measure("by-draft", "--site", draft)
measure("by-name", "--pitch", "10mm", "--ignore", "T3", "--name", "T2=midspan")
insist(apart("by-name", "by-draft") < 0.3, f"by the draft: {apart('by-name', 'by-draft')} u")
# An entry becomes a marker when its comment marks are removed.
entry = re.search(r"(?m)^# \[\[target\]\]\n(# \w+ = .*\n)+", text)[0]
more = text.replace(entry, re.sub(r"(?m)^# ", "", entry))
(work / "more.toml").write_text(more)
run([program, "inspect", frames, "--site", work / "more.toml", "--quiet", "-o", work / "more"])
insist("G1" in (work / "more/inspect.json").read_text(), "the entry is a marker")

# Mistakes are one line with what there is.
plain = [program, "measure", frames, *SCALE, "-o", work / "refused"]
refused("--ignore X: choose from ", *plain, "--site", site, "--ignore", "X")
refused("the marker does not exist: --references R9: choose from R1, R2, R3, R4, T1, T2, T3", *plain, "--pitch", "10mm", "--references", "R1,R9")
refused("no target is left", *plain, "--site", site, "--ignore", "mid")
refused("chosen twice", *plain, "--site", site, "--ignore", "mid", "--targets", "mid")
refused("two markers have this name", *plain, "--site", site, "--name", "mid=W")
refused("reference", program, "measure", frames, *SCALE, "-o", work / "three", "--site", site, "--references", "NW,NE,SW", code=4)
refused("choose from ", program, "solve", work / "all", "--ignore", "X")
refused("choose from R1", program, "inspect", frames, "--pitch", "10mm", "--ignore", "X", "-o", work / "refused")
refused("the file exists", *command, "-o", inspected, "--write-site", draft)
insist(not (work / "refused").exists() and not (work / "refused.unfinished").exists(), "results were written")
shutil.rmtree(work)
