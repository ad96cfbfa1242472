#!/usr/bin/python3
"""Exports a run with two targets, one of them covered in some frames, in all formats, and reads the files.

The readers are pandas, h5py, Octave, universal_file.py and those in examples/.
"""
import json
import math
import subprocess
import sys
import time

import h5py
import openpyxl
import pandas

import runs
import universal_file

program, work, source = runs.start()
sys.path.insert(0, str(source / "examples"))
import read_moiregauge  # noqa: E402


def scenario():
    """Returns the small rig with two targets."""
    text = []
    for name, x, y in (("NW", -1, 1), ("NE", 1, 1), ("SW", -1, -1), ("SE", 1, -1)):
        text.append(f'[[marker]]\nname = "{name}"\nrole = "reference"\ncircle_mm = [{128 * x}, {40 * y}]\n'
                    f'circle_diameter_mm = 16\ngrating_mm = [{100 * x}, {40 * y}]\ngrating_size_mm = [30, 30]\npitch_mm = 10\n')
    for name, x in (("mid left", -30), ("right", 30)):
        text.append(f'[[marker]]\nname = "{name}"\nrole = "target"\ngrating_mm = [{x}, 0]\ngrating_size_mm = [40, 40]\n'
                    'pitch_mm = 10\n[marker.dy]\nknots = [[0, 0], [1, 1]]\n')
    text[-1] += '[marker.cover]\nframes = [[5, 8]]\n'
    return 'base = "small-1xyz"\nframes = 14\n' + "".join(text)


(work / "two.toml").write_text(scenario())
runs.run([program, "simulate", work / "two.toml", "--markers-only", "--quiet", "-o", work / "run"])
folder = work / "out"
done = subprocess.run([program, "measure", work / "run", "--site", work / "run" / "site.toml", "--fps", "10", "--quiet", "-o", folder],
                      capture_output=True, text=True, check=False)
runs.insist(done.returncode == 5, f"exit {done.returncode}: {done.stderr}")


def export(name, *words, expected=0):
    out = work / name
    return out, runs.run([program, "export", folder, "-o", out, *words], expected)


def same(a, b):
    return (math.isnan(a) and math.isnan(b)) or a == b


samples, info = read_moiregauge.read(folder)
runs.insist(list(samples.marker.unique()) == ["mid left", "right"] and len(samples) == 28, f"{samples}")
runs.insist(samples.dtypes["dx_mm"] == float and info["method"] == "precise", f"{samples.dtypes}")
right = samples[samples.marker == "right"]
lost = right[right.dy_mm.isna()]
runs.insist(list(lost.frame) == [5, 6, 7], f"not measured: {lost}")

# CSV: the long format is displacement.csv, the wide format is a matrix.
long_csv, _ = export("long.csv", "--format", "long")
runs.insist(long_csv.read_bytes() == (folder / "displacement.csv").read_bytes(), "long is not displacement.csv")
wide_csv, _ = export("wide.csv")
table = pandas.read_csv(wide_csv)
runs.insist(list(table.columns[:7]) == ["frame", "time_s", "mid left_dx_mm", "mid left_dy_mm", "mid left_u_dx_mm", "mid left_u_dy_mm",
                                        "mid left_ok"], f"{table.columns}")
runs.insist(len(table) == 14 and all(same(a, b) for a, b in zip(table.right_dy_mm, right.dy_mm)), f"{table.right_dy_mm}")
runs.insist(list(table.right_ok) == [int(s == "ok") for s in right.status], f"{table.right_ok}")

# HDF5.
h5, _ = export("all.h5", "--format", "hdf5")
with h5py.File(h5) as file, h5py.File(folder / "displacement.h5") as first:
    runs.insist(sorted(file) == sorted(first) == ["mid left", "right"], f"{list(file)}")
    runs.insist(dict(file.attrs) == dict(first.attrs), f"{dict(file.attrs)} {dict(first.attrs)}")
    for name in file["right"]:
        a, b = file["right"][name][:], first["right"][name][:]
        close = [x == y or (x != x and y != y) or abs(x - y) < 6e-7 for x, y in zip(a.tolist(), b.tolist())] if name != "status" else a == b
        runs.insist(all(close), f"{name}: {a} {b}")

