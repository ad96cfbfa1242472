#!/usr/bin/python3
"""Tests input and output at the limits of file systems, terminals and numbers: edges.py PROGRAM WORK SOURCE CASE."""
import csv
import json
import os
import shutil
import struct
import subprocess
import sys
import zlib

import numpy
import pictures
import runs
from runs import insist, rows, run, simulate

program, work, _ = runs.start()


def recording(frames=12):
    """Makes a folder of numbered images, its site, and a run of all images. Returns the folder."""
    simulate(program, work / "run", "small-1xyz", frames)
    run([program, "measure", work / "run/frames", "--site", work / "run/site.toml", "--fps", "10", "--method", "two-stage",
         "--quiet", "-o", work / "whole"])
    return work / "run/frames"


def measured(folder, expected, *more):
    out = work / (folder.name + ".out")
    return out, run([program, "measure", folder, "--site", work / "run/site.toml", "--fps", "10", "--method", "two-stage",
                     "-o", out, *more], expected)


def times(folder):
    with open(folder / "displacement.csv", newline="") as file:
        return {int(row["frame"]): float(row["time_s"]) for row in csv.DictReader(file)}


def warnings_of(done):
    return [line for line in done.stderr.splitlines() if line.startswith(("warning: ", "note: "))]


def refuses(words, code, *named, stdout="", timeout=20):
    """Checks that a command ends with one error line that contains `named`, within the timeout in s."""
    done = subprocess.run([str(word) for word in [program, *words]], capture_output=True, text=True, timeout=timeout,
                          stdin=subprocess.DEVNULL, check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    insist(done.returncode == code, f"{words}: exit {done.returncode}, expected {code}: {done.stderr}")
    insist(len(lines) == 1 and all(word in done.stderr for word in named), f"{words}: {done.stderr}, not {named}")
    insist("internal error" not in done.stderr, f"{words}: {done.stderr}")
    return done


def case_missing_pictures():
    """The rows of the present images equal those of the whole recording: same frame, same time, same values."""
    frames = recording()
    whole = {row[0]: row for row in rows(work / "whole")}

    def is_as_before(row):
        """Compares with a tolerance, because tracking starts from another frame and changes the last digits."""
        old = whole[row[0]]
        return row[-1] == old[-1] and all(abs(float(row[k]) - float(old[k])) < 5e-5 for k in (2, 3))

    folder = work / "holes"
    shutil.copytree(frames, folder)
    (folder / "000005.png").unlink()
    (folder / "000006.png").unlink()
    (folder / "000008.png").unlink()
    (folder / "000008.png").symlink_to("nowhere")
    (folder / "000010.png").unlink()
    os.mkfifo(folder / "000010.png")
    out, done = measured(folder, 5)
    insist(times(out) == {n: n / 10 for n in range(12)}, f"frames or times moved: {times(out)}")
    for row in rows(out):
        is_hole = row[0] in {"5", "6", "8", "10"}
        insist(row[-1] == "decode-error" and row[2] == "NaN" if is_hole else is_as_before(row), f"not as in the whole: {row}")
    naming = [line for line in warnings_of(done) if "000005.png" in line]
    insist(len(naming) == 1 and "000006.png" in naming[0] and "000008.png" in naming[0] and "000010.png" in naming[0],
           f"no single warning names them all: {done.stderr}")
    insist(json.loads((out / "run.json").read_text())["complete"] is False, "the run is called complete")
    first = work / "later"  # the first image is missing, so the next one is the reference frame
    shutil.copytree(frames, first)
    (first / "000000.png").unlink()
    (first / "000000.png").symlink_to("../nowhere")
    out, done = measured(first, 5)
    insist([row[-1] for row in rows(out)] == ["decode-error"] + 11 * ["ok"], f"{rows(out)}")
    insist(json.loads((out / "run.json").read_text())["reference_frame"] == 1, "the reference frame is not the first picture")


def case_stride_of_pictures():
    """Every second image of a recording gives the same rows, numbered one by one, without a warning."""
    frames = recording()
    folder = work / "second"
    folder.mkdir()
    for n in range(0, 12, 2):
        shutil.copy(frames / f"{n:06}.png", folder)
    out, done = measured(folder, 0)
    insist(list(times(out)) == list(range(6)), f"frames: {times(out)}")
    insist(not [line for line in warnings_of(done) if "cannot be recognised" not in line], done.stderr)


def case_special_files():
    """Only plain files are read; the program does not wait for a FIFO."""
    simulate(program, work / "run", "small-1xyz", 2)
    site = work / "run/site.toml"
    fifo, folder = work / "f.fifo", work / "folder"
    os.mkfifo(fifo)
    folder.mkdir()
    for what, kind in [(fifo, "is a FIFO"), ("/dev/zero", "is a device")]:
        refuses(["measure", what, "--pitch", "10mm"], 3, kind)
        refuses(["inspect", what, "--pitch", "10mm"], 3, kind)
        refuses(["calibrate", what, "--pitch", "10mm", "-o", work / "camera.toml"], 3, kind)
        refuses(["simulate", what, "-o", work / "out"], 2, str(what))
        refuses(["plan", "--distance", "5m", "--camera", what], 2, str(what))
    for what, kind in [(fifo, "is a FIFO"), ("/dev/zero", "is a device"), (folder, "is a folder")]:
        refuses(["measure", work / "run/frames", "--site", what], 2, kind)
        refuses(["measure", work / "run/frames", "--site", site, "--camera", what], 2, kind)
    for name in ["run.mgj", "run.json"]:
        (work / "dir").mkdir()
        os.mkfifo(work / "dir" / name)
        refuses(["solve", work / "dir"], 3, "FIFO" if name == "run.mgj" else "run.mgj")
        refuses(["export", work / "dir"], 3, "dir")
        shutil.rmtree(work / "dir")
    insist(not (work / "out").exists() and not (work / "camera.toml").exists(), "something was written")


def case_huge_claims():
    """A file that states huge sizes is refused before it takes memory or time."""
    simulate(program, work / "run", "small-1xyz", 2)
    site = (work / "run/site.toml").read_text()
    head, target = site.split("[[target]]")
    big = work / "big.png"
    body = struct.pack(">IIBBBBB", 2147483647, 2147483647, 8, 0, 0, 0, 0)
    big.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
                                                   for kind, data in [(b"IHDR", body), (b"IDAT", bytes(12))]))
    memory = ["bash", "-c", 'ulimit -v 1500000; exec "$0" "$@"', program]  # kB: far less than one row of that image

    def refused(words, code, named):
        done = subprocess.run([*memory, *map(str, words)], capture_output=True, text=True, timeout=30, check=False)
        insist(done.returncode == code and named in done.stderr, f"{words}: exit {done.returncode}: {done.stderr}")

    refused(["inspect", big], 3, "--max-pixels")
    wide = work / "wide.toml"
    wide.write_text(head + "[[target]]" + target.replace("[40.0, 40.0]", "[1e7, 1e7]"))
    line = next(k for k, text in enumerate(wide.read_text().splitlines(), start=1) if "1e7" in text)
    refused(["measure", work / "run/frames", "--site", wide], 2, f"wide.toml:{line}:")
    many = work / "many.toml"
    one = "[[target]]\nname = \"t%d\"\ngrating_mm = [%g, 0.0]\ngrating_size_mm = [40.0, 40.0]\npitch_mm = 10.0\n"
    many.write_text(head + "".join(one % (k, 0.01 * k) for k in range(600)))
    line = 1 + many.read_text()[: many.read_text().index('"t4"')].count("\n")
    refused(["measure", work / "run/frames", "--site", many], 2, f"many.toml:{line + 1}:")


