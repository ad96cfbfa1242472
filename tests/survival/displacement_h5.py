"""Checks that displacement.h5 has the values of displacement.csv, its metadata, and always the same bytes."""
import csv
import json
import time

import h5py
import numpy

from survival import contents, insist, long_clip, run, start

program, work, _ = start()
clip, site = long_clip(program, work, 5)
text = site.read_text().replace('name = "mid"', 'name = "mid span Ü"')
site.write_text(text)
out = work / "out"
plain = [program, "measure", clip, "--site", site, "--quiet", "-o", out]
run(plain)
about = json.loads((out / "run.json").read_text())
with open(out / "displacement.csv", newline="", encoding="utf-8") as file:
    rows = list(csv.DictReader(file))
with h5py.File(out / "displacement.h5") as file:
    insist(list(file) == ["mid span Ü"], list(file))
    for name, value in [("moiregauge", about["moiregauge"]), ("method", "precise"), ("input", str(clip)),
                        ("input_sha256", about["input"]["sha256"])]:
        insist(file.attrs[name].decode() == value, f"{name}: {file.attrs[name]}")
    insist(file.attrs["reference_frame"] == 0 and file.attrs["complete"] == 1, dict(file.attrs))
    group = file["mid span Ü"]
    insist(group.attrs["marker"].decode() == "mid span Ü", group.attrs["marker"])
    insist(group["frame"][:].tolist() == [int(row["frame"]) for row in rows], "frame")
    insist(group["frame"].dtype == numpy.int64, "frame")
    insist(numpy.isnan(group["time_s"][:]).all() and group["time_s"].attrs["unit"].decode() == "s", "time_s")
    for name in ("dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm"):
        insist(group[name].attrs["unit"].decode() == "mm" and group[name].ndim == 1, name)
        for value, row in zip(group[name][:], rows, strict=True):
            insist(f"{value:.6f}" == row[name] or abs(value - float(row[name])) < 5.1e-7, f"{name}: {value}, {row[name]}")
    insist([word.decode() for word in group["status"][:]] == [row["status"] for row in rows], "status")
before = contents(out)
time.sleep(1.1)  # HDF5 stores times in whole seconds
run(plain)
insist(contents(out) == before, "the same run, other bytes")
run([program, "solve", out, "--quiet"])
insist(contents(out) == before, "solved again, other bytes")
