"""Runs the trials of `moiregauge live`: speed, a camera, kills, outages, alarms and hours of footage. Prints one table row per part.

    trials.py PROGRAM WORK [--scale 1] [PART...]     PART: kills, speed, rate, camera, outages, alarm, soak; all unless given

Without --scale it writes each row to WORK/PART.md too. Ends 1 if a figure is not met.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "cli"), str(TESTS / "survival"), str(TESTS / "common")]
sys.dont_write_bytecode = True
from live_alarm import alarm  # noqa: E402
from live_camera import camera  # noqa: E402
from live_kills import kills  # noqa: E402
from live_outages import outages  # noqa: E402
from live_soak import soak  # noqa: E402
from live_speed import rate, speed  # noqa: E402
from trial import SEED, Trial, load  # noqa: E402

PARTS = {"kills": kills, "speed": speed, "rate": rate, "camera": camera, "outages": outages, "alarm": alarm, "soak": soak}


def commit():
    return subprocess.run(["git", "-C", TESTS, "describe", "--always"], capture_output=True, text=True, check=False).stdout.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--scale", type=float, default=1.0, help="scale of durations and numbers of kills and closings")
    parser.add_argument("parts", nargs="*", metavar="PART")
    options = parser.parse_intermixed_args()
    unknown = [part for part in options.parts if part not in PARTS]
    if unknown:
        parser.error(f"no such part: {', '.join(unknown)}: choose from {', '.join(PARTS)}")
    are_met = True
    options.work.mkdir(parents=True, exist_ok=True)
    print(f"seed {SEED}", file=sys.stderr)
    print("| part | required | measured | load before | commit |\n|---|---|---|---|---|", flush=True)
    for part in options.parts or PARTS:
        trial = Trial(options.program.resolve(), options.work.resolve() / part, options.scale)
        before, version = load(), commit()
        try:
            figures = PARTS[part](trial)
        finally:
            shutil.rmtree(trial.work)
        are_met = are_met and figures.is_met
        row = f"| {part} | {'<br>'.join(figures.required)} | {'<br>'.join(figures.measured)} | {before:.1f} | {version} |"
        print(row, flush=True)
        if options.scale == 1:
            (options.work / f"{part}.md").write_text(row + "\n")
    return 0 if are_met else 1


if __name__ == "__main__":
    sys.exit(main())
