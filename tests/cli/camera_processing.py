#!/usr/bin/python3
"""Checks processing in the camera that causes errors without noise: wrong rows must not be `ok`.

A target in front of a fixed camera moves up and down by 1 mm and creeps by 0.12 mm to the right. Errors are relative to
truth.csv.
"""
import csv

import runs

program, work, _ = runs.start()
MOVING = ["marker.mid.dx.knots=[[0, 0], [4, 0.12]]", "noise.sigma=0.8"]
RESTING = ["marker.mid.dy.scale=0", "marker.mid.dx.scale=0", "noise.sigma=0.8"]

# Movement in one direction by 0.22, 0.27 and 0.41 px per frame.
ONE_WAY = {f"one-way-{speed}": [f"marker.mid.dx.knots=[[0, 0], [4, {4 * speed}]]", "marker.mid.dy.scale=0", "noise.sigma=0.8"]
           for speed in (0.8, 1.0, 1.5)}
# Movement by 0.8 px per frame, in frames that are JPEGs. Their edges alone show a share.
JPEG = ["marker.mid.dx.knots=[[0, 0], [4, 12]]", "marker.mid.dy.scale=0", "noise.sigma=1.5"]


# Vibration of six frames per period, by up to 4.5 px per frame, and one by up to 0.9 px per frame.
VIBRATING = ["noise.sigma=0.8", "marker.mid.dy.knots=[[0, 0]]", "marker.mid.dy.amplitude=1.5", "marker.mid.dy.frequency_hz=1.63"]
AT_ONE_PIXEL = ["marker.mid.dy.knots=[[0, 0]]", "marker.mid.dy.amplitude=0.4", "marker.mid.dy.frequency_hz=1.2"]


clips = {}  # settings and codec -> folder


def simulated(name, settings):
    """Returns the folder of a clip, which all its filters share."""
    codec = "mjpeg" if name.startswith("jpeg") else "ffv1"
    key = (codec, *settings)
    if key not in clips:
        clips[key] = work / name
        runs.run([program, "simulate", "small-still", "--frames", 40, "--markers-only", "--codec", codec, "-o", clips[key],
                  *[word for setting in settings for word in ("--set", setting)]])
    return clips[key]


def measured(name, settings, video_filter=None, expected=0, codec_of_filter=("-c:v", "ffv1")):
    """Returns the numbers of ok, untrusted and wrong ok rows, and stderr."""
    clip = simulated(name, settings)
    video = clip / "video.mkv"
    if video_filter:
        processed = work / f"{name}.mkv"
        runs.run(["ffmpeg", "-nostdin", "-loglevel", "error", "-i", video, "-vf", video_filter, *codec_of_filter, processed])
        video = processed
    said = runs.run([program, "measure", video, "--site", clip / "site.toml", "-o", work / f"{name}-out"], expected).stderr
    with open(clip / "truth.csv", encoding="ascii") as file:
        truth = {(r["frame"], r["marker"]): r for r in csv.DictReader(file)}
    ok, untrusted, lies = 0, 0, 0
    for frame, marker, dx, dy, u_dx, u_dy, status in runs.rows(work / f"{name}-out"):
        ok += status == "ok"
        untrusted += status == "untrusted"
        if status != "ok":
            continue
        true = truth[frame, marker]
        for is_, u, axis in ((dx, u_dx, "dx_mm"), (dy, u_dy, "dy_mm")):
            if abs(float(is_) - float(true[axis])) > max(5 * float(u), 0.0005):
                lies += 1
    return ok, untrusted, lies, said


for name, settings, video_filter in (
        ("as-it-is", MOVING, None),
        ("at-rest", RESTING + ["processing.recursion=0.6"], None),
        ("jpeg", JPEG, None),
        *((name, settings, None) for name, settings in ONE_WAY.items())):
    ok, untrusted, lies, said = measured(name, settings, video_filter)
    runs.insist(ok == 40 and lies == 0, f"{name}: {ok} ok, {lies} wrong\n{said}")
    print(name, ok, untrusted, lies)

for name, settings, video_filter, word in (
        ("recursion", MOVING + ["processing.recursion=0.3"], None, "averages over time"),
        ("small-share", MOVING + ["processing.recursion=0.1"], None, "of the previous frame"),
        *((f"{name}-share", settings + ["processing.recursion=0.1"], None, "of the previous frame") for name, settings in ONE_WAY.items()),
        ("jpeg-share", JPEG + ["processing.recursion=0.1"], None, "of the previous frame"),
        ("mean-of-three", MOVING, "tmix=frames=3", "averages over time"),
        ("denoised", MOVING, "hqdn3d=4:3:20:15", "averages over time"),
        ("equalised", MOVING, "histeq", "tone curve has a step"),
        ("doubled", MOVING, "scale=2048:1024:flags=neighbor", "repeating pixels"),
        ("enlarged", MOVING, "scale=1408:704:flags=neighbor", "repeating pixels")):
    ok, untrusted, lies, said = measured(name, settings, video_filter, expected=4)
    runs.insist(ok <= 1 and lies == 0 and word in said, f"{name}: {ok} ok, {lies} wrong\n{said}")
    print(name, ok, untrusted, lies)

