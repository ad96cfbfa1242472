"""What `moiregauge measure` wrote to a folder, as a pandas table.

    import read_moiregauge
    samples, info = read_moiregauge.read("bridge-moiregauge")
    mid = samples[(samples.marker == "mid") & (samples.status == "ok")]
    mid.plot(x="time_s", y="dy_mm")

As a program: python3 read_moiregauge.py FOLDER prints one line per target.
"""
import json
import pathlib
import sys

import pandas


def read(folder):
    """samples: frame, time_s, marker, dx_mm, dy_mm, u_dx_mm, u_dy_mm, status, a row per frame and target, NaN where
    nothing was measured; u is a standard uncertainty (k = 1); x right, y up, since the reference frame. info: run.json."""
    folder = pathlib.Path(folder)
    info = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    # Names are names: a target called NaN or 1 stays a text.
    samples = pandas.read_csv(folder / "displacement.csv", dtype={"marker": str, "status": str}, keep_default_na=False,
                              na_values={name: ["NaN"] for name in ("time_s", "dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm")})
    return samples, info


def wide(samples, column="dy_mm"):
    """One column of the samples with a column per target, by frame."""
    return samples.pivot(index="frame", columns="marker", values=column)


if __name__ == "__main__":
    table, run = read(sys.argv[1])
    for name, rows in table.groupby("marker", sort=False):
        good = rows[rows.status == "ok"]
        print(f"{name}: {len(good)} of {len(rows)} ok, dy {good.dy_mm.min():+.3f} to {good.dy_mm.max():+.3f} mm, "
              f"u {good.u_dy_mm[good.u_dy_mm > 0].median():.4f} mm, {run['method']}")
