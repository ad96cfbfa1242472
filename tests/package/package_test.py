#!/usr/bin/python3
"""Tests the installation and the Debian package.

    package_test.py example|deb BUILD EXAMPLES

example  installs BUILD into a separate folder, configures and builds EXAMPLES against it, and runs the results
deb      makes the Debian package, unpacks it, and checks its files and dependencies; builds the example against it, too
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

PROGRAM = [
    "usr/bin/moiregauge",
    "usr/share/man/man1/moiregauge.1.gz",
    "usr/share/man/man1/moiregauge-measure.1.gz",
    "usr/share/bash-completion/completions/moiregauge",
    "usr/share/zsh/vendor-completions/_moiregauge",
    "usr/share/doc/moiregauge/copyright",
    "usr/share/doc/moiregauge/examples/read_moiregauge.py",
]
LIBRARY = [
    "usr/include/moiregauge/measure.h",
    "usr/include/moiregauge/version.h",
    "usr/lib/libmoiregauge.so",
    "usr/lib/moiregauge/moiregauge-decode",
    "usr/lib/libmoiregauge_sampling_moire.a",
    "usr/lib/cmake/moiregauge/moiregauge-config.cmake",
    "usr/share/doc/moiregauge-dev/copyright",
    "usr/share/doc/moiregauge-dev/examples/cmake/CMakeLists.txt",
]
MAX_PUBLIC_HEADERS = 15  # version.h, which is generated, and 14 others


def run(*words, **how):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **how)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout


def check_headers(prefix, work):
    """Checks the number of public headers, and that each compiles alone, without any dependency but tl-expected."""
    headers = sorted((prefix / "include" / "moiregauge").glob("*"))
    assert 0 < len(headers) <= MAX_PUBLIC_HEADERS, f"{len(headers)} public headers: {headers}"
    for header in headers:
        source = work / "alone.cc"
        source.write_text(f'#include "moiregauge/{header.name}"\nint main() {{ return 0; }}\n')
        run("c++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", f"-I{prefix / 'include'}", source)


def build_example(examples, prefix, program, work):
    check_headers(prefix, work)
    run("cmake", "-S", examples, "-B", work / "example", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF")
    run("cmake", "--build", work / "example")
    # The build must read the installed headers, not those of a source tree.
    read = run("ninja", "-C", work / "example", "-t", "deps")
    ours = [line.strip() for line in read.splitlines() if "/moiregauge/" in line and line.strip().endswith(".h")]
    strangers = [line for line in ours if str(prefix) not in os.path.realpath(work / "example" / line)]
    assert ours and not strangers, strangers or "no header of ours was read"
    needed = run("readelf", "-d", work / "example" / "grating_phase")
    assert "ceres" not in needed and "opencv" not in needed, needed
    print(run(work / "example" / "grating_phase").strip())
    print(run(work / "example" / "simulate_and_check").strip())
    print(run(work / "example" / "follow_camera", "2000").strip())
    run(program, "simulate", "small-1xyz", "--frames", "3", "--markers-only", "--quiet", "-o", work / "run")
    print(run(work / "example" / "measure_clip", work / "run" / "frames").strip())


def check_python(root, work):
    """Imports the module of python3-moiregauge from its unpacked package, which finds the library next to it."""
    (package,) = work.glob("python3-moiregauge_*_*.deb")
    control = run("dpkg-deb", "-f", package)
    assert "python3-numpy" in control and "libmoiregauge0.1 (= " in control and "python3 (>= 3." in control, control
    unpacked(package, work)
    code = ("import moiregauge, sys\nassert sys.argv[1] in moiregauge.__file__\n"
            "moiregauge.simulate('small-1xyz', frames=3, markers_only=True).write(sys.argv[2])\n"
            "run = moiregauge.measure(sys.argv[2] + '/frames', pitch='10mm', fps=10)\nprint(run['T1'].dy)")
    print(run("/usr/bin/python3", "-c", code, root, work / "python-clip",
              env={**os.environ, "PYTHONPATH": str(root / "usr/lib/python3/dist-packages")}).strip())


def unpacked(package, work):
    root = work / "root"
    run("dpkg-deb", "-x", package, root)
    return root


def test_deb(build, examples, work):
    run("cpack", "--config", build / "CPackConfig.cmake", "-B", work)
    (program,) = work.glob("moiregauge_*_*.deb")
    (library,) = work.glob("moiregauge-dev_*_*.deb")
    (shared,) = work.glob("libmoiregauge0.1_*_*.deb")
    (pages,) = work.glob("moiregauge-doc_*_all.deb")
    control = run("dpkg-deb", "-f", program)
    for needed in ["libavcodec", "libopencv-imgproc", "fonts-dejavu-core", "libc6"]:
        assert needed in control, f"Depends names no {needed}\n{control}"
    assert "libexpected-dev" in run("dpkg-deb", "-f", library) and "libmoiregauge0.1 (= " in run("dpkg-deb", "-f", library)
    root = unpacked(program, work)
    for name in PROGRAM:
        assert (root / name).is_file() and (root / name).stat().st_size > 0, f"{name} is missing"
    assert not (root / "usr/include").exists(), "the program's package holds headers"
    unpacked(shared, work)
    assert not (root / "usr/include").exists(), "the library's package holds headers"
    unpacked(library, work)
    unpacked(pages, work)
    assert (root / "usr/share/doc/moiregauge-doc/how-do-i.md").is_file()
    check_python(root, work)
    for name in LIBRARY:
        assert (root / name).is_file() and (root / name).stat().st_size > 0, f"{name} is missing"
    words = (root / "usr/share/doc/moiregauge/copyright").read_text()
    assert "GNU General Public License" in words and "FFmpeg" in words
    symbols = run("readelf", "-S", root / "usr/bin/moiregauge")
    assert ".debug_info" not in symbols, "the program is not stripped"
    for text in root.rglob("*.cmake"):
        assert str(build) not in text.read_text() and str(examples.parent) not in text.read_text(), f"{text} names the build"
    for package in sorted(work.glob("*.deb")):
        print(f"{package.name}: {package.stat().st_size / 1e6:.1f} MB")
    build_example(examples, root / "usr", root / "usr/bin/moiregauge", work)


def main():
    part, build, examples = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory(prefix="moiregauge-package-") as folder:
        work = pathlib.Path(os.path.realpath(folder))
        shutil.copytree(examples, work / "examples")  # outside the source tree
        if part == "deb":
            test_deb(build, work / "examples", work)
        else:
            run("cmake", "--install", build, "--prefix", work / "prefix")
            build_example(work / "examples", work / "prefix", work / "prefix/bin/moiregauge", work)


if __name__ == "__main__":
    main()
