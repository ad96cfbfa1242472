#!/usr/bin/python3
"""Checks natural frequency and damping measured from images.

    vibration.py MOIREGAUGE WORK SOURCE

A target vibrates at 1.7 Hz by 0.5 mm. The frequency must be within 0.5 %, and a damping ratio of 1 % within 10 %. Both
errors must be within four standard uncertainties, and each uncertainty below half of the tolerance.
"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys

FREQUENCY, AMPLITUDE, DAMPING, FPS, FRAMES = 1.7, 0.5, 0.01, 10, 64


def insist(truth, what):
    if not truth:
        raise SystemExit(f"wrong: {what}")


def peaks_of(program, work, name, settings):
    clip = work / name
    subprocess.run([program, "simulate", "small-1xyz", "--frames", str(FRAMES), "--markers-only", "--quiet", "-o", clip, *settings], check=True)
    run = work / f"{name}-run"
    subprocess.run([program, "measure", clip, "--site", clip / "site.toml", "--fps", str(FPS), "-o", run, "--quiet"], check=True)
    page = (run / "report.html").read_text(encoding="utf-8")
    report = json.loads(re.search(r'<script type="[^"]+" id="report">(.*?)</script>', page, re.DOTALL).group(1))
    peaks = report["targets"][0]["spectrum"]["y"]["peaks"]
    insist(peaks, f"{name}: a peak is found")
    return max(peaks, key=lambda peak: peak["amplitude_mm"])


def near(value, u, truth, share, what):
    insist(u > 0 and abs(value - truth) <= share * truth, f"{what}: {value} is not within {100 * share} % of {truth}")
    # The exposure of 1/80 s and the straight lines between the knots of a decay do not change the frequency.
    insist(abs(value - truth) <= 4 * u, f"{what}: {value} is not within four times {u} of {truth}")
    insist(u < 0.5 * share * truth, f"{what}: u {u} says too little")


def falling(t):
    """Returns the decaying displacement in mm at time t, released at rest.

    The first exposure begins before t = 0. A release at rest avoids a kink in it.
    """
    omega = 2 * math.pi * FREQUENCY
    root = math.sqrt(1 - DAMPING**2)
    return AMPLITUDE * math.exp(-DAMPING * omega * t) * (math.cos(omega * root * t) + DAMPING / root * math.sin(omega * root * t))


def main():
    program, work, _source = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    still = ["--set", "marker.mid.dy.scale=0"]
    steady = peaks_of(program, work, "steady", [*still, "--set", f"marker.mid.dy.amplitude={AMPLITUDE}",
                                                "--set", f"marker.mid.dy.frequency_hz={FREQUENCY}"])
    insist(steady["kind"] == "steady" and steady["damping"] is None and steady["no_damping"], "a steady vibration is no decay")
    near(steady["frequency_hz"], steady["u_frequency_hz"], FREQUENCY, 0.005, "frequency")
    step = 0.005  # s, interval of the knots; straight lines have an error of 0.5 mm (omega step)^2 / 8 = 0.2 um
    knots = ", ".join(f"[{k * step:.4f}, {falling(k * step):.7f}]" for k in range(round(FRAMES / FPS / step) + 20))
    decay = peaks_of(program, work, "decay", ["--set", f"marker.mid.dy.knots=[{knots}]"])
    insist(decay["kind"] == "decay", f"a free decay is reported as one, not as {decay['kind']}")
    near(decay["frequency_hz"], decay["u_frequency_hz"], FREQUENCY, 0.005, "frequency of the decay")
    near(decay["damping"], decay["u_damping"], DAMPING, 0.1, "damping ratio")
    print(f"steady: {steady['frequency_hz']:.5f} Hz, u {steady['u_frequency_hz']:.5f}; decay: {decay['frequency_hz']:.5f} Hz, "
          f"u {decay['u_frequency_hz']:.5f}, damping {100 * decay['damping']:.3f} %, u {100 * decay['u_damping']:.3f} %")


if __name__ == "__main__":
    main()