# A codec that predicts frames removes the noise. Gratings that move still show an average.
for name, settings, average, expected, word in (
        ("h264", VIBRATING, "null", 0, ""),
        ("h264-edges", VIBRATING, "tmix=frames=3:weights='1 2 4'", 4, "of the previous frame"),
        ("h264-both-sides", VIBRATING, "tmix=frames=3", 4, "of the images before and after"),
        ("h264-longest-exposure", VIBRATING + ["sensor.exposure_s=0.1"], "null", 0, ""),
        ("h264-slow", ["noise.sigma=0.8", *AT_ONE_PIXEL], "null", 0, ""),
        ("h264-blur", ["noise.sigma=0.8", *AT_ONE_PIXEL], "tmix=frames=3", 4, "blur grows with movement")):
    ok, untrusted, lies, said = measured(name, settings, average, expected, ("-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p"))
    runs.insist(lies == 0 and (ok == 40 if expected == 0 else ok <= 1) and word in said, f"{name}: {ok} ok, {lies} wrong\n{said}")
    print(name, ok, untrusted, lies)

# The frames between the selected ones are observed as long as the tests need them.
for clip, options, expected, word in (
        ("small-share", ("--frames", "0:40:2"), 4, "of the previous frame"),
        ("small-share", ("--frames", "0:40:7"), 4, "of the previous frame"),
        ("recursion", ("--frames", "0:40:2", "--method", "two-stage"), 4, "averages over time"),
        ("as-it-is", ("--frames", "0:40:2"), 0, "20 of 20"),
        # Methods that read no templates use them for this test alone.
        ("small-share", ("--method", "two-stage"), 4, "of the previous frame"),
        ("small-share", ("--method", "conventional"), 4, "of the previous frame"),
        ("jpeg-share", ("--method", "two-stage"), 4, "of the previous frame"),
        ("as-it-is", ("--method", "two-stage"), 0, "40 of 40"),
        ("as-it-is", ("--method", "conventional"), 0, "40 of 40")):
    out = work / "-".join(["skips", clip, *options])
    ran = runs.run([program, "measure", work / clip / "video.mkv", "--site", work / clip / "site.toml", *options, "-o", out], expected)
    runs.insist(word in ran.stdout + ran.stderr, f"{clip} {options}: {ran.stderr}")
    print(clip, *options, word)

# A strong average in front of a moving camera looks like a moving reference. The proven cause is the one to act on.
clip = work / "moving-camera"
runs.run([program, "simulate", "small-1xyz", "--frames", 24, "--codec", "ffv1", "--set", "processing.recursion=0.6", "-o", clip])
ran = runs.run([program, "measure", clip / "video.mkv", "--site", clip / "site.toml", "-o", work / "moving-camera-out"], 4)
last = [line for line in ran.stderr.splitlines() if line.startswith("error: ")][-1]
runs.insist("one of the references moves" in ran.stderr and "noise reduction off" in last, ran.stderr)

# Gratings whose residuals differ in structure, moving by half a pixel per frame in one direction.
clip = work / "lens"
runs.run([program, "simulate", "rig-1xyz", "--frames", 20, "--markers-only", "--seed", 16, "-o", clip, *[word for setting in (
    "lens.k1=-0.0451", "lens.p1=0.0005", "lens.p2=-0.0005", "sensor.fps=10", "truth.draw_known_to=true") for word in ("--set", setting)]])
site = clip / "site.toml"
site.write_text(site.read_text().split("[known_to]")[0])
ran = runs.run([program, "measure", clip / "frames", "--site", site, "--fps", 10, "-o", work / "lens-out"])
runs.insist("20 of 20" in ran.stdout, ran.stdout + ran.stderr)

# Clean recordings of a moving camera. The blur of a vibration of four frames per period returns with its phase. Among small circles
# and fine dots no tile is flat, and edges change twice as much in two frames as in one.
for name, frames, settings in (
        ("fast-vibration", 40, ["noise.sigma=0.8", "sensor.exposure_s=0.1", "marker.mid.dy.knots=[[0, 0]]",
                                "marker.mid.dy.amplitude=0.3", "marker.mid.dy.frequency_hz=2.45"]),
        ("small-circles", 30, ["noise.sigma=0.4", "sensor.defocus_px=0.8", *[
            f"marker.{marker}.{setting}" for marker in ("NW", "NE", "SW", "SE")
            for setting in ("circle_diameter_mm=8", "pattern=dots", "pitch_mm=4")]])):
    clip = work / name
    runs.run([program, "simulate", "small-1xyz", "--frames", frames, "--markers-only", "-o", clip,
              *[word for setting in settings for word in ("--set", setting)]])
    ran = runs.run([program, "measure", clip / "frames", "--site", clip / "site.toml", "--fps", 10, "-o", work / f"{name}-out"])
    runs.insist(f"{frames} of {frames}" in ran.stdout and "averages" not in ran.stderr, ran.stdout + ran.stderr)
    print(name, frames)