# Decimal comma, one axis.
vertical, _ = export("vertical.csv", "--format", "csv", "--axis", "y", "--decimal-comma")
table = pandas.read_csv(vertical, sep=";", decimal=",")
runs.insist(list(table.columns) == ["frame", "time_s", *(f"{m}_{c}" for m in ("mid left", "right") for c in ("dy_mm", "u_dy_mm", "ok"))],
            f"{table.columns}")
runs.insist(all(same(a, b) for a, b in zip(table.right_dy_mm, right.dy_mm)) and table.time_s.iloc[1] == 0.1, f"{table.right_dy_mm}")
tabbed, _ = export("tabs.csv", "--separator", "tab")
runs.insist(pandas.read_csv(tabbed, sep="\t").equals(pandas.read_csv(wide_csv)), "--separator tab")

# Workbook: cells without a value are #N/A, as a spreadsheet needs. The same run gives the same bytes.
xlsx, _ = export("all.xlsx", "--format", "xlsx")
book = openpyxl.load_workbook(xlsx)
runs.insist(book.sheetnames == ["displacement", "run"], f"{book.sheetnames}")
cells = list(book["displacement"].values)
runs.insist(list(cells[0]) == list(pandas.read_csv(wide_csv).columns) and len(cells) == 15, f"{cells[0]}")
column = cells[0].index("right_dy_mm")
runs.insist([row[column] for row in cells[6:9]] == ["=NA()"] * 3, f"{cells[6:9]}")
read = pandas.read_excel(xlsx, sheet_name="displacement")
runs.insist(all(same(float(a), b) for a, b in zip(read.right_dy_mm, right.dy_mm)), f"{read.right_dy_mm}")
facts = {row[0]: row[1] for row in book["run"].values}
runs.insist(facts["method"] == "precise" and facts["input_sha256"] == info["input"]["sha256"], f"{facts}")
time.sleep(2.1)  # a ZIP archive has times in steps of 2 s
again, _ = export("again.xlsx", "--format", "xlsx")
runs.insist(again.read_bytes() == xlsx.read_bytes(), "the same run, another workbook")
mat, _ = export("all.mat", "--format", "mat")
vertical_mat, _ = export("vertical.mat", "--format", "mat", "--axis", "y", "--markers", "right")

# Selections.
part, _ = export("part.csv", "--format", "long", "--markers", "right", "--time", "0.3:0.6", "--only-ok")
rows = pandas.read_csv(part)
runs.insist(list(rows.frame) == [3, 4, 5] and set(rows.marker) == {"right"}, f"{rows}")

# UFF 58 cannot represent gaps. With --gaps split no values are invented.
_, refused = export("gaps.uff", "--format", "uff58", expected=2)
runs.insist("right dx (11 of 14 samples" in refused.stderr and not (work / "gaps.uff").exists(), refused.stderr)
uff, _ = export("split.uff", "--format", "uff58", "--gaps", "split")
found = universal_file.datasets(uff.read_text(encoding="ascii"))
runs.insist([number for number, _ in found] == [164, 15] + [58] * 6, f"{[n for n, _ in found]}")
units = universal_file.units(found[0][1])
runs.insist(units["code"] == 5 and units["factors"] == [1000.0, 1000.0, 1.0] and abs(units["offset"] - 273.15) < 1e-9, f"{units}")
nodes = universal_file.nodes(found[1][1])
runs.insist(abs(nodes[1][0] + 30) < 2 and abs(nodes[2][0] - 30) < 2, f"{nodes}")
functions = [universal_file.function(lines) for _, lines in found[2:]]
for f in functions:
    runs.insist((f["type"], f["precision"], f["even"]) == (1, 4, 1), f"{f}")
    runs.insist(f["abscissa"]["kind"] == 17 and f["abscissa"]["unit"] == "s", f"{f['abscissa']}")
    runs.insist(f["ordinate"]["kind"] == 8 and f["ordinate"]["exponents"] == (1, 0, 0) and f["ordinate"]["unit"] == "mm", f"{f['ordinate']}")
