#!/usr/bin/python3
"""Tests that docs/performance.md was made from the kernels of this tree (bench/kernels.py)."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))
import kernels  # noqa: E402


class Fingerprint(unittest.TestCase):
    def same(self, a, b):
        return list(kernels.tokens(a)) == list(kernels.tokens(b))

    def test_ignores_comments_white_space_includes_and_names(self):
        self.assertTrue(self.same("#include <a>\nint sum(int a) { return a + 1; }  // one more",
                                  "/* why */ int total(int first)\n{\n  return first + 1;\n}"))

    def test_sees_another_operation_number_or_order(self):
        source = "int sum(int a, int b) { return a + b * 2; }"
        self.assertFalse(self.same(source, "int sum(int a, int b) { return a - b * 2; }"))
        self.assertFalse(self.same(source, "int sum(int a, int b) { return a + b * 3; }"))
        self.assertFalse(self.same(source, "int sum(int a, int b) { return b + a * 2; }"))


class PerformancePage(unittest.TestCase):
    def test_was_made_from_these_kernels(self):
        page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
        made = re.search(r"commit `([0-9a-f]+)`, kernels `([0-9a-f]{16})`", page)
        if not made:  # a page from before this test must say so
            self.assertIn("This page is older than the kernels.", page)
            return
        self.assertEqual(made[2], kernels.fingerprint(ROOT),
                         f"the kernels changed since docs/performance.md was made at {made[1]}: make it again with tools/bench")


if __name__ == "__main__":
    unittest.main()
