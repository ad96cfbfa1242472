"""Functions shared by the tests and the study of killed runs and failing disks: clips, runs, comparisons."""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from runs import insist, run, simulate, start  # noqa: E402,F401

FRAMES = 12  # simulated frames; longer clips repeat them


def shown_frame(n, few=FRAMES):
    """Returns the simulated frame that frame `n` of a long clip shows. They are shown forwards and backwards, so that nothing jumps."""
    at = n % (2 * few - 2)
    return min(at, 2 * few - 2 - at)


def long_clip(program, work, frames, scenario="small-0.1x", few=FRAMES, converted=None):
    """Makes a folder of images as hard links to a few, to save disk space. `converted` returns an image in another format."""
    simulate(program, work / "few", scenario, few)
    pictures = sorted((work / "few/frames").glob("*.png"))
    if converted:
        pictures = [converted(picture) for picture in pictures]
    clip = work / "clip"
    clip.mkdir()
    for n in range(frames):
        picture = pictures[shown_frame(n, few)]
        os.link(picture, clip / f"{n:06d}{picture.suffix}")
    return clip, work / "few/site.toml"


def measure(program, clip, site, out, *options):
    return [str(word) for word in (program, "measure", clip, "--site", site, "--fps", "10", "--quiet", "-o", out, *options)]


def with_failing_calls(library, out, **words):
    """Returns the environment of a run in which a call under `out` fails (variables: failing_calls.cc)."""
    env = dict(os.environ, LD_PRELOAD=str(library), FAIL_UNDER=str(out))
    env["ASAN_OPTIONS"] = env.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"
    env.update({f"FAIL_{name.upper()}": str(word) for name, word in words.items()})
    return env


def done(command, env=None, timeout=120):
    return subprocess.run(command, env=env, capture_output=True, text=True, timeout=timeout, check=False)


def error_lines(stderr):
    return [line for line in stderr.splitlines() if line.startswith("error: ")]


def contents(folder):
    """Returns the bytes of all files; None if there is no folder."""
    if not folder.is_dir():
        return None
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def with_suffix(out, suffix):
    return out.parent / (out.name + suffix)


def clear(out):
    for path in [out, *out.parent.glob(out.name + ".*")]:
        shutil.rmtree(path, ignore_errors=True)


def insist_same(out, wanted, what):
    found = contents(out)
    insist(found is not None, f"{what}: no results")
    insist(found.keys() == wanted.keys(), f"{what}: {sorted(found)} instead of {sorted(wanted)}")
    for name, data in wanted.items():
        insist(found[name] == data, f"{what}: {name} is another one")
    left = [path.name for path in out.parent.glob(out.name + ".*")]
    insist(not left, f"{what}: left behind: {left}")


def kill_after(command, seconds, env=None, how=signal.SIGKILL):
    """Starts a command and kills it. Returns the time of the kill, the exit code and stderr."""
    process = subprocess.Popen(command, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    time.sleep(seconds)
    process.send_signal(how)
    at = time.clock_gettime(time.CLOCK_MONOTONIC)
    _, stderr = process.communicate(timeout=120)
    return at, process.returncode, stderr


class Records:
    """Valid records of a run.mgj (docs/file-formats.md), and the end of the last one."""

    def __init__(self, data):
        import zlib
        self.tags, self.ends = [], []
        place = 16
        while place + 12 <= len(data):
            size = int.from_bytes(data[place + 4:place + 8], "little")
            end = place + 8 + size
            if end + 4 > len(data) or zlib.crc32(data[place:end]) != int.from_bytes(data[end:end + 4], "little"):
                break
            self.tags.append(data[place:place + 4].decode())
            self.ends.append(end + 4)
            place = end + 4
        self.good = place

    def frames(self, up_to=None):
        return sum(tag == "OBSV" and (up_to is None or end <= up_to) for tag, end in zip(self.tags, self.ends))