for node, name in ((1, "mid left"), (2, "right")):
    for direction, column in ((1, "dx_mm"), (2, "dy_mm")):
        stretches = [f for f in functions if f["node"] == node and f["direction"] == direction]
        runs.insist([f["version"] for f in stretches] == list(range(1, len(stretches) + 1)), f"{stretches}")
        got = {round(t, 5): y for f in stretches for t, y in zip(f["t"], f["y"])}
        rows = samples[(samples.marker == name) & samples[column].notna()]
        wanted = dict(zip(rows.time_s.round(5), rows[column]))
        runs.insist(got == wanted, f"{name} {column}: {got} {wanted}")
runs.insist(len([f for f in functions if f["node"] == 2]) == 4, "the covered target's axes are in two stretches each")
# Without a gap there is one series per component. At uneven times each sample has its own time.
whole, _ = export("whole.uff", "--format", "uff58", "--time", ":0.5")
runs.insist(len([1 for n, _ in universal_file.datasets(whole.read_text()) if n == 58]) == 4, "four whole series")
uneven = work / "uneven"
uneven.mkdir()
(uneven / "run.json").write_text((folder / "run.json").read_text())
lines = (folder / "displacement.csv").read_text().splitlines(keepends=True)
(uneven / "displacement.csv").write_text("".join(line.replace(",0.300000,", ",0.320000,") for line in lines))
runs.run([program, "export", uneven, "--format", "uff58", "--time", ":0.5", "-o", work / "uneven.uff"])
function = universal_file.function(universal_file.datasets((work / "uneven.uff").read_text())[2][1])
runs.insist(function["even"] == 0 and function["t"] == [0.0, 0.1, 0.2, 0.32, 0.4], f"{function}")

# Octave: examples/read_moiregauge.m, and HDF5 by `load`.
script = f"""
addpath('{source}/examples');
run = read_moiregauge('{folder}');
assert(numel(run.targets) == 2);
left = run.targets(1); right = run.targets(2);
assert(strcmp(left.name, 'mid left') && strcmp(right.name, 'right'));
assert(isequal(find(isnan(right.dy_mm))', [6 7 8]));
assert(isequal(left.frame', 0:13) && abs(left.time_s(end) - 1.3) < 1e-9);
assert(islogical(right.ok) && all(left.ok) && strcmp(run.info.method, 'precise'));
printf('%.6f %.6f\\n', [left.dx_mm left.dy_mm]');
m = load('{mat}');
assert(isequal(m.frame', 0:13) && abs(m.time_s(end) - 1.3) < 1e-9 && strcmp(m.method, 'precise'));
assert(numel(m.targets) == 2 && strcmp(m.targets(1).name, 'mid left') && strcmp(m.targets(2).name, 'right'));
assert(isequal(isnan(m.targets(2).dy_mm), isnan(right.dy_mm)) && max(abs(m.targets(2).dy_mm - right.dy_mm)) < 1e-12);
assert(max(abs(m.targets(1).u_dx_mm - left.u_dx_mm)) < 1e-12);
assert(isequal(find(m.targets(2).ok == 0)', find(! right.ok)'));
v = load('{vertical_mat}');
assert(numel(v.targets) == 1 && isfield(v.targets, 'dy_mm') && ! isfield(v.targets, 'dx_mm'));
s = load('{h5}');
assert(abs(s.right.dy_mm(end) - right.dy_mm(end)) < 1e-6);
"""
done = subprocess.run(["octave-cli", "--no-gui", "--norc", "--eval", script], capture_output=True, text=True, check=False)
runs.insist(done.returncode == 0, f"octave: {done.stdout}{done.stderr}")
octave = [tuple(float(v) for v in line.split()) for line in done.stdout.split("\n") if line]
left = samples[samples.marker == "mid left"]
runs.insist(octave == list(zip(left.dx_mm, left.dy_mm)), f"octave read {octave}")
shown = subprocess.run(["/usr/bin/python3", source / "examples" / "read_moiregauge.py", folder], capture_output=True, text=True, check=True)
runs.insist("right: " in shown.stdout and json.dumps(info["method"]).strip('"') in shown.stdout, shown.stdout)
sys.exit(0)
