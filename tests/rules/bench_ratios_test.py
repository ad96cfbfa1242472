#!/usr/bin/python3
"""Tests bench/ratios.py on synthetic results."""
import json
import pathlib
import subprocess
import tempfile
import unittest

RATIOS = pathlib.Path(__file__).resolve().parents[2] / "bench" / "ratios.py"
SIZES = ("4104x1012", "4096x2168")
# Time in microseconds (for both sizes), scatter along x (twice as much along y), unit. All of them reach their aims.
GOOD = {
    "floor/ring": (1000, None, ""),
    "textbook/ring": (100000, 0.005, "mm"),
    "textbook detection/ring": (30000, 0.03, "px"),
    "detection/ring": (1000, 0.01, "px"),
    "tracking/ring": (100, 0.001, "mm"),
    "tracking/cold": (200, 0.001, "mm"),
    "precise/ring": (100, 0.001, "mm"),
    "two-stage/ring": (100, 0.001, "mm"),
}
FILES = {
    "files": {"raw": {"measure": {"wall_s": 2.5}, "decode": {"wall_s": 2.0}, "bytes": {"wall_s": 1.0}},
              "ffv1": {"measure": {"wall_s": 10.2}, "decode": {"wall_s": 10.0}, "bytes": {"wall_s": 1.0}}},
    "memory": {"frames": 1000, "measure": {"peak_bytes": 150 * 2**20}, "decode": {"peak_bytes": 100 * 2**20}},
}


def chain_of(cases, lost=0.0, simd="avx3"):
    rows = []
    for name, (time, error, unit) in cases.items():
        case, memory = name.split("/")
        for size in SIZES:
            row = {"run_name": f"{case}/{size}/{memory}", "aggregate_name": "median", "cpu_time": time, "time_unit": "us",
                   "lost": lost if case == "precise" else 0.0}
            if unit:
                row |= {f"scatter_x_{unit}": error, f"scatter_y_{unit}": 2 * error, "error_frames": 51}
            # Times are medians. Lost frames show in the mean only.
            rows += [row | {"aggregate_name": "mean", "cpu_time": 1e9}, row | {"lost": 0.0}]
    return {"context": {"simd": simd}, "benchmarks": rows}


def ratios(cases, files=None, lost=0.0):
    with tempfile.TemporaryDirectory() as folder:
        chain = pathlib.Path(folder, "chain.json")
        chain.write_text(json.dumps(chain_of(cases, lost)), encoding="utf-8")
        command = [RATIOS, chain]
        if files:
            second = pathlib.Path(folder, "files.json")
            second.write_text(json.dumps(files), encoding="utf-8")
            command += ["--files", second]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, done.stderr


def line(output, *words):
    return next(row for row in output.splitlines() if all(word in row for word in words))


class Ratios(unittest.TestCase):
    def test_a_run_that_reaches_every_aim_passes(self):
        code, output, _ = ratios(GOOD, FILES)
        self.assertEqual(code, 0)
        self.assertIn("| >= 120x | >= 400x | 1e+03x | 1 / 5, 2 / 10 um | aim |", line(output, "`precise`", "4104x1012"))
        self.assertIn("| 500x; 0.2 of a pass |", line(output, "cold, 4096x2168"))
        self.assertIn("| 2.5 | ", line(output, "raw"))
        self.assertIn("| 1.02 | ", line(output, "ffv1"))
        self.assertIn("| 50 MiB | ", line(output, "1000-frame"))
        self.assertEqual(output.count("| aim |\n"), output.count("\n") - 2)

    def test_every_instruction_set_must_pass(self):
        with tempfile.TemporaryDirectory() as folder:
            wide, narrow = pathlib.Path(folder, "wide.json"), pathlib.Path(folder, "narrow.json")
            wide.write_text(json.dumps(chain_of(GOOD)), encoding="utf-8")
            narrow.write_text(json.dumps(chain_of(GOOD | {"precise/ring": (2600, 0.001, "mm")}, simd="avx2")), encoding="utf-8")
            done = subprocess.run([RATIOS, wide, narrow], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("**fails** |", line(done.stdout, "`precise`", "4104x1012, AVX2"))
        self.assertIn("| aim |", line(done.stdout, "`precise`", "4104x1012, AVX-512"))

    def test_between_gate_and_aim_it_still_passes(self):
        code, output, _ = ratios(GOOD | {"precise/ring": (350, 0.001, "mm")})
        self.assertEqual(code, 0)
        self.assertIn("| gate |", line(output, "`precise`", "4096x2168"))

    def test_a_gate_that_is_missed_fails(self):
        code, output, _ = ratios(GOOD | {"precise/ring": (2600, 0.001, "mm")})
        self.assertEqual(code, 1)
        self.assertIn("**fails** |", line(output, "`precise`", "4104x1012"))
        self.assertEqual(output.count("fails"), 2)

    def test_a_faster_result_with_a_worse_error_fails(self):
        code, output, _ = ratios(GOOD | {"tracking/cold": (200, 0.006, "mm")})
        self.assertEqual(code, 1)
        self.assertIn("**fails**: less exact along x", line(output, "cold, 4104x1012"))

    def test_what_the_scatter_of_so_few_frames_cannot_tell_apart_passes(self):
        self.assertEqual(ratios(GOOD | {"tracking/cold": (200, 0.0054, "mm")})[0], 0)

    def test_an_error_that_is_no_number_fails(self):
        self.assertEqual(ratios(GOOD | {"detection/ring": (1000, float("nan"), "px")})[0], 1)

    def test_frames_that_were_lost_do_not_count_as_fast(self):
        code, output, _ = ratios(GOOD, lost=0.25)
        self.assertEqual(code, 1)
        self.assertIn("precise lost 25 % of the frames", output)

    def test_memory_and_wall_time_have_gates_too(self):
        files = json.loads(json.dumps(FILES))
        files["memory"]["measure"]["peak_bytes"] = 301 * 2**20
        files["files"]["ffv1"]["measure"]["wall_s"] = 11.1
        code, output, _ = ratios(GOOD, files)
        self.assertEqual(code, 1)
        self.assertIn("**fails**", line(output, "1000-frame"))
        self.assertIn("**fails**", line(output, "ffv1"))

    def test_a_case_that_was_not_run_is_named(self):
        code, _, problem = ratios({k: v for k, v in GOOD.items() if k != "tracking/cold"})
        self.assertEqual(code, 1)
        self.assertIn("no median of tracking/4104x1012/cold", problem)


if __name__ == "__main__":
    unittest.main()
