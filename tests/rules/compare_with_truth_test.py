#!/usr/bin/python3
"""Tests tools/compare-with-truth on series with known errors."""
import pathlib
import subprocess
import tempfile
import unittest

COMPARE = pathlib.Path(__file__).resolve().parents[2] / "tools" / "compare-with-truth"
TRUTH = "frame,time_s,marker,dx_mm,dy_mm\n0,0,mid,0,0\n1,0.1,mid,0,0.5\n2,0.2,mid,0,1\n"
HEADER = "frame,time_s,marker,dx_mm,dy_mm,u_dx_mm,u_dy_mm,status\n"


def compare(rows):
    with tempfile.TemporaryDirectory() as folder:
        truth, measured = pathlib.Path(folder, "truth.csv"), pathlib.Path(folder, "displacement.csv")
        truth.write_text(TRUTH, encoding="utf-8")
        measured.write_text(HEADER + rows, encoding="utf-8")
        done = subprocess.run([COMPARE, truth, measured], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout


class CompareWithTruth(unittest.TestCase):
    def test_errors_are_in_micrometres_and_rows_that_are_not_ok_do_not_count(self):
        code, output = compare("0,0,mid,0,0,0,0,ok\n1,0.1,mid,0.003,0.504,0.001,0.001,ok\n2,0.2,mid,NaN,NaN,NaN,NaN,lost\n")
        self.assertEqual(code, 0)
        self.assertIn("mid: 2 of 3 rows ok; dx error rms 3.00 um, largest 3.00 um; dy error rms 4.00 um", output)

    def test_the_reference_frame_need_not_be_the_first(self):
        code, output = compare("0,0,mid,0,-0.5,0.001,0.001,ok\n1,0.1,mid,0,0,0,0,ok\n2,0.2,mid,0,0.5,0.001,0.001,ok\n")
        self.assertEqual(code, 0)
        self.assertIn("dy error rms 0.00 um, largest 0.00 um", output)

    def test_nothing_to_compare_is_a_failure(self):
        self.assertEqual(compare("0,0,mid,NaN,NaN,NaN,NaN,lost\n")[0], 1)


if __name__ == "__main__":
    unittest.main()
