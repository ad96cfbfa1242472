"""Checks that inspect.json matches its schema, gives a reason for each null, and has the markers of measure."""
import json
import subprocess
import sys

from runs import run, simulate, start

program, work, source = start()
simulate(program, work / "run")
frames, site = work / "run/frames", work / "run/site.toml"
subprocess.run(["ffmpeg", "-loglevel", "error", "-f", "lavfi", "-i", "color=gray:size=640x480", "-frames:v", "1", work / "grey.png"],
               check=True)


def without_reason(part, where="inspect"):
    if isinstance(part, list):
        for number, item in enumerate(part):
            yield from without_reason(item, f"{where}[{number}]")
    elif isinstance(part, dict):
        for key, value in part.items():
            if value is None and not part.get("null_because", {}).get(key):
                yield f"{where}.{key}"
            yield from without_reason(value, f"{where}.{key}")


def inspected(name, code, *words):
    run([program, "inspect", *words, "-o", work / name], expected=code)
    run(["/usr/bin/python3", source / "tests/cli/check_run_json.py", source / "docs/schema/inspect.schema.json",
         work / name / "inspect.json"])
    json_ = json.loads((work / name / "inspect.json").read_text(encoding="utf-8"))
    silent = list(without_reason(json_))
    if silent:
        sys.exit(f"{name}: null without a reason: {silent[:5]}")
    return json_


for name, scale in [("site", ["--site", site]), ("pitch", ["--pitch", "10mm"])]:
    seen = inspected(name, 0, frames, *scale)
    run([program, "measure", frames, *scale, "--frames", "0:2", "--method", "two-stage", "-o", work / (name + "-run")])
    measured = json.loads((work / (name + "-run") / "run.json").read_text(encoding="utf-8"))
    for a, b in zip(seen["markers"], measured["markers"], strict=True):
        for key in ["name", "role", "x_mm", "y_mm", "pitch_px", "angle_deg", "modulation"]:
            if a[key] != b[key]:
                sys.exit(f"{name}: {key} of {a['name']}: inspect says {a[key]}, measure {b[key]}")
inspected("no-scale", 0, frames)
inspected("nothing", 4, work / "grey.png")
inspected("no-site-there", 4, work / "grey.png", "--site", site)
