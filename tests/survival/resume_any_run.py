"""Checks that a resumed run gives the bytes of an uninterrupted run, for all methods, several options and inputs."""
import shutil

from survival import FRAMES, Records, with_suffix, clear, contents, done, insist, insist_same, run, simulate, start

program, work, _ = start()
simulate(program, work / "run", "small-1xyz", FRAMES)
frames, site, camera = work / "run/frames", work / "run/site.toml", work / "run/truth-camera.toml"
late = work / "late"  # two grey frames first: the reference frame is the third
late.mkdir()
run(["ffmpeg", "-loglevel", "error", "-f", "lavfi", "-i", "color=gray:size=1024x512", "-frames:v", "2", late / "%d.png"])
for path in sorted(frames.iterdir()):
    shutil.copy(path, late / f"f{path.name}")
clip, cut, holed = work / "clip.mkv", work / "cut.mkv", work / "holed.avi"
encode = ["ffmpeg", "-loglevel", "error", "-framerate", "10", "-i", frames / "%06d.png"]
run([*encode, "-c:v", "ffv1", "-pix_fmt", "gray", clip])
cut.write_bytes(clip.read_bytes()[:clip.stat().st_size * 6 // 10])
run([*encode, "-c:v", "mjpeg", "-q:v", "2", "-pix_fmt", "yuvj420p", holed])
data = bytearray(holed.read_bytes())
data[len(data) // 2:len(data) // 2 + 3000] = bytes(3000)
holed.write_bytes(data)

RUNS = {
    "by default": [frames, "--site", site],
    "two-stage": [frames, "--site", site, "--method", "two-stage", "--fps", "10"],
    "conventional": [frames, "--site", site, "--method", "conventional"],
    "without a site": [frames, "--pitch", "10mm", "--axes", "image"],
    "a selection": [frames, "--site", site, "--frames", "2:11:2", "--reference-frame", "1"],
    "the last frame as reference": [frames, "--site", site, "--reference-frame", FRAMES - 1],
    "a camera and rest": [frames, "--site", site, "--camera", camera, "--rest", "0:1"],
    "frames before the reference frame": [late, "--pitch", "10mm"],
    "those, with a site": [late, "--site", site, "--method", "two-stage"],
    "a video": [clip, "--site", site],
    "a video that was cut off": [cut, "--site", site, "--method", "two-stage"],
    "a video with a hole": [holed, "--site", site],
    "stabilised": [frames, "--site", site, "--stabilised", work / "still"],
}
out, still = work / "out", work / "still"
for what, words in RUNS.items():
    command = [str(word) for word in (program, "measure", *words, "--quiet", "-o", out)]
    first = done(command)
    insist(first.returncode in (0, 4, 5), f"{what}: exit {first.returncode}: {first.stderr}")
    wanted, pictures = contents(out), contents(still)
    records = Records(wanted["run.mgj"])
    places = [end for tag, end in zip(records.tags, records.ends) if tag == "OBSV"]
    insist(len(places) > 2, f"{what}: {len(places)} frames")
    for place in (places[0], places[len(places) // 2], places[-1]):
        clear(out)
        shutil.rmtree(still, ignore_errors=True)
        with_suffix(out, ".unfinished").mkdir()
        (with_suffix(out, ".unfinished") / "run.mgj").write_bytes(wanted["run.mgj"][:place + 5])
        again = done([*command, "--resume"])
        insist((again.returncode, again.stderr) == (first.returncode, first.stderr), f"{what}: {again.returncode}: {again.stderr}")
        insist_same(out, wanted, what)
        insist(contents(still) == pictures, f"{what}: stabilised pictures")
    clear(out)
    shutil.rmtree(still, ignore_errors=True)
