#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the types: types_test.py PACKAGE_FOLDER. mypy checks the package and a user's script, stubtest compares the stub of the
compiled module with the module."""
import os
import pathlib
import subprocess
import sys
import tempfile

USE = '''import moiregauge

run = moiregauge.measure("clip.mp4", pitch="10mm", on_progress=lambda done, expected: None)
total: float = float(run["T1"].dy.sum() + 2 * run["T1"].u_dy.sum())
channel: moiregauge.Channel = run.derive("T2.dy - T1.dy")
several: dict[str, moiregauge.Channel] = run.derive("a = T1.dy", "b = T2.dy", filter="lowpass:5Hz")
names: list[str] = [marker.name for marker in moiregauge.inspect("clip.mp4", pitch_mm=10).markers]
tracker = moiregauge.Tracker(pitch="10mm")
for number, image in enumerate(moiregauge.simulate("small-1xyz", frames=3)):
    status: str = tracker.update(image, number * 0.1)["T1"].status
'''
WRONG = '''import moiregauge

moiregauge.measure("clip.mp4", pitch=10)
moiregauge.measure("clip.mp4", pich="10mm")
moiregauge.Tracker(pitch="10mm").update("image", 0.0)
'''


def run(*words, expected=0, **how):
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False, **how)
    if (done.returncode == 0) != (expected == 0):
        sys.exit(f"{' '.join(words)}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def main():
    package = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(prefix="moiregauge-types-") as folder:
        work = pathlib.Path(folder)
        (work / "use.py").write_text(USE)
        (work / "wrong.py").write_text(WRONG)
        (work / "mypy.ini").write_text("[mypy]\nstrict = True\ncache_dir = cache\n[mypy-pandas.*]\nignore_missing_imports = True\n")
        environment = {**os.environ, "MYPYPATH": str(package), "PYTHONPATH": str(package)}
        how = {"cwd": work, "env": environment}
        print(run("-m", "mypy", "-p", "moiregauge", **how).strip())
        print(run("-m", "mypy", "use.py", **how).strip())
        complaints = run("-m", "mypy", "wrong.py", expected=1, **how)
        assert complaints.count("error:") == 3, complaints
        # Classes of pybind11 have a metaclass and an __init__ of their own, which a stub does not show.
        (work / "allowed").write_text(r"moiregauge\._core\.[A-Z]\w+(\.__init__)?" + "\n")
        print(run("-m", "mypy.stubtest", "moiregauge._core", "--mypy-config-file", "mypy.ini", "--allowlist", "allowed", **how).strip())


if __name__ == "__main__":
    main()
