#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every notebook of a folder in a fresh kernel: notebooks_test.py FOLDER. A failing cell fails the test. Stored notebooks hold
no output, so that a change of one is readable."""
import os
import pathlib
import sys
import tempfile

import nbclient
import nbformat


def main():
    notebooks = sorted(pathlib.Path(sys.argv[1]).glob("*.ipynb"))
    assert notebooks, "no notebook"
    with tempfile.TemporaryDirectory(prefix="moiregauge-notebooks-") as folder:
        os.environ["TMPDIR"] = folder
        for path in notebooks:
            notebook = nbformat.read(path, as_version=4)
            nbformat.validate(notebook)
            code = [cell for cell in notebook.cells if cell.cell_type == "code"]
            assert not any(cell.outputs for cell in code), f"{path.name} holds output: clear it"
            nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute(cwd=folder)
            shown = sum(len(cell.outputs) for cell in code)
            print(f"{path.name}: {len(code)} cells, {shown} outputs")
            for cell in code:
                for output in cell.outputs:
                    if output.output_type == "stream":
                        print("   ", output.text.strip())
            assert shown > 0


if __name__ == "__main__":
    main()
