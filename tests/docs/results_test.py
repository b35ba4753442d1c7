# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/results.md is what experiments/results/results.py writes, and cannot go stale."""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
OTHER = "99.99"
SCRIPT = "experiments/results/results.py"
PAGE = "docs/results.md"
READ = ("experiments/*/README.md", "experiments/results/*.*", "experiments/common/grid.py",
        "third_party_configs/datasets/*.yaml", "third_party_configs/datasets/benchmarks/*.yaml", PAGE)
# (experiment, end of the heading, column) of a number in each table that the page shows.
SHOWN = (("simulated_colon", "`dm`, default", "RMSE mm"), ("simulated_colon", "`hard`, default", "null RMSE mm"),
         ("simulated_colon", "`dm_endoscope`, default", "with a map"), ("simulated_colon", "`dm`, paper", "RMSE mm"),
         ("hamlyn", "Results", "RMSE mm"), ("rigid_baseline", "Results", "surface RMSE, mm"),
         ("recordings", "Real recordings", "depth error"))


def check(root):
    return subprocess.run([sys.executable, "-B", str(root / SCRIPT), "--check"], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)


def with_other_number(text, heading, column, other=OTHER):
    """The text with another number in this column of the first row of the first table below the heading that has it."""
    lines, below = text.splitlines(), False
    for number, line in enumerate(lines):
        if line.startswith("#"):
            below = line.endswith(heading)
        cells = line.split(" | ")
        if below and line.startswith("|") and column in cells:
            row = lines[number + 2].split(" | ")
            row[cells.index(column)] = other
            lines[number + 2] = " | ".join(row)
            return "\n".join(lines) + "\n"
    raise AssertionError(f"no column {column} below {heading}")


class Results(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for pattern in READ:
            for path in ROOT.glob(pattern):
                target = self.root / path.relative_to(ROOT)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, target)

    def change(self, name, before, after):
        text = (self.root / name).read_text(encoding="utf-8")
        self.assertIn(before, text)
        (self.root / name).write_text(text.replace(before, after), encoding="utf-8")

    def assert_fails(self, *words):
        result = check(self.root)
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertNotIn("Traceback", result.stdout)
        for word in words:
            self.assertIn(word, result.stdout)

    def test_the_page_is_what_the_tables_give(self):
        result = check(ROOT)
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_another_number_in_an_experiment_makes_the_page_stale(self):
        for experiment, heading, column in SHOWN:
            with self.subTest(experiment=experiment, heading=heading):
                path = self.root / "experiments" / experiment / "README.md"
                text = path.read_text(encoding="utf-8")
                path.write_text(with_other_number(text, heading, column), encoding="utf-8")
                self.assert_fails("results.md is not what the tables give")
                path.write_text(text, encoding="utf-8")
        self.assertEqual(check(self.root).returncode, 0)

    def test_another_depth_of_the_surface_makes_the_page_stale(self):
        path = self.root / "experiments/surface/README.md"
        lines = path.read_text(encoding="utf-8").splitlines()
        rows = [number for number, line in enumerate(lines) if "| refined_online |" in line]
        lines[rows[0]] = lines[rows[0]].replace("| 2 of 2 |", "| 1 of 2 |")
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        self.assert_fails("results.md is not what the tables give")

    def test_another_published_number_makes_the_page_stale(self):
        self.change("experiments/results/published.yaml", '"0.185"', '"0.186"')
        self.assert_fails("results.md is not what the tables give")

    def test_an_edited_page_is_found(self):
        self.change(PAGE, "# Results", "# Our results")
        self.assert_fails("results.md is not what the tables give")

    def test_published_numbers_that_disagree_are_an_error(self):
        self.change("experiments/results/published.yaml", '"1.77"', '"1.78"')
        self.assert_fails("different published numbers")

    def test_a_machine_that_the_experiment_does_not_name_is_an_error(self):
        self.change("experiments/simulated_colon/README.md", "two cores of a server", "four cores")
        self.assert_fails("experiments/simulated_colon/README.md does not say 'two cores of a server'")

    def test_a_word_in_place_of_a_number_is_an_error(self):
        path = self.root / "experiments/hamlyn/README.md"
        text = with_other_number(path.read_text(encoding="utf-8"), "Results", "RMSE mm", "none")
        path.write_text(text, encoding="utf-8")
        self.assert_fails("'none' is not a number")

    def test_a_table_without_its_column_is_an_error(self):
        self.change("experiments/rigid_baseline/README.md", "surface RMSE, mm", "RMSE")
        self.assert_fails("experiments/rigid_baseline/README.md has 0 tables with the columns")

    def test_a_fresh_table_takes_the_place_of_that_of_the_readme(self):
        readme = (self.root / "experiments/rigid_baseline/README.md").read_text(encoding="utf-8")
        table = readme.split("<!-- table -->")[1].split("<!-- end of table -->")[0]
        fresh = self.root / "build/experiments/rigid_baseline/table.md"
        fresh.parent.mkdir(parents=True)
        fresh.write_text(with_other_number("# Results\n" + table, "Results", "null"), encoding="utf-8")
        output = self.root / "new.md"
        subprocess.run([sys.executable, "-B", str(self.root / SCRIPT), "--fresh", str(self.root / "build/experiments"),
                        "--output_path", str(output)], check=True)
        self.assertIn(f"({OTHER})", output.read_text(encoding="utf-8"))


if __name__ == "__main__":
    if importlib.util.find_spec("yaml") is None:
        print("skipped: Python has no yaml")
        sys.exit(SKIPPED)
    unittest.main()
