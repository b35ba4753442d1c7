# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The table of benchmark targets: medians win over runs, ratios are evaluated, what is missing is an error."""

import contextlib
import io
import json
import pathlib
import tempfile
import unittest

import targets

BENCHMARKS = {
    "benchmarks": [
        {"name": "BM_Ours/500", "run_name": "BM_Ours/500", "run_type": "iteration", "real_time": 9.0, "time_unit": "us"},
        {"name": "BM_Ours/500_median", "run_name": "BM_Ours/500", "run_type": "aggregate", "aggregate_name": "median",
         "real_time": 2.0, "time_unit": "us"},
        {"name": "BM_Theirs", "run_name": "BM_Theirs", "run_type": "iteration", "real_time": 8000.0, "time_unit": "ns",
         "memory_mb": 120.0},
    ]
}


def run(table):
    """targets.main over BENCHMARKS: its exit code and the lines of the file that it wrote."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "a.json").write_text(json.dumps(BENCHMARKS))
        table_path = pathlib.Path(folder) / "table"
        table_path.write_text("name,value,target\n" + table)
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            code = targets.main(table_path, folder)
        return code, (pathlib.Path(folder) / "targets.csv").read_text().splitlines()


class Targets(unittest.TestCase):
    def test_a_ratio_of_times_uses_the_median_and_the_units(self):
        code, lines = run('ratio,"time(""BM_Theirs"") / time(""BM_Ours/500"")",>= 4\n')
        self.assertEqual((code, lines), (0, ["name,value,target,met", "ratio,4,>= 4,yes"]))

    def test_a_missed_target_is_no_but_no_failure(self):
        code, lines = run('memory,"counter(""BM_Theirs"", ""memory_mb"")",< 100\n')
        self.assertEqual((code, lines[1]), (0, "memory,120,< 100,no"))

    def test_a_benchmark_that_did_not_run_is_a_failure(self):
        code, lines = run('gone,"time(""BM_Gone"")",< 1\n')
        self.assertEqual((code, lines[1]), (1, "gone,,< 1,no"))

    def test_an_expression_cannot_run_code(self):
        code, _ = run('bad,"__import__(""os"")",< 1\n')
        self.assertEqual(code, 1)


if __name__ == "__main__":
    unittest.main()
