#!/usr/bin/python3
"""package_test.py example|deb BUILD EXAMPLES

example  installs BUILD into a separate folder, configures and builds EXAMPLES against it, and runs the results
deb      makes the Debian package, unpacks it, and checks its files and dependencies; builds the example against it, too
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HELD = [
    "usr/bin/moiregauge",
    "usr/share/man/man1/moiregauge.1.gz",
    "usr/share/man/man1/moiregauge-measure.1.gz",
    "usr/share/bash-completion/completions/moiregauge",
    "usr/share/zsh/vendor-completions/_moiregauge",
    "usr/share/doc/moiregauge/copyright",
    "usr/share/doc/moiregauge/examples/cmake/CMakeLists.txt",
    "usr/include/moiregauge/phase/sampling_moire/sampling_moire.h",
    "usr/lib/moiregauge/libmoiregauge_phase.a",
    "usr/lib/cmake/moiregauge/moiregauge-config.cmake",
]


def run(*words, **how):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **how)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout


def build_example(examples, prefix, work):
    run("cmake", "-S", examples, "-B", work / "example", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF")
    run("cmake", "--build", work / "example")
    # The build must read the installed headers, not those of a source tree.
    read = run("ninja", "-C", work / "example", "-t", "deps")
    ours = [line.strip() for line in read.splitlines() if "/moiregauge/" in line and line.strip().endswith(".h")]
    strangers = [line for line in ours if str(prefix) not in os.path.realpath(work / "example" / line)]
    assert ours and not strangers, strangers or "no header of ours was read"
    print(run(work / "example" / "grating_shift").strip())
    prefix_program = prefix / "bin" / "moiregauge"
    run(prefix_program, "simulate", "small-1xyz", "--frames", "3", "--markers-only", "--quiet", "-o", work / "run")
    print(run(work / "example" / "measure_clip", work / "run" / "frames", "10").strip())


def test_deb(build, examples, work):
    run("cpack", "--config", build / "CPackConfig.cmake", "-B", work)
    (package,) = work.glob("moiregauge_*_*.deb")
    control = run("dpkg-deb", "-f", package)
    for needed in ["libavcodec59", "libopencv-imgproc", "fonts-dejavu-core", "libc6"]:
        assert needed in control, f"Depends names no {needed}\n{control}"
    root = work / "root"
    run("dpkg-deb", "-x", package, root)
    for name in HELD:
        assert (root / name).is_file() and (root / name).stat().st_size > 0, f"{name} is missing"
    words = (root / "usr/share/doc/moiregauge/copyright").read_text()
    assert "GNU General Public License" in words and "FFmpeg" in words
    symbols = run("readelf", "-S", root / "usr/bin/moiregauge")
    assert ".debug_info" not in symbols, "the program is not stripped"
    for text in root.rglob("*.cmake"):
        assert str(build) not in text.read_text() and str(examples.parent) not in text.read_text(), f"{text} names the build"
    print(f"{package.name}: {package.stat().st_size / 1e6:.1f} MB")
    build_example(examples, root / "usr", work)


def main():
    part, build, examples = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory(prefix="moiregauge-package-") as folder:
        work = pathlib.Path(os.path.realpath(folder))
        shutil.copytree(examples, work / "examples")  # outside the source tree
        if part == "deb":
            test_deb(build, work / "examples", work)
        else:
            run("cmake", "--install", build, "--prefix", work / "prefix")
            build_example(work / "examples", work / "prefix", work)


if __name__ == "__main__":
    main()
