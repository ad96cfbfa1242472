"""Checks that `solve` gives the results of `measure` from the folder of a run, without the frames.

Without options the bytes are equal. With another method, lens or site the values are equal within u.
"""
import json
import shutil
import subprocess

from runs import insist, rows, simulate, start

program, work, _ = start()
FILES = ["displacement.csv", "run.json", "site.toml", "overlay.png", "run.mgj"]
run_options = ("--set", "lens.k1=-0.37")  # -1 % at the corner
simulate(program, work / "run", "small-1xyz", 12, *run_options)
frames, truth = work / "run/frames", work / "run/truth-camera.toml"
site = work / "run/site.toml"

# A site with typical survey errors: one whole reference, one grating relative to its circle, the target.
text = site.read_text()
for right, wrong in [("[-128.0, 40.0]", "[-127.0, 39.4]"), ("[-100.0, 40.0]", "[-98.6, 39.7]"), ("[0.0, 0.0]", "[0.8, -0.5]")]:
    insist(right in text, f"site.toml has no {right}")
    text = text.replace(right, wrong)
(work / "wrong.toml").write_text(text)
(work / "vague.toml").write_text(site.read_text().replace("position_mm = 1.0", "position_mm = 4.0"))


def run_well(*words):
    """Runs a command that must end with 0, or with 5: without a lens model two-stage gives `untrusted` rows."""
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    insist(done.returncode in (0, 5), f"exit {done.returncode}: {' '.join(map(str, words))}\n{done.stderr}")


def measure(name, *options):
    run_well(program, "measure", frames, "--fps", "10", "-o", work / name, *options)


def solve(name, *options):
    run_well(program, "solve", *options, "--quiet", *([] if name is None else ["-o", work / name]))


measure("precise", "--site", site, "--method", "precise")
measure("two-stage", "--site", site, "--method", "two-stage")
measure("with-lens", "--site", site, "--method", "two-stage", "--camera", truth)
measure("precise-with-lens", "--site", site, "--method", "precise", "--camera", truth)
measure("wrong-site", "--site", work / "wrong.toml", "--method", "two-stage")
measure("precise-wrong-site", "--site", work / "wrong.toml", "--method", "precise")
measure("vague-site", "--site", work / "vague.toml", "--method", "precise")
measure("rested", "--site", site, "--method", "precise", "--rest", "0:1")
measure("without-site", "--pitch", "10mm", "--method", "precise")
# There is no camera.toml for an undetermined lens: the camera hardly rotates here.
insist(not (work / "precise/camera.toml").exists(), "a camera.toml of a lens that is not determined")
measure("given-back", "--site", work / "precise-with-lens/site.toml", "--camera", truth, "--method", "precise")
shutil.rmtree(frames)


def same_bytes(a, b, files):
    for file in files:
        insist((work / a / file).read_bytes() == (work / b / file).read_bytes(), f"{a}/{file} is not {b}/{file}")


for name in ["precise", "two-stage", "without-site"]:
    files = [file for file in FILES if (work / name / file).exists()]
    insist(len(files) == (4 if name == "two-stage" else 5), f"{name} holds {files}")
    shutil.copytree(work / name, work / "before")
    solve(None, work / name)
    same_bytes(name, "before", files)
    solve("elsewhere", work / name)
    same_bytes(name, "elsewhere", files)
    for used in ["before", "elsewhere"]:
        shutil.rmtree(work / used)

solve("as-rested", work / "precise", "--rest", "0:1")
same_bytes("as-rested", "rested", ["displacement.csv", "run.json"])
insist(json.loads((work / "rested/run.json").read_text())["config"]["rest"] == {"first": 0, "end": 1, "step": 1}, "config.rest")


def numbers(name):
    read = rows(work / name, ("dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm"))
    return [tuple(map(float, row)) for row in read]


def apart(a, b, what=(0, 1)):
    return max(abs(x[k] - y[k]) for x, y in zip(numbers(a), numbers(b), strict=True) for k in what)


# No pixels are read again. The differences are of second order in the lens or the site error. Noise adds 0.1 um,
# because the windows of a new measurement have slightly other positions.
solve("lens-later", work / "two-stage", "--camera", truth)
insist(apart("lens-later", "with-lens") < 0.1 * apart("two-stage", "with-lens"), "two-stage with a lens given later")
solve("site-later", work / "wrong-site", "--site", site)
insist(apart("site-later", "two-stage") < 0.1 * apart("wrong-site", "two-stage"), "two-stage with a site given later")
solve("vague-later", work / "precise", "--site", work / "vague.toml")
# Solved from the same observations, values are equal to the last digit. Their u depends on the lens, which is hardly
# determined here (u of f is half of f). The bundle adjustment stops within 0.03 of its uncertainty.
insist(apart("vague-later", "vague-site") < 2e-6, "precise with another known_to")
insist(all(abs(x[k] - y[k]) < 0.01 * y[k] + 2e-6 for x, y in zip(numbers("vague-later"), numbers("vague-site"), strict=True) for k in (2, 3)),
       "u of precise with another known_to")


def within_u(a, b, factor=1.0):
    for x, y in zip(numbers(a), numbers(b), strict=True):
        insist(all(abs(x[k] - y[k]) <= factor * max(x[k + 2], y[k + 2]) for k in (0, 1)), f"{a}: {x}, {b}: {y}")


# Phases come from templates instead of windowed sums, and windows use other pixels. The lens is estimated from the noise of
# twelve frames. The differences are within U = 2 u.
solve("as-two-stage", work / "precise", "--method", "two-stage")
within_u("as-two-stage", "two-stage", 2.0)
solve("precise-lens-later", work / "precise", "--camera", truth)
within_u("precise-lens-later", "precise-with-lens")
solve("precise-site-later", work / "precise-wrong-site", "--site", site)
within_u("precise-site-later", "precise")
within_u("given-back", "precise-with-lens")
solve("given-back-later", work / "precise", "--site", work / "precise-with-lens/site.toml", "--camera", truth)
within_u("given-back-later", "precise-with-lens")
