"""Tests damaged and hostile input, cases 1 to 14: damaged_input.py PROGRAM WORK SOURCE CASE.

The function of a case contains its requirements.
"""
import ctypes
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import time
import zlib

import numpy
import pictures
import runs
from runs import insist, rows, run, simulate, tag_rotation

program, work, _ = runs.start()
H264 = ["-pix_fmt", "yuv420p", "-c:v", "libx264", "-g", "8", "-bf", "2", "-qp", "8", "-threads", "1", "-bitexact"]


def clip(name, how, frames=24):
    """Makes a small simulated video with 25 frames/s, and its site. Returns the path of the video."""
    if not (work / "run").exists():
        simulate(program, work / "run", "small-1xyz", frames)
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", "25", "-i", work / "run/frames/%06d.png", *how, work / name])
    return work / name


def measure(path, expected, *more):
    """Measures with two-stage, in which frames do not affect each other."""
    return run([program, "measure", path, "--site", work / "run/site.toml", "--method", "two-stage", "-o", out_of(path), *more],
               expected)


def out_of(path):
    return work / (pathlib.Path(path).name + ".out")


def refuse(path, words, *more):
    """Checks that measure ends with exit 3 and one error line, and writes nothing. `words`: a text in it, or a tuple of two."""
    done = run([program, "measure", path, "--pitch", "10mm", "-o", out_of(path), *more], 3)
    lines = done.stderr.splitlines()
    either = words if isinstance(words, tuple) else (words,)
    insist(len(lines) == 1 and lines[0].startswith("error: ") and any(word in lines[0] for word in either), f"{path}: {done.stderr}, not {words}")
    insist(not out_of(path).exists(), f"{path}: something was written")


def says(done, pattern):
    found = re.search(pattern, done.stderr, re.MULTILINE)
    insist(found, f"stderr lacks {pattern}:\n{done.stderr}")
    return found


def states(path):
    return [row[-1] for row in rows(out_of(path))]


def luma(path):
    """Returns all frames that ffmpeg decodes, with or without errors."""
    done = subprocess.run(["ffmpeg", "-nostdin", "-loglevel", "quiet", "-i", str(path), "-vf", "extractplanes=y", "-vsync",
                           "passthrough", "-f", "rawvideo", "-"], capture_output=True, check=False)
    return numpy.frombuffer(done.stdout, numpy.uint8).reshape(-1, 512, 1024)


def run_json(path):
    return json.loads((out_of(path) / "run.json").read_text())


def insist_incomplete(path):
    reported = run_json(path)
    insist(reported["exit_code"] == 5 and reported["complete"] is False, f"{path}: run.json does not say that it is incomplete")


def case_01_no_such_input():
    refuse(work / "absent.mp4", "does not exist")
    # The scale is missing too, but the wrong name comes first.
    says(run([program, "measure", work / "absent.mp4"], 2), "^error: the file or folder does not exist: .*--pitch 10mm")
    (work / "folder").mkdir()
    refuse(work / "folder", "there are no images")
    (work / "secret.mp4").write_bytes(b"x" * 100)
    (work / "secret.mp4").chmod(0)
    if os.geteuid() != 0:
        refuse(work / "secret.mp4", "cannot be opened")


def case_02_no_video():
    (work / "empty.mp4").write_bytes(b"")
    refuse(work / "empty.mp4", "is empty")
    (work / "letter.mp4").write_text("This is a letter, not a film.\n")
    refuse(work / "letter.mp4", "(it is text)")
    (work / "noise.avi").write_bytes(numpy.random.default_rng(1).bytes(5000))
    refuse(work / "noise.avi", "is not a video")


