#!/usr/bin/python3
"""Checks movement that a grating does not show: along its lines, and out of the fixed window of `conventional`.

Errors are relative to truth.csv. Every `ok` row must be right within 5 u, and u must stay useful: a grating of lines
mounted at 0.5 deg shows 0.009 of the movement along them, so u is at most 0.02 mm for a movement by 1 mm.
"""
import csv

import runs

program, work, _ = runs.start()


def checked(clip, method, axes, largest_u):
    """Returns the number of ok rows, the largest error and the largest u of the axes that are shown."""
    out = clip / method
    runs.run([program, "measure", clip / "video.mkv", "--site", clip / "site.toml", "--method", method, "-o", out])
    with open(clip / "truth.csv", encoding="ascii") as file:
        truth = {r["frame"]: r for r in csv.DictReader(file) if r["marker"] == "mid"}
    ok, worst, widest = 0, 0.0, 0.0
    for frame, _, dx, dy, u_dx, u_dy, status in runs.rows(out)[1:]:
        for axis, value, u in (("dx", dx, u_dx), ("dy", dy, u_dy)):
            if axis not in axes:
                runs.insist(value == "NaN" and u == "NaN", f"{out}: {axis} {value} u {u} in frame {frame}")
            elif status == "ok":
                error, u = abs(float(value) - float(truth[frame][axis + "_mm"])), float(u)
                runs.insist(error <= 5.0 * u + 2e-6, f"{out}: {axis} is off by {error} mm, u {u}, in frame {frame}")
                worst, widest = max(worst, error), max(widest, u)
        ok += status == "ok"
    runs.insist(ok >= 12 and widest < largest_u, f"{out}: {ok} rows ok, u up to {widest} mm")
    runs.insist(("it was not measured" in (out / "report.html").read_text()) == (len(axes.split()) < 2), f"{out}: report of an axis not shown")
    print(clip.name, method, ok, f"ok, error up to {worst:.5f} mm, u up to {widest:.5f} mm")


def simulated(name, scene, settings):
    clip = work / name
    runs.simulate(program, clip, scene, 25, "--codec", "ffv1", "--seed", 4, *[word for s in settings for word in ("--set", s)])
    return clip


# dy moves by 1 mm. dx moves by half of it.
for scene in ("small-still", "small-1xyz"):
    for pattern, axis in (("lines-y", "dy"), ("lines-x", "dx")):
        for angle in (0.0, 0.3, -0.5):
            clip = simulated(f"{scene}-{pattern}-{angle}", scene, [
                f"marker.mid.pattern={pattern}", f"marker.mid.place.rotation_deg={angle}", "marker.mid.dx.knots=[[0, 0], [2.4, 0.5]]"])
            for method in ("precise", "two-stage") + (("conventional",) if scene == "small-still" else ()):
                checked(clip, method, axis, 0.02)

# The window of 87 px fills the grating, which moves out of it by up to 0.4 pitches.
for pattern in ("grid", "dots", "checkerboard"):
    clip = simulated(f"out-{pattern}", "small-still", [
        f"marker.mid.pattern={pattern}", "marker.mid.dx.knots=[[0, 0], [2.4, 4.0]]", "marker.mid.dy.knots=[[0, 0], [2.4, -3.0]]"])
    checked(clip, "conventional", "dx dy", 0.04)
