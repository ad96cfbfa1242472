#!/usr/bin/python3
"""Tests gratings that a printer enlarged by 0.12 %.

Without --print-scale displacements are 0.12 % too small, with it they are correct. `solve --print-scale` gives the
values of `measure --print-scale`. The test uses the slope of measured against true dy over 6 mm. Noise of 2 um in 20
frames gives the slope an uncertainty below 0.02 %. Without a site file the gratings are the only scale. With a site
file the stated positions (1 mm over 256 mm) also contribute, and at least two thirds of the 0.12 % remain.
"""
import csv
import json
import sys

import runs

program, work, _ = runs.start()
runs.simulate(program, work / "run", "small-1xyz", 24, "--quiet", "--set", "print.scale=0.0012", "--set", "sensor.fps=4",
              "--set", "marker.mid.dy.scale=3")


def slope(folder):
    with open(work / "run" / "truth.csv", newline="") as file:
        truth = {int(row["frame"]): float(row["dy_mm"]) for row in csv.DictReader(file) if row["marker"] == "mid"}
    pairs = [(truth[int(frame)], float(dy)) for frame, _, _, dy, _, _, status in runs.rows(folder) if status == "ok"]
    runs.insist(len(pairs) == 24 and max(t for t, _ in pairs) > 4, f"{folder}: {pairs}")
    mean_t, mean_m = sum(t for t, _ in pairs) / 24, sum(m for _, m in pairs) / 24
    return sum((t - mean_t) * (m - mean_m) for t, m in pairs) / sum((t - mean_t) ** 2 for t, _ in pairs)


def measure(name, *words):
    runs.run([program, "measure", work / "run", "--fps", 4, "--quiet", "-o", work / name, *words])
    return slope(work / name)


def near(what, value, wanted, tolerance):
    runs.insist(abs(value - wanted) < tolerance, f"{what}: slope {value:.5f}, expected {wanted} within {tolerance}")


site = ["--site", work / "run" / "site.toml"]
near("pitch", measure("pitch", "--pitch", "10mm"), 1 / 1.0012, 2e-4)
near("pitch, stated", measure("pitch_stated", "--pitch", "10mm", "--print-scale", "1.0012"), 1.0, 2e-4)
near("site", measure("site", *site), 1 / 1.0012, 5e-4)
near("site, stated", measure("site_stated", *site, "--print-scale", "1.0012", "--u-print-scale", "0.0001"), 1.0, 3e-4)

config = json.loads((work / "site_stated" / "run.json").read_text())
runs.insist(config["config"]["print_scale"] == {"factor": 1.0012, "u": 0.0001}, f"{config['config']}")
runs.insist(config["config"]["known_to"]["print_scale"] == 0.0001, "known_to is not the rulers'")
unstated = json.loads((work / "site" / "run.json").read_text())["targets"][0]
stated = config["targets"][0]
runs.insist(stated["u_dy_mm"] < 0.5 * unstated["u_dy_mm"], f"u {stated['u_dy_mm']}, without {unstated['u_dy_mm']}")

# `solve --print-scale` on the run without it. A second call does not apply the scale again.
for name, words in (("site", ["--u-print-scale", "0.0001"]), ("pitch", [])):
    runs.run([program, "solve", work / name, "--print-scale", "1.0012", *words, "--quiet", "-o", work / f"{name}_solved"])
    near(f"{name}, solved", slope(work / f"{name}_solved"), slope(work / f"{name}_stated"), 5e-5)
    runs.run([program, "solve", work / f"{name}_solved", "--print-scale", "1.0012", *words, "--quiet", "-o", work / f"{name}_twice"])
    near(f"{name}, solved twice", slope(work / f"{name}_twice"), slope(work / f"{name}_solved"), 1e-6)
sys.exit(0)