def case_fine_texture():
    """The detection has bounded time for a fine checkerboard over the whole image (87 000 corners)."""
    size, side = (1024, 1366), 4  # px
    y, x = numpy.mgrid[0:size[0], 0:size[1]]
    noise = numpy.random.default_rng(1).normal(0, 1.5, size)
    pictures.write_png(work / "fine.png", numpy.clip(60 + 130 * ((x // side + y // side) % 2) + noise, 0, 255).astype(numpy.uint8))
    refuses(["inspect", work / "fine.png", "--pitch", "10mm", "-o", work / "seen.png"], 4, "fine.png, frame 0", timeout=40)


def case_no_threads():
    """A limit on processes is no internal error: the program works without threads, or reports one error line."""
    frames = recording(3)
    if os.geteuid() != 0:
        return  # the limit counts all processes of a user, and only root can change to a user without any
    work.chmod(0o777)
    words = ["setpriv", "--reuid", "54321", "--regid", "54321", "--clear-groups", "prlimit", "--nproc=1", program, "measure", frames,
             "--site", work / "run/site.toml", "-o", work / "limited"]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=100, check=False)
    lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    insist("internal error" not in done.stderr and done.returncode in (0, 6), f"exit {done.returncode}: {done.stderr}")
    insist(done.returncode == 0 or len(lines) == 1, done.stderr)


def case_limits():
    """Limits on memory and on open files are named. They are no internal errors, and no defects of the video."""
    frames = recording(3)
    measure = [program, "measure", "--site", work / "run/site.toml", "--quiet", "-o", work / "limited"]
    small = subprocess.run([str(word) for word in ["prlimit", "--as=260000000", *measure, "--fps", "10", frames]],
                           capture_output=True, text=True, timeout=100, check=False)
    # The loader itself may fail, depending on the libraries' sizes.
    insist("loading shared libraries" in small.stderr or small.returncode in (0, 6), f"exit {small.returncode}: {small.stderr}")
    insist("internal error" not in small.stderr, small.stderr)
    video = work / "clip.mkv"
    subprocess.run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", "10", "-i", frames / "%06d.png", "-c:v", "ffv1", video], check=True)
    few = subprocess.run([str(word) for word in ["prlimit", "--nofile=14", *measure, video]], capture_output=True, text=True, timeout=100, check=False)
    insist(few.returncode == 3 and "open files" in few.stderr and "convert" not in few.stderr, f"exit {few.returncode}: {few.stderr}")


def case_export_targets():
    """An export replaces plain files only, and no files of the run. The path - is stdout."""
    recording(3)
    whole = work / "whole"
    plain = work / "plain.csv"
    run([program, "export", whole, "-o", plain])
    done = run([program, "export", whole, "-o", "-"])
    insist(done.stdout == plain.read_text(), f"stdout is not the file: {done.stdout}")
    fifo, link, dangling = work / "f", work / "link", work / "dangling"
    os.mkfifo(fifo)
    link.symlink_to(plain)
    dangling.symlink_to(work / "not-there")
    for place in [fifo, link, dangling, "/dev/null", "/dev/stdout", work]:
        for more in [[], ["--replace"]]:
            refuses(["export", whole, "-o", place, *more], 2, str(place))
    insist(fifo.is_fifo() and link.is_symlink() and dangling.is_symlink(), "something was replaced")
    before = {path.name: path.read_bytes() for path in whole.iterdir() if path.is_file()}
    for name in ["run.mgj", "displacement.csv"]:
        refuses(["export", whole, "-o", whole / name, "--replace"], 2, name)
    insist(before == {path.name: path.read_bytes() for path in whole.iterdir() if path.is_file()}, "the run changed")
    refuses(["export", whole, "--gaps", "split", "-o", work / "x.csv"], 2, "--gaps split")


def case_lost_output():
    """All commands end with exit 6 if their text cannot be written."""
    frames = recording(3)
    site = ["--site", work / "run/site.toml"]
    for words in [["--version"], ["--help"], ["help", "measure"], ["simulate", "--list"], ["completion", "bash"],
                  ["plan", "--distance", "5m", "--camera", "imx255", "--focal", "12mm"], ["export", work / "whole", "-o", "-"],
                  ["inspect", frames, *site, "--json", "-o", work / "seen.png"],
                  ["measure", frames, *site, "--method", "two-stage", "-o", work / "a"],
                  ["measure", frames, *site, "--method", "two-stage", "--json", "-o", work / "b"]]:
        with open("/dev/full", "w") as full:
            done = subprocess.run([program, *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
        insist(done.returncode == 6 and len(lines) == 1 and "standard output" in lines[0], f"{words}: {done.returncode} {done.stderr}")
    insist((work / "b/displacement.csv").exists(), "the results are lost with the text")


def case_empty_values():
    """An option with an empty value is an error."""
    simulate(program, work / "run", "small-1xyz", 2)
    measure = ["measure", work / "run/frames", "--site", work / "run/site.toml", "-o", work / "out"]
    for option in ["--camera", "--fps", "--figures", "--stabilised", "--frames", "--tone", "--rest", "--readout", "--threads"]:
        refuses([*measure, option, ""], 2, "the value is empty", option)
    refuses(["measure", work / "run/frames", "--site", ""], 2, "the value is empty", "--site")
    refuses(["measure", "", "--pitch", "10mm"], 2, "the value is empty", "INPUT")
    refuses(["export", work, "-o", ""], 2, "the value is empty")
    insist(not (work / "out").exists(), "something was written")


def case_impossible_numbers():
    """Values that no camera has are errors."""
    simulate(program, work / "run", "small-1xyz", 2)
    measure = ["measure", work / "run/frames", "--site", work / "run/site.toml", "-o", work / "out"]
    for words in [["--fps", "inf"], ["--fps", "1e-308"], ["--fps", "nan"], ["--threads", "-1"],
                  ["--fps", "10", "--readout", "10s"]]:
        refuses([*measure, *words], 2, words[-2])
    refuses(["simulate", "small-1xyz", "--set", "sensor.defocus_disc_px=1000", "-o", work / "out"], 2, "sensor.defocus_disc_px")
    insist(not (work / "out").exists(), "something was written")


def case_control_characters():
    """Control characters in paths and names do not reach the terminal, and no name becomes a formula in a table."""
    simulate(program, work / "run", "small-1xyz", 2)
    for name in ["two\nlines", "zz\x1b[31mRED", "c1\u009b31m", "\u202efdp.mp4"]:
        done = refuses(["measure", work / name, "--pitch", "10mm"], 3)
        insist(not any(c < " " or "\x7f" <= c < "\xa0" or c == "\u202e" for c in done.stderr.replace("\n", "")), repr(done.stderr))
    done = subprocess.run([program.encode(), b"measure", b"raw\x9b31m", b"--pitch", b"10mm"], capture_output=True, check=False)
    insist(b"raw\\x9b31m" in done.stderr and b"\x9b" not in done.stderr, repr(done.stderr))
    site = (work / "run/site.toml").read_text()
    line = 1 + site[: site.index('"mid"')].count("\n")
    for name in ["=cmd|calc", "+1", "-1", "@SUM(A1)", "a\u009bb", "a\u0085b", "a\u202eb"]:
        (work / "named.toml").write_text(site.replace('"mid"', json.dumps(name, ensure_ascii=False)))
        refuses(["measure", work / "run/frames", "--site", work / "named.toml", "-o", work / "out"], 2, f"named.toml:{line}:")


def case_video_that_begins_late():
    """A Matroska file with its first frame at 5 s is complete; without its second half it is not."""
    simulate(program, work / "run", "small-1xyz", 12)
    late = work / "late.mkv"
    run(["ffmpeg", "-nostdin", "-loglevel", "error", "-framerate", "10", "-i", work / "run/frames/%06d.png", "-c:v", "ffv1",
         "-output_ts_offset", "5", late])
    words = ["--site", work / "run/site.toml", "--method", "two-stage"]
    run([program, "measure", late, *words, "-o", work / "late"])
    insist([row[-1] for row in rows(work / "late")] == 12 * ["ok"], f"{rows(work / 'late')}")
    cut = work / "cut.mkv"
    cut.write_bytes(late.read_bytes()[: late.stat().st_size // 2])
    run([program, "measure", cut, *words, "-o", work / "cut"], 5)


def case_targets_alone():
    """`conventional` requires no references. The other methods report missing references before they read the input."""
    simulate(program, work / "run", "small-still", 4)
    site = (work / "run/site.toml").read_text()
    alone = work / "alone.toml"
    alone.write_text(site[site.index("[[target]]"):])
    frames = work / "run/frames"
    for method in ["two-stage", "precise"]:
        refuses(["measure", frames, "--site", alone, "--method", method, "-o", work / "out"], 2, "alone.toml", "--method conventional")
    insist(not (work / "out").exists(), "something was written")
    # Removes the rest of the board, so that only the target has its pitch.
    bare = work / "bare"
    bare.mkdir()
    for frame in sorted(frames.glob("*.png")):
        picture = pictures.read_png(frame)
        height, width = picture.shape
        picture[:, : width // 2 - 110] = picture[:, width // 2 + 110:] = picture[0, 0]
        pictures.write_png(bare / frame.name, picture)
    run([program, "measure", bare, "--site", alone, "--method", "conventional", "-o", work / "alone"])
    run([program, "measure", frames, "--site", work / "run/site.toml", "--method", "conventional", "-o", work / "all"])
    for a, b in zip(rows(work / "alone"), rows(work / "all")):
        insist(a[-1] == b[-1] and abs(float(a[2]) - float(b[2])) < 2e-3 and abs(float(a[3]) - float(b[3])) < 2e-3, f"{a} {b}")
    circle = work / "circle.toml"
    circle.write_text(site[: site.index("[[target]]")] + "[[target]]\nname = \"bare\"\ncircle_mm = [0.0, 0.0]\ncircle_diameter_mm = 20.0\n")
    line = 1 + circle.read_text()[: circle.read_text().index("circle_mm = [0.0, 0.0]")].count("\n")
    refuses(["measure", frames, "--site", circle, "-o", work / "out"], 2, f"circle.toml:{line}:", "add grating_mm")


if __name__ == "__main__":
    globals()[sys.argv[4]]()