def case_03_index_lost():
    whole = clip("a.mp4", H264, 4).read_bytes()
    (work / "cut.mp4").write_bytes(whole[:len(whole) * 6 // 10])
    refuse(work / "cut.mp4", "has no index (the recording was cut off)")


def case_04_cut_at_60_percent():
    for name, how in [("a.mp4", [*H264, "-movflags", "faststart"]), ("a.mkv", H264), ("a.ts", H264),
                      ("a.avi", ["-c:v", "mjpeg", "-q:v", "1", "-qmin", "1", "-pix_fmt", "yuvj420p"])]:
        whole = clip(name, how)
        cut = work / ("cut" + whole.suffix)
        cut.write_bytes(whole.read_bytes()[:whole.stat().st_size * 6 // 10])
        measure(whole, 0)
        done = measure(cut, 5)
        frames = int(says(done, r"^warning: the input ends at frame (\d+)(?: of (?:about )?24)? \(0\.\d\d s(?: of 0.96 s)?\)").group(1))
        kept = rows(out_of(cut))
        insist(8 <= frames == len(kept) <= 20, f"{name}: {len(kept)} rows, {frames} frames")
        # Frames are compared by time. If the storage order differs from the display order, one frame before the cut may
        # be missing.
        values = ("time_s", "dx_mm", "dy_mm", "status")
        good = {row[0]: row for row in rows(out_of(cut), values) if row[-1] == "ok"}
        before = {row[0]: row for row in rows(out_of(whole), values)}
        changes = [abs(float(a) - float(b)) for at, row in good.items() for a, b in zip(row[1:3], before[at][1:3])]
        insist(max(changes) < 1e-4, f"{name}: frames before the cut changed by {max(changes)} mm")  # the first frame after a gap uses detection
        insist(len(good) >= frames - 8, f"{name}: {len(good)} good rows of {frames}")
        insist_incomplete(cut)


def insist_marked(whole, hit):
    """Checks that all frames with changed pixels, as decoded by ffmpeg, have the status decode-error."""
    good, bad, found = luma(whole), luma(hit), states(hit)
    insist(len(good) == len(bad) == len(found), f"{len(good)}, {len(bad)} and {len(found)} frames")
    differ = [i for i in range(len(good)) if (good[i] != bad[i]).any()]
    insist(differ, "nothing was damaged")
    insist(all(found[i] == "decode-error" for i in differ), f"frames {differ} differ: {found}")
    return found


def case_05_damaged_bytes():
    for name in ["a.mp4", "a.mkv"]:
        whole = clip(name, H264)
        hit = work / ("hit" + whole.suffix)
        content = bytearray(whole.read_bytes())
        middle = len(content) // 2
        content[middle:middle + 40] = bytes((37 * i + 11) % 256 for i in range(40))
        hit.write_bytes(content)
        done = measure(hit, 5)
        found = insist_marked(whole, hit)
        warned = says(done, r"^warning: (\d+) frames have no values \(decode-error\): the input is damaged from frame (\d+) on")
        insist((int(warned.group(2)), int(warned.group(1))) == (found.index("decode-error"), found.count("decode-error")), warned.group(0))
        insist(found.count("ok") >= 8, f"{found}")
        insist(all(row[2] == "NaN" for row in rows(out_of(hit)) if row[-1] == "decode-error"), "a damaged frame has a number")
        insist_incomplete(hit)


def case_05_damaged_pictures():
    simulate(program, work / "run", "small-1xyz", 8)
    frames = sorted((work / "run/frames").glob("*.png"))
    frames[3].write_bytes(frames[3].read_bytes()[:3000])
    done = measure(work / "run", 5, "--fps", "25")
    says(done, r"^warning: frame 3 has no values: .*000003.png")
    insist([s == "decode-error" for s in states(work / "run")] == [i == 3 for i in range(8)], f"{states(work / 'run')}")
    pictures.write_png(frames[6], numpy.full((64, 64), 99, numpy.uint8))
    (work / "run.out").rename(work / "before")
    done = measure(work / "run", 5, "--fps", "25")
    says(done, r"^warning: the image size changes from 1024x512 of 8 bits to 64x64 of 8 bits at frame 6")
    insist(len(states(work / "run")) == 6, "what came before counts")
    insist_incomplete(work / "run")


def case_06_hole():
    for name in ["a.mkv", "a.ts", "a.mp4"]:
        whole = clip(name, [*H264, "-movflags", "faststart", "-cluster_time_limit", "200"], 32)  # libav resumes at the next cluster
        hole = work / ("hole" + whole.suffix)
        content = bytearray(whole.read_bytes())
        begin, size = len(content) * 45 // 100, len(content) // 12
        content[begin:begin + size] = bytes(size)
        hole.write_bytes(content)
        done = measure(hole, 5)
        says(done, r"^warning: \d+ frames? (has|have) no values \(decode-error\): the input is damaged from frame \d+ on")
        good = [float(row[1]) for row in rows(out_of(hole), ("frame", "time_s", "status")) if row[-1] == "ok"]
        insist(min(good) < 0.2 and max(good) > 1.0, f"{name}: both sides of the hole count: {good}")
        insist_incomplete(hole)


def case_07_frame_size_changes():
    first = clip("a.ts", H264, 12)
    half = clip("b.ts", ["-vf", "scale=512:256", *H264])
    (work / "c.ts").write_bytes(first.read_bytes() + half.read_bytes())
    done = measure(work / "c.ts", 5)
    says(done, r"^warning: the frame size changes from 1024x512 to 512x256 at frame 12")
    insist(len(states(work / "c.ts")) == 12 and states(work / "c.ts").count("ok") >= 6, f"{states(work / 'c.ts')}")
    insist_incomplete(work / "c.ts")


def case_08_time_runs_backwards():
    first = clip("a.ts", H264, 12)
    (work / "b.ts").write_bytes(2 * first.read_bytes())
    done = measure(work / "b.ts", 5)
    says(done, r"^warning: the times run backwards at frame 12 \(0\.\d\d to 0.00 s\)")
    insist(len(states(work / "b.ts")) == 12, f"{states(work / 'b.ts')}")
    insist_incomplete(work / "b.ts")


def case_09_variable_frame_rate():
    gap = clip("a.mp4", ["-vf", "select='not(between(n\\,6\\,16))'", "-vsync", "vfr", *H264])
    done = measure(gap, 0)
    says(done, r"^note: the frame rate varies \(largest gap 0.48 s at 0.20 s\)")
    times = [float(row[1]) for row in rows(out_of(gap), ("frame", "time_s"))]
    insist(numpy.allclose(times, [i / 25 for i in range(24) if not 6 <= i <= 16], atol=1e-6), f"{times}")


def case_10_depth_and_rotation():
    deep = clip("a.mkv", ["-pix_fmt", "gray16le", "-c:v", "ffv1"], 4)
    measure(deep, 0)
    insist(run_json(deep)["input"]["bits"] == 16, "16 bits stay 16")
    upright = clip("b.mp4", H264)
    tag_rotation(upright, 90, work / "c.mp4")
    done = run([program, "inspect", work / "c.mp4", "--pitch", "10mm", "--json", "-o", work / "turned"])
    insist('"width": 512' in done.stdout and '"height": 1024' in done.stdout, "the tag is applied")


def case_11_too_few_frames():
    one = clip("a.mkv", ["-frames:v", "1", "-pix_fmt", "gray", "-c:v", "ffv1"], 2)
    done = measure(one, 4)
    says(done, r"^error: the run is refused because .*two frames are needed")
    run([program, "inspect", one, "--site", work / "run/site.toml", "-o", work / "seen"])
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-f", "lavfi", "-i", "color=gray:s=64x64:d=0", "-c:v", "ffv1", work / "none.mkv"])
    refuse(work / "none.mkv", "no ")


class Watch:
    """Detects whether a file is opened (inotify(7), IN_OPEN)."""

    def __init__(self, path):
        libc = ctypes.CDLL(None)
        self.file = libc.inotify_init1(os.O_NONBLOCK)
        insist(libc.inotify_add_watch(self.file, os.fsencode(path), 0x20) >= 0, "inotify does not work here")

    def opened(self):
        try:
            return len(os.read(self.file, 4096)) > 0
        except BlockingIOError:
            return False


def case_12_inputs_that_name_others():
    secret = clip("secret.ts", H264, 4)
    watch = Watch(secret)
    secret.read_bytes()
    insist(watch.opened(), "the watch sees an opening")
    for name, text, words in [
            ("list.mp4", f"#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:1,\n{secret}\n#EXT-X-ENDLIST\n", ("input type 'hls' is not allowed", "is not a video (it is text)")),
            ("script.mp4", f"ffconcat version 1.0\nfile '{secret}'\n", "input type 'concat' is not allowed"),
            ("session.mp4", "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 96\n", "input type 'sdp'"),
            ("dash.mp4", f"<?xml version='1.0'?><MPD><BaseURL>{secret}</BaseURL></MPD>\n", "")]:
        (work / name).write_text(text)
        refuse(work / name, words)
    for name in ["http://127.0.0.1:9/a.mp4", f"file:{secret}", f"concat:{secret}|{secret}", f"subfile,,start,0,end,0,,:{secret}"]:
        refuse(name, "does not exist")
    secret.rename(work / "001.ts")
    watch = Watch(work / "001.ts")
    refuse(work / "%03d.ts", "--sequence")
    insist(not watch.opened(), "another file was opened")


def png_that_claims(width, height):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(bytes(1 << 20))) + chunk(b"IEND", b""))


def tiff_that_claims(width, height):
    entries = [(256, 4, width), (257, 4, height), (258, 3, 8), (259, 3, 8), (262, 3, 1), (273, 4, 8), (277, 3, 1),
               (278, 4, height), (279, 4, 1)]
    return (struct.pack("<2sHIH", b"II", 42, 8, len(entries)) + b"".join(struct.pack("<HHII", t, k, 1, v) for t, k, v in entries) +
            bytes(4))


def measured_run(command, expected):
    """Returns the time in s and the peak memory in kB of a command."""
    begin = time.monotonic()
    child = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    insist(os.waitstatus_to_exitcode(status) == expected, f"exit {os.waitstatus_to_exitcode(status)}: {command}")
    return time.monotonic() - begin, used.ru_maxrss


def case_13_bombs():
    empty_s, empty_kb = measured_run([program, "--version"], 0)
    (work / "a.png").write_bytes(png_that_claims(32000, 32000))
    (work / "b.png").write_bytes(png_that_claims(65535, 65535))
    (work / "c.tif").write_bytes(tiff_that_claims(65535, 65535))
    (work / "d.y4m").write_bytes(b"YUV4MPEG2 W9000 H9000 F25:1 C420jpeg\nFRAME\n" + bytes(1000))
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-f", "lavfi", "-i", "color=gray:s=64x64", "-frames:v", "1", work / "small.jpg"])
    jpeg = bytearray((work / "small.jpg").read_bytes())
    sof = jpeg.index(b"\xff\xc0") + 5
    jpeg[sof:sof + 4] = struct.pack(">HH", 60000, 60000)
    (work / "e.jpg").write_bytes(jpeg)
    for name, size in [("a.png", "32000x32000"), ("b.png", "65535x65535"), ("c.tif", "65535x65535"), ("d.y4m", "9000x9000"),
                       ("e.jpg", "60000x60000")]:
        refuse(work / name, f"size {size} exceeds the limit of 64 Mpx")
        seconds, kilobytes = measured_run([program, "measure", work / name, "--pitch", "10mm", "-o", work / "o"], 3)
        insist(kilobytes < empty_kb + 50000, f"{name}: {kilobytes} kB, {empty_kb} to begin with")
        insist(seconds < empty_s + 2.0, f"{name}: {seconds} s, {empty_s} to begin with")  # s; 0.1 s on an idle machine
    pictures.write_png(work / "f.png", numpy.zeros((100, 100), numpy.uint8))
    refuse(work / "f.png", "--max-pixels", "--max-pixels", "9999")


def decoder_of(process):
    for _ in range(3000):
        for task in pathlib.Path(f"/proc/{process.pid}/task").glob("*/children"):
            for child in task.read_text().split():
                if "--decode-child" in pathlib.Path(f"/proc/{child}/cmdline").read_text():
                    return int(child)
        insist(process.poll() is None, "the program ended before it decoded")
        time.sleep(0.01)
    return sys.exit("no decoder was started")


def strike(stroke, words):
    """Sends a signal to the decoder process after some frames, and returns the time in s until the program ends."""
    clip("a.mkv", ["-pix_fmt", "gray", "-c:v", "ffv1"], 12)
    film = work / "b.mkv"
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-stream_loop", "30", "-i", work / "a.mkv", "-c", "copy", film])
    out = work / "out"
    process = subprocess.Popen([program, "measure", film, "--site", work / "run/site.toml", "--method", "two-stage", "--stabilised",
                                work / "still", "-o", out], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    child = decoder_of(process)
    while process.poll() is None and len(list(work.glob("*still*/mid/*.png"))) < 4:
        time.sleep(0.01)
    os.kill(child, stroke)
    begin = time.monotonic()
    stderr = process.communicate(timeout=120)[1]
    insist(process.returncode == 5, f"exit {process.returncode}: {stderr}")
    found = re.search(rf"^warning: the video decoder stopped \({words}\) at frame (\d+) \((\d+) frames kept\)", stderr, re.MULTILINE)
    insist(found, stderr)
    kept = rows(out)
    insist(4 <= len(kept) == int(found.group(2)) < 372, f"{len(kept)} rows: {stderr}")
    insist(all(row[-1] == "ok" for row in kept), "the frames before count")
    return time.monotonic() - begin


def case_14_decoder_crashes():
    strike(signal.SIGKILL, "signal 9")


def case_14_decoder_hangs():
    seconds = strike(signal.SIGSTOP, "silent for 10 s")
    insist(seconds < 60, f"{seconds} s")


globals()[sys.argv[4]]()
