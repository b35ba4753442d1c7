# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a notebook of examples/notebooks as a user would, from the first cell to the last one, whose assertions check what
it shows; and checks the form in which the notebooks are stored. Skipped (exit code 77) where a package is missing.

usage: notebooks_test.py NOTEBOOK WORK [fresh]

WORK is the folder that the notebook runs in, so its files are WORK/work; `fresh` removes these first. The notebooks share
the sequence there. The notebook with its outputs is left in WORK.
"""

import importlib.util
import os
import pathlib
import re
import shutil
import sys
import unittest

SKIPPED = 77
NEEDED = ("nbclient", "nbformat", "ipykernel", "matplotlib")
CELL_S = 300  # longest time of a cell; cells take seconds on an idle machine
LINE = 120

NOTEBOOK, WORK = (pathlib.Path(argument) for argument in sys.argv[1:3])


def missing(cells):
    """The packages that the test and the notebook need and this Python does not have."""
    imported = re.findall(r"^(?:import|from) (\w+)", "\n".join(cell.source for cell in cells), re.MULTILINE)
    return [name for name in dict.fromkeys(imported) if importlib.util.find_spec(name) is None]


def without_package(names):
    print(f"skipped: there is no {', '.join(names)}")
    sys.exit(SKIPPED)


def code(path):
    """The code cells of a notebook."""
    return [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]


class Notebook(unittest.TestCase):
    def test_its_cells_run_and_its_assertions_hold(self):
        notebook = nbformat.read(NOTEBOOK, as_version=4)
        client = nbclient.NotebookClient(notebook, timeout=CELL_S, kernel_name="python3",
                                         resources={"metadata": {"path": str(WORK)}})
        try:
            client.execute()
        finally:
            nbformat.write(notebook, WORK / NOTEBOOK.name)
        self.assertTrue(all(cell.execution_count for cell in notebook.cells if cell.cell_type == "code"))
        shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        self.assertTrue(any("image/png" in output.get("data", {}) for output in shown), "there is no figure")

    def test_it_is_stored_without_outputs_and_ends_with_assertions(self):
        nbformat.validate(nbformat.read(NOTEBOOK, as_version=4))
        cells = code(NOTEBOOK)
        for cell in cells:
            self.assertEqual((cell.outputs, cell.execution_count), ([], None), cell.id)
        self.assertIn("assert ", cells[-1].source)
        for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
            for line in cell.source.splitlines():
                self.assertLessEqual(len(line), LINE, line)

    def test_its_links_lead_to_files(self):
        for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", cell.source if cell.cell_type == "markdown" else ""):
                self.assertTrue((NOTEBOOK.parent / link).exists(), link)

    def test_all_notebooks_simulate_the_same_sequence(self):
        calls = {re.sub(r"\s+", " ", call) for path in NOTEBOOK.parent.glob("*.ipynb") for cell in code(path)
                 for call in re.findall(r"pliant\.simulate\((?:[^()]|\n)*\)", cell.source)}
        self.assertEqual(len(calls), 1, calls)


if __name__ == "__main__":
    lacking = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if lacking:
        without_package(lacking)
    import nbclient
    import nbformat
    lacking = missing(code(NOTEBOOK))
    if lacking and "pliant" not in lacking:
        without_package(lacking)
    if "fresh" in sys.argv[3:]:
        shutil.rmtree(WORK / "work", ignore_errors=True)
    WORK.mkdir(parents=True, exist_ok=True)
    # Kernels leave files; not in the user's home, and not in one folder when several run at a time.
    kernel_files = WORK / "kernels" / NOTEBOOK.stem
    kernel_files.mkdir(parents=True, exist_ok=True)
    for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR"):
        os.environ[name] = str(kernel_files)
    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # a warning of the kernel's debugger, which is not used
    unittest.main(argv=sys.argv[:1])
