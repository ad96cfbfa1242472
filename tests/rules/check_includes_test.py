#!/usr/bin/python3
"""Tests that tools/check-includes detects each kind of forbidden include, and accepts allowed ones."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check-includes"


def run_on(files):
    """Returns exit code and output of the check on a tree of {path below src/moiregauge: text}."""
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = pathlib.Path(root, "src", "moiregauge", name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        done = subprocess.run([sys.executable, CHECK, root], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class CheckIncludes(unittest.TestCase):
    def refused(self, name, include, words):
        code, output = run_on({name: f"// a line before\n#include {include}\n"})
        self.assertEqual(code, 1, output)
        self.assertIn(f"src/moiregauge/{name}:2: ", output)
        self.assertIn(words, output)

    def passes(self, name, include):
        code, output = run_on({name: f"#include {include}\n"})
        self.assertEqual((code, output), (0, ""))

    def test_a_module_may_look_left(self):
        self.passes("phase/a.cc", '"moiregauge/image/image.h"')
        self.passes("results/a.h", '"moiregauge/units/units.h"')
        self.passes("drawing/a.cc", '"moiregauge/results/series.h"')
        self.passes("run/a.cc", "<chrono>")
        self.passes("io/a.cc", '"moiregauge/simulator/scenario/scenario.h"')
        self.passes("cli/a.cc", '"moiregauge/decoder/video.h"')

    def test_a_module_may_not_look_right(self):
        self.refused("units/a.h", '"moiregauge/site/site.h"', "units includes site")
        self.refused("image/a.h", '"moiregauge/phase/sampling_moire/sampling_moire.h"', "image includes phase")
        self.refused("displacement/a.cc", '"moiregauge/run/frame_source.h"', "displacement includes run")
        self.refused("run/a.cc", '"moiregauge/io/png.h"', "run includes io")
        self.refused("phase/a_test.cc", '"moiregauge/detection/circles/circles.h"', "in a test")

    def test_the_simulator_is_blind_to_the_instrument(self):
        self.refused("simulator/a.cc", '"moiregauge/geometry/camera.h"', "simulator includes geometry")
        self.refused("simulator/a_test.cc", '"moiregauge/phase/sampling_moire/sampling_moire.h"', "stays blind")
        self.refused("phase/a.cc", '"moiregauge/simulator/scenario/scenario.h"', "phase includes simulator")

    def test_no_module_includes_the_command_line(self):
        self.refused("io/a.cc", '"moiregauge/cli/exit.h"', "nothing may include cli")

    def test_opencv_is_used_in_the_sources_of_detection_only(self):
        self.passes("detection/circles/a.cc", "<opencv2/imgproc.hpp>")
        self.refused("detection/circles/a.h", "<opencv2/core.hpp>", "OpenCV in a header")
        self.refused("geometry/a.cc", "<opencv2/core.hpp>", "only detection may")

    def test_ceres_is_used_in_board_only(self):
        self.passes("board/a.cc", "<ceres/ceres.h>")
        self.passes("calibration/scene/a_test.cc", "<ceres/ceres.h>")
        self.refused("calibration/scene/a.cc", "<ceres/ceres.h>", "only board may")

    def test_a_sub_folder_may_not_look_right(self):
        self.passes("detection/gratings/a.cc", '"moiregauge/detection/circles/circles.h"')
        self.passes("displacement/precise/a.cc", '"moiregauge/displacement/method.h"')
        self.refused("detection/circles/a.cc", '"moiregauge/detection/gratings/grating_fit.h"', "order of the folders")
        self.refused("displacement/a.cc", '"moiregauge/displacement/precise/precise_scene.h"', "order of the folders")
        self.refused("detection/new/a.cc", '"moiregauge/detection/circles/circles.h"', "has no folder new")

    def test_the_core_is_pure(self):
        for header in ["<thread>", "<chrono>", "<fstream>", "<random>", "<spdlog/spdlog.h>", "<tbb/parallel_for.h>"]:
            self.refused("displacement/a.cc", header, "the core has no")
        self.passes("displacement/a_test.cc", "<random>")

    def test_an_unknown_module_is_refused(self):
        self.assertEqual(run_on({"helpers/a.h": ""})[0], 1)


if __name__ == "__main__":
    unittest.main()
