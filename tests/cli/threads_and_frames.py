"""Checks that results do not depend on threads, SIMD targets and selected frames, and that a run can be repeated."""
import os
import subprocess

from runs import insist, rows, run, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-1xyz", 9)
simulate(program, work / "again", "small-1xyz", 9, "--threads", "1")
for path in sorted((work / "run/frames").iterdir()):
    insist(path.read_bytes() == (work / "again/frames" / path.name).read_bytes(), f"{path.name} depends on threads")
base = [program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", "10"]
run([*base, "-o", work / "all"])
run([*base, "--threads", "1", "-o", work / "one"])
insist((work / "all/displacement.csv").read_bytes() == (work / "one/displacement.csv").read_bytes(), "threads change the CSV")
run([*base, "--threads", "2", "-o", work / "two"])
insist((work / "all/displacement.csv").read_bytes() == (work / "two/displacement.csv").read_bytes(), "threads change the CSV")
for simd in ("scalar", "avx2", "avx3"):  # avx3: AVX-512
    os.environ["MOIREGAUGE_SIMD"] = simd
    here = subprocess.run([program, "--version"], capture_output=True, check=False).returncode == 0
    insist(here or simd != "scalar", "no scalar loops")
    if here:
        run([*base, "-o", work / simd])
    os.environ.pop("MOIREGAUGE_SIMD")
    if here:
        insist((work / "all/displacement.csv").read_bytes() == (work / simd / "displacement.csv").read_bytes(),
               f"{simd} changes the CSV")
run([*base, "-o", work / "all"])  # the same input: all results are replaced
short = ("frame", "dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm")


def selected(method):
    """Returns pairs of rows of every fourth frame: from a run of these frames, and from a run of all."""
    run([*base, "--method", method, "-o", work / f"{method}-all"])
    run([*base, "--method", method, "--frames", "0:9:4", "-o", work / f"{method}-some"])
    wanted = [row for row in rows(work / f"{method}-all", short) if int(row[0]) % 4 == 0]
    pairs = list(zip(rows(work / f"{method}-some", short), wanted, strict=True))
    insist(len(pairs) == 3 and all(got[0] == want[0] for got, want in pairs), f"{method}: other frames")
    return [tuple(tuple(map(float, row[1:])) for row in pair) for pair in pairs]


for got, want in selected("two-stage"):
    # The fit of a circle starts from its position in the last frame, which changes it by less than 1e-4 px (35 nm
    # here).
    insist(all(abs(a - b) < 1e-4 for a, b in zip(got[:2], want[:2])), f"{got} is not {want}")
for got, want in selected("precise"):
    # The scene is solved from the selected frames, so values may differ within u.
    insist(all(abs(got[k] - want[k]) <= max(got[k + 2], want[k + 2]) for k in (0, 1)), f"{got} is not {want}")
run([*base, "--reference-frame", "8", "-o", work / "last"])
last = {row[0]: row for row in rows(work / "last", ("frame", "dx_mm", "dy_mm", "status"))}
insist(last["8"] == ("8", "0.000000", "0.000000", "ok"), f"the reference frame is not zero: {last['8']}")
