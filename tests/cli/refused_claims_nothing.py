"""Checks that no undetermined value is stated.

A refused run states no camera and no errors of gratings. No run states a camera with a focal length that is uncertain
by more than 10 %. All outputs treat a step of one of four references in the same way.
"""
import json
import re
import subprocess

from runs import insist, run, simulate, start

program, work, _ = start()


def measure(name, *options):
    done = subprocess.run([str(word) for word in (program, "measure", work / name / "frames", "--site", work / name / "site.toml", "--fps", "10", "-o", work / f"{name}-out", *options)],
                          capture_output=True, text=True, check=False)
    folder = work / f"{name}-out"
    page = (folder / "report.html").read_text()
    report = json.loads(re.search(r'id="report">(.*?)</script>', page, re.DOTALL).group(1).replace("<\\/", "</"))
    return done, folder, json.loads((folder / "run.json").read_text()), report


def insist_no_camera(what, done, folder, run_json, report):
    said = done.stdout + done.stderr + " ".join(report["summary"] + report["advice"] + report["warnings"])
    insist(not re.search(r"rolling shutter|camera turn|lens was|lens is", said, re.IGNORECASE), f"{what} claims: {said}")
    insist(not (folder / "camera.toml").exists(), f"{what} writes camera.toml")
    camera = run_json["camera"]
    insist(camera["model"] == "none" and camera["fx"] is None and camera["u"] == {}, f"{what}: {camera}")
    insist(run_json["scene"]["readout_s"] is None, f"{what} has a readout time")
    insist(report["camera"]["pan"] is None and report["camera"]["roll"] is None, f"{what} draws turns")


# A step of 0.5 mm of one of four references after 0.5 s. It resembles a rolling shutter with a rotation of 11 degrees.
simulate(program, work / "slip", "small-1xyz", 12, "--set", "marker.NE.dy.knots=[[0, 0], [0.52, 0], [0.53, 0.5]]")
done, folder, run_json, report = measure("slip")
insist(done.returncode == 4, f"exit {done.returncode}")
insist_no_camera("slip", done, folder, run_json, report)
insist(not (folder / "site.toml").exists(), "a refused run writes site.toml")
insist(all(marker["u"] == {} for marker in run_json["markers"]), "a refused run states markers")
for place, text in [("warning", " ".join(run_json["warnings"])), ("error", done.stderr.splitlines()[-1]), ("next", done.stdout.splitlines()[-1]), ("advice", " ".join(report["advice"]))]:
    insist("easure the frames before the movement with --frames 0:6" in text, f"{place}: {text}")
    insist("--camera" not in text and "overlay.png" not in text, f"{place}: {text}")
run([program, "measure", work / "slip/frames", "--site", work / "slip/site.toml", "--fps", "10", "--frames", "0:6", "-o", work / "before", "--quiet"])

# A lens with distortion on a camera that hardly rotates: the distortion is determined, the focal length is not.
simulate(program, work / "calm", "small-0.1x", 12, "--set", "lens.k1=-0.37")
done, folder, run_json, report = measure("calm")
insist(done.returncode == 0, f"exit {done.returncode}: {done.stderr}")
insist("radial" in run_json["scene"]["model"], f"the lens does not show: {run_json['scene']['model']}")
insist(run_json["camera"]["model"] == "none" and not (folder / "camera.toml").exists(), f"a camera is stated: {run_json['camera']}")
insist(not any("turned by" in sentence for sentence in report["summary"]), f"a turn is stated: {report['summary']}")
