#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the Python module against the program: module_test.py PROGRAM [unittest arguments]. PYTHONPATH holds the package."""
import gc
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import moiregauge

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
import pictures  # pylint: disable=wrong-import-position

PROGRAM = ""
FRAMES = 12
WORK = pathlib.Path(tempfile.mkdtemp(prefix="moiregauge-python-"))
CLIP = WORK / "clip"


def setUpModule():
    command("simulate", "small-1xyz", "--frames", FRAMES, "--markers-only", "--codec", "ffv1", "--seed", 7, "--quiet", "-o", CLIP)
    command("measure", CLIP / "video.mkv", "--pitch", "10mm", "--quiet", "-o", WORK / "by-program")


def tearDownModule():
    subprocess.run(["rm", "-r", WORK], check=True)


def command(*words, code=0):
    """Runs the program. Returns its error line without `error: `."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code, f"{words}: exit {done.returncode}\n{done.stderr}"
    lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    return lines[0].removeprefix("error: ") if lines else ""


def measured(**how):
    return moiregauge.measure(CLIP / "video.mkv", pitch="10mm", **how)


def child(code, *words):
    """Starts another interpreter."""
    return subprocess.Popen([sys.executable, "-c", code, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


class Numbers(unittest.TestCase):
    def test_results_are_the_bytes_of_the_program(self):
        run = measured(out=WORK / "by-python")
        for name in ["displacement.csv", "camera.toml", "site.toml"]:
            expected = WORK / "by-program" / name
            self.assertEqual(expected.exists(), (run.folder / name).exists(), name)
            if expected.exists():
                self.assertEqual(expected.read_bytes(), (run.folder / name).read_bytes(), name)

    def test_arrays_are_the_table_unrounded(self):
        run = measured()
        table = numpy.genfromtxt(run.folder / "displacement.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        target = run["T1"]
        for column, array in [("frame", target.frame), ("time_s", target.time), ("dx_mm", target.dx), ("dy_mm", target.dy),
                              ("u_dx_mm", target.u_dx), ("u_dy_mm", target.u_dy)]:
            # The table is rounded to 1 nm.
            numpy.testing.assert_allclose(array, table[column], rtol=0, atol=0.51e-6, err_msg=column)
        self.assertEqual(list(table["status"]), [moiregauge.Status(code).word for code in target.status])
        frame = run.to_pandas()
        self.assertEqual(list(frame.columns), list(table.dtype.names))
        self.assertTrue((frame["dy_mm"].to_numpy() == target.dy).all())

    def test_status_codes_have_the_words_of_the_table(self):
        self.assertEqual(moiregauge.Status.PARTLY_COVERED.word, "partly-covered")
        self.assertEqual(moiregauge.Status.TOO_COARSE.word, "too-coarse")

    def test_samples_agree_with_the_truth_within_their_u(self):
        simulation = moiregauge.simulate("small-1xyz", frames=FRAMES, seed=7, markers_only=True)
        truth, target = simulation.truth("mid"), measured()["T1"]
        self.assertEqual(len(simulation), FRAMES)
        self.assertTrue((numpy.abs(target.dy - truth.dy)[1:] < 5 * target.u_dy[1:]).all())
        with self.assertRaises(KeyError):
            simulation.truth("nobody")
        with self.assertRaisesRegex(KeyError, "the target does not exist: nobody: choose from T1"):
            measured()["nobody"]

    def test_a_loaded_run_has_every_bit(self):
        run = measured(out=WORK / "stored")
        again = moiregauge.load(WORK / "stored")
        for field in ["dx", "dy", "u_dx", "u_dy", "time", "status"]:
            self.assertTrue((getattr(run["T1"], field) == getattr(again["T1"], field)).all(), field)
        self.assertEqual(again.exit_code, run.exit_code)

    def test_solve_gives_the_bytes_of_the_program_and_leaves_the_run(self):
        run = measured(out=WORK / "to-solve")
        before = (run.folder / "displacement.csv").read_bytes()
        command("solve", WORK / "by-program", "--method", "two-stage", "--quiet", "-o", WORK / "solved")
        solved = run.solve(method="two-stage")
        self.assertEqual((solved.folder / "displacement.csv").read_bytes(), (WORK / "solved" / "displacement.csv").read_bytes())
        self.assertEqual((run.folder / "displacement.csv").read_bytes(), before)

    def test_derive_gives_the_numbers_of_the_program(self):
        run = measured(out=WORK / "to-derive")
        command("derive", WORK / "by-program", "--channel", "d = T1.dy - T1.dx", "--zero", "0:3", "--quiet", "-o", WORK / "d.csv")
        table = numpy.genfromtxt(WORK / "d.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        channel = run.derive("T1.dy - T1.dx", zero="0:3")
        numpy.testing.assert_allclose(channel.value, table["d_mm"], rtol=0, atol=0.51e-6)  # rounded to 1 nm
        self.assertEqual(channel.unit, "mm")
        several = run.derive("a = T1.dy", "b = T1.dx")
        self.assertEqual(list(several), ["a", "b"])
        self.assertTrue((several["a"].value == run["T1"].dy).all())

    def test_camera_and_scene_are_those_of_run_json(self):
        run = measured()
        self.assertIsNone(run.json["camera"]["k1"])  # twelve frames do not determine the lens
        self.assertIsNone(run.camera)
        self.assertEqual(run.scene["model"], run.json["scene"]["model"])
        self.assertGreater(len(run.scene["key_frames"]), 1)
        self.assertEqual([marker.name for marker in run.site.markers][-1], "T1")

    def test_the_report_is_the_run_s(self):
        run = measured()
        run.report(WORK / "page.html")
        self.assertEqual((WORK / "page.html").read_bytes(), (run.folder / "report.html").read_bytes())
        self.assertIn("<table>", run._repr_html_())


class Views(unittest.TestCase):
    def test_arrays_are_views_of_the_samples(self):
        target = measured()["T1"]
        first = target.dx.__array_interface__["data"][0]
        self.assertEqual(target.dy.__array_interface__["data"][0], first + 8)  # the next field of the same sample
        self.assertEqual(target.dx.__array_interface__["data"][0], first)      # not a copy for each access
        self.assertFalse(target.dy.flags.owndata)
        self.assertFalse(target.dy.flags.writeable)

    def test_an_array_outlives_its_run(self):
        expected = measured()["T1"].dy.copy()
        run = measured()
        folder, dy = run.folder, run["T1"].dy
        del run
        gc.collect()
        self.assertFalse(folder.exists())  # a temporary run leaves nothing
        filler = [numpy.ones(1000) for _ in range(1000)]
        self.assertTrue((dy == expected).all())
        del filler


class Errors(unittest.TestCase):
    def same_words(self, kind, code, words, work):
        expected = command(*words, code=code)
        with self.assertRaises(kind) as caught:
            work()
        self.assertEqual(str(caught.exception), expected)
        self.assertEqual(caught.exception.exit_code, code)

    def test_have_the_words_of_the_program(self):
        missing, text = WORK / "nowhere.mp4", WORK / "text.mp4"
        text.write_text("no video\n")
        self.same_words(moiregauge.InputError, 3, ["measure", missing, "--pitch", "10mm"], lambda: moiregauge.measure(missing, pitch="10mm"))
        self.same_words(moiregauge.InputError, 3, ["measure", text, "--pitch", "10mm"], lambda: moiregauge.measure(text, pitch="10mm"))
        self.same_words(moiregauge.UsageError, 2, ["measure", text, "--pitch", "10mm", "--method", "best"],
                        lambda: moiregauge.measure(text, pitch="10mm", method="best"))
        self.same_words(moiregauge.UsageError, 2, ["measure", text, "--pitch", "10mm", "--rest", "3"],
                        lambda: moiregauge.measure(text, pitch="10mm", rest="3"))
        self.same_words(moiregauge.InputError, 3, ["solve", WORK / "nothing"], lambda: moiregauge.load(WORK / "nothing"))

    def test_a_refused_run_is_loud_and_kept(self):
        frames = WORK / "empty"
        frames.mkdir(exist_ok=True)
        for number in range(2):
            pictures.write_png(frames / f"{number}.png", numpy.full((200, 300), 120, numpy.uint8))
        expected = command("measure", frames, "--pitch", "10mm", "-o", WORK / "refused", code=4)
        with self.assertRaises(moiregauge.RefusedError) as caught:
            moiregauge.measure(frames, pitch="10mm", out=WORK / "refused-2")
        self.assertEqual(str(caught.exception), expected.replace("/refused/", "/refused-2/"))
        self.assertEqual(caught.exception.run.exit_code, 4)

    def test_units_are_mandatory(self):
        for how in [{"pitch": 10}, {"pitch": "10"}, {"pitch": "10mm", "pitch_mm": 10}, {}, {"pitch": "10mm", "readout": "18"},
                    {"pitch": "10mm", "site": CLIP / "site.toml"}]:
            with self.assertRaises(moiregauge.UsageError, msg=str(how)) as caught:
                moiregauge.measure(CLIP / "video.mkv", **how)
            self.assertIsInstance(caught.exception, ValueError)
            self.assertGreaterEqual(str(caught.exception).count(": "), 1)
        self.assertEqual(moiregauge.measure(CLIP / "video.mkv", pitch_mm=10)["T1"].dy[3], measured()["T1"].dy[3])

    def test_results_that_cannot_be_written(self):
        with self.assertRaises(moiregauge.OutputError):
            measured(out="/proc/nothing/run")
        with self.assertRaises(moiregauge.UsageError):
            measured(out=CLIP)  # holds other files

    def test_images_of_other_kinds(self):
        tracker = moiregauge.Tracker(pitch="10mm")
        image = numpy.zeros((64, 64), numpy.uint8)
        for wrong in [image.astype(float), image[:, ::2], numpy.zeros((4, 4, 3), numpy.uint8), image[:0], image.T[:, ::-1]]:
            with self.assertRaises(moiregauge.UsageError):
                tracker.update(wrong, 0.0)
        with self.assertRaises(moiregauge.UsageError):
            moiregauge.Tracker(pitch="10mm", bits=10).update(image, 0.0)


class Stopping(unittest.TestCase):
    def long_clip(self):
        """A folder of 600 links to the frames of a short recording: at least a second of work."""
        frames = WORK / "long"
        if not frames.exists():
            moiregauge.simulate("small-1xyz", frames=6, seed=7, markers_only=True).write(WORK / "short")
            frames.mkdir()
            for number in range(600):
                (frames / f"{number:04d}.png").symlink_to(WORK / "short" / "frames" / f"{number % 6:06d}.png")
        return frames

    def test_progress_is_reported_and_can_stop(self):
        calls = []
        measured(on_progress=lambda done, expected: calls.append((done, expected)))
        self.assertEqual(calls[0][0], 1)
        self.assertEqual(calls[-1], (FRAMES, FRAMES))
        run = moiregauge.measure(self.long_clip(), pitch="10mm", fps=10, on_progress=lambda done, expected: False)
        self.assertTrue(run.is_interrupted)
        self.assertLess(len(run["T1"]), 600)

    def test_an_exception_of_the_callback_passes(self):
        def fail(_done, _expected):
            raise RuntimeError("no more")
        with self.assertRaisesRegex(RuntimeError, "no more"):
            measured(on_progress=fail)

    def test_ctrl_c_stops_at_once_and_the_run_can_resume(self):
        frames, out = self.long_clip(), WORK / "stopped"
        code = "import sys, moiregauge\nmoiregauge.measure(sys.argv[1], pitch='10mm', fps=10, out=sys.argv[2])"
        process = child(code, frames, out)
        journal = pathlib.Path(f"{out}.unfinished/run.mgj")
        for _ in range(2000):
            if journal.exists() and journal.stat().st_size > 20000:
                break
            time.sleep(0.005)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertFalse((out / "displacement.csv").exists() and len((out / "displacement.csv").read_text().splitlines()) > 600)
        with self.assertRaises(moiregauge.UsageError):
            moiregauge.measure(frames, pitch="10mm", fps=10, out=out)
        resumed = moiregauge.measure(frames, pitch="10mm", fps=10, out=out, resume=True)
        whole = moiregauge.measure(frames, pitch="10mm", fps=10)
        self.assertEqual((resumed.folder / "displacement.csv").read_bytes(), (whole.folder / "displacement.csv").read_bytes())


class Threads(unittest.TestCase):
    def test_measure_at_the_same_time(self):
        results = {}
        threads = [threading.Thread(target=lambda n=n: results.update({n: measured()["T1"].dy.copy()})) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        expected = measured()["T1"].dy
        for n in range(4):
            self.assertTrue((results[n] == expected).all())

    def test_a_second_interpreter_measures_at_the_same_time(self):
        code = "import sys, moiregauge\nmoiregauge.measure(sys.argv[1], pitch='10mm', out=sys.argv[2])"
        others = [child(code, CLIP / "video.mkv", WORK / f"other-{n}") for n in range(2)]
        run = measured()
        for n, process in enumerate(others):
            self.assertEqual(process.communicate(timeout=120)[1], "")
            self.assertEqual((WORK / f"other-{n}" / "displacement.csv").read_bytes(), (run.folder / "displacement.csv").read_bytes())

    def test_work_releases_the_lock(self):
        # With this interval Python takes the lock from no thread, so the other one runs only while the library works.
        simulation = moiregauge.simulate("small-1xyz", frames=2, seed=7, markers_only=True)
        image = simulation.frame(0)
        tracker = moiregauge.Tracker(site=simulation.site)
        done = []
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000.0)
        try:
            ready = threading.Event()
            other = threading.Thread(target=lambda: (ready.wait(), done.append(1)))
            other.start()
            ready.set()
            tracker.update(image, 0.0)
            self.assertEqual(done, [1])
            other.join()
        finally:
            sys.setswitchinterval(interval)

    def test_share_a_tracker(self):
        simulation = moiregauge.simulate("small-1xyz", frames=4, seed=7, markers_only=True)
        images = list(simulation)
        tracker = moiregauge.Tracker(site=simulation.site)
        lock, numbers = threading.Lock(), iter(range(40))

        def follow():
            while True:
                with lock:
                    number = next(numbers, None)
                if number is None:
                    return
                tracker.update(images[number % 4], number * 0.1)
        threads = [threading.Thread(target=follow) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(tracker.frames, 40)


class Images(unittest.TestCase):
    def test_the_tracker_follows_the_truth_in_8_and_16_bits(self):
        simulation = moiregauge.simulate("small-1xyz", frames=8, seed=7, markers_only=True)
        byte, word = moiregauge.Tracker(site=simulation.site), moiregauge.Tracker(site=simulation.site, bits=12)
        truth = simulation.truth("mid")
        for number, image in enumerate(simulation):
            wide = numpy.zeros((image.shape[0], image.shape[1] + 64), numpy.uint16)
            wide[:, 32:-32] = image.astype(numpy.uint16) << 4
            first = byte.update(image, number / simulation.fps)
            second = word.update(wide[:, 32:-32], number / simulation.fps)  # a view with longer rows
            self.assertEqual(first.is_reference, number == 0)
            if number > 2:
                self.assertEqual(first["mid"].status, "ok")
                self.assertLess(abs(first["mid"].dy - truth.dy[number]), 5 * first["mid"].u_dy)
            # The same grey levels times 16. Rounding differs, which is far below the noise of 1.5 grey levels.
            if number > 0:
                self.assertLess(abs(first["mid"].dy - second["mid"].dy), 0.2 * first["mid"].u_dy)
        self.assertEqual(byte.names, ["mid"])
        with self.assertRaises(KeyError):
            first["nobody"]
        with self.assertRaises(moiregauge.InputError):
            byte.update(image[:100], 99.0)

    def test_inspect_shows_markers_scale_and_pictures(self):
        simulation = moiregauge.simulate("small-1xyz", frames=1, seed=7, markers_only=True)
        seen = moiregauge.inspect(simulation.frame(0), pitch="10mm")
        self.assertEqual([marker.name for marker in seen.markers], ["R1", "R2", "R3", "R4", "T1"])
        self.assertAlmostEqual(seen.distance[2], 256.0, delta=0.05)  # circles at +-128 mm, each with a u of some 7 um
        self.assertTrue(seen._repr_png_().startswith(b"\x89PNG"))
        self.assertIn("T1", seen._repr_html_())
        file = moiregauge.inspect(CLIP / "video.mkv", pitch_mm=10, frame=3)
        self.assertEqual(file.json["input"]["frame"], 3)
        self.assertTrue(numpy.isnan(moiregauge.inspect(simulation.frame(0)).mm_per_px))
        with self.assertRaises(moiregauge.UsageError):
            moiregauge.inspect(CLIP / "video.mkv", pitch="10mm", frame=99)

    def test_sampling_moire_measures_a_known_shift(self):
        x = numpy.arange(240)
        before, after = (numpy.tile(numpy.rint(125 + 85 * numpy.cos(2 * numpy.pi * (x - shift) / 20)), (200, 1)).astype(numpy.uint8)
                         for shift in (0.0, 1.7))
        first, second = (moiregauge.sampling_moire(image, pitch_px=20) for image in (before, after))
        # Rounding to grey levels repeats with the pitch, so it does not average out: below 1 / (85 sqrt 12) rad.
        self.assertAlmostEqual(moiregauge.displacement_px(first, second, pitch_px=20), 1.7, delta=20 / (2 * numpy.pi * 85 * 12**0.5))
        field = moiregauge.phase_of(before, pitch_px=20)
        self.assertEqual(field.phase_rad.shape, (200 - 2 * field.margin, 240 - 2 * field.margin))
        self.assertAlmostEqual(float(field.modulation.mean()), 85, delta=0.5)
        self.assertFalse(field.phase_rad.flags.writeable)
        along = numpy.unwrap(field.phase_rad[50])
        self.assertAlmostEqual(along[-1] - along[0], 2 * numpy.pi * (len(along) - 1) / 20, delta=0.02)
        with self.assertRaises(moiregauge.UsageError):
            moiregauge.phase_of(before, pitch_px=20, axis="z")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
