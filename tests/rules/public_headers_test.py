#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks include/moiregauge: at most 14 headers, each documented, each compiling alone without the internals."""
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = sorted((ROOT / "include" / "moiregauge").glob("*.h"))
VERBS = "Returns|Reads|Measures|Solves|Creates|Loads|Renders|Views|Writes"
SPECIAL = re.compile(r"MOIREGAUGE_API (Tracker|Simulation)(\(|& operator=)|MOIREGAUGE_API ~|#define")


def comment_above(lines, number):
    block = []
    while number > 0 and lines[number - 1].lstrip().startswith("//"):
        number -= 1
        block.insert(0, lines[number].strip().lstrip("/ "))
    return " ".join(block)


class PublicHeaders(unittest.TestCase):
    def test_there_are_few(self):
        self.assertLessEqual(len(HEADERS), 14)  # and version.h, which is generated

    def test_each_function_says_what_it_does(self):
        for header in HEADERS:
            lines = header.read_text(encoding="utf-8").split("\n")
            for number, line in enumerate(lines):
                if "MOIREGAUGE_API" not in line or SPECIAL.search(line):
                    continue
                above = comment_above(lines, number)
                simple = re.search(r"(frames|fps)\(\) const;", line)
                if not simple:
                    self.assertRegex(above, rf"^({VERBS}) ", f"{header.name}:{number + 1}: {line.strip()}")
                if "Expected<" in line:
                    self.assertIn("Fails", above, f"{header.name}:{number + 1}: {line.strip()}")

    def test_each_type_is_introduced(self):
        for header in HEADERS:
            lines = header.read_text(encoding="utf-8").split("\n")
            for line in lines[:3]:
                self.assertTrue(line.startswith("//") or line.startswith("#pragma"), f"{header.name}: no introduction")

    def test_none_includes_an_internal_header(self):
        for header in HEADERS:
            for name in re.findall(r'#include "moiregauge/([^"]+)"', header.read_text(encoding="utf-8")):
                self.assertNotIn("/", name, header.name)

    def test_each_compiles_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            version = pathlib.Path(folder, "moiregauge")
            version.mkdir()
            (version / "version.h").write_text((ROOT / "src/moiregauge/version.h.in").read_text(encoding="utf-8"))
            for header in HEADERS:
                source = pathlib.Path(folder, "alone.cc")
                source.write_text(f'#include "moiregauge/{header.name}"\n')
                done = subprocess.run(["c++", "-std=c++20", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-fsyntax-only",
                                       f"-I{ROOT / 'include'}", f"-I{folder}", str(source)], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, f"{header.name}: {done.stderr[:2000]}")


if __name__ == "__main__":
    unittest.main()
