#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads Google Benchmark's JSON files and says which targets are met.

usage: targets.py TARGETS.csv FOLDER

TARGETS.csv has the columns name, value, target. `value` is an expression of numbers, + - * / and
    time("BM_Name/500")              real time of one iteration, in ns
    counter("BM_Name/500", "label")  a counter that the benchmark reports
over every FOLDER/*.json; where a benchmark was repeated, its median counts. `target` is a comparison, such as <= 1.
Prints a table, writes FOLDER/targets.csv (name,value,target,met; met is yes or no), and exits with 0 when every target
could be evaluated, met or not, and with 1 when one could not.
"""

import ast
import csv
import json
import operator
import pathlib
import sys

UNIT_NS = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
COMPARISONS = {"<=": operator.le, ">=": operator.ge, "<": operator.lt, ">": operator.gt}
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}


def load_benchmarks(folder):
    """The benchmarks of all files by name: the median where there is one, else the last run."""
    runs, medians = {}, {}
    for path in sorted(pathlib.Path(folder).glob("*.json")):
        for entry in json.loads(path.read_text())["benchmarks"]:
            if entry.get("error_occurred"):
                continue
            if entry.get("aggregate_name") == "median":
                medians[entry["run_name"]] = entry
            elif entry.get("run_type") != "aggregate":
                runs[entry["name"]] = entry
    return {**runs, **medians}


def evaluate(expression, benchmarks):
    """The number that an expression of a target's `value` stands for."""

    def find(name):
        if name not in benchmarks:
            raise ValueError(f"there is no benchmark '{name}'")
        return benchmarks[name]

    def call(function, arguments):
        if function == "time" and len(arguments) == 1:
            entry = find(arguments[0])
            return entry["real_time"] * UNIT_NS[entry["time_unit"]]
        if function == "counter" and len(arguments) == 2:
            entry = find(arguments[0])
            if arguments[1] not in entry:
                raise ValueError(f"benchmark '{arguments[0]}' has no counter '{arguments[1]}'")
            return float(entry[arguments[1]])
        raise ValueError(f"'{function}' with {len(arguments)} arguments is not known")

    def walk(node):
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return float(node.value)
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](walk(node.left), walk(node.right))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if all(isinstance(a, ast.Constant) and isinstance(a.value, str) for a in node.args):
                return call(node.func.id, [a.value for a in node.args])
        raise ValueError(f"'{expression}' is not an expression of numbers, time() and counter()")

    return walk(ast.parse(expression, mode="eval").body)


def is_met(value, target):
    comparison, bound = target.split()
    return COMPARISONS[comparison](value, float(bound))


def main(targets_path, folder):
    benchmarks = load_benchmarks(folder)
    rows, complete = [], True
    with open(targets_path, newline="") as file:
        for line in csv.DictReader(file):
            try:
                value = evaluate(line["value"], benchmarks)
                rows.append((line["name"], f"{value:.4g}", line["target"], "yes" if is_met(value, line["target"]) else "no"))
            except (ValueError, ZeroDivisionError) as error:
                print(f"{line['name']}: {error}", file=sys.stderr)
                rows.append((line["name"], "", line["target"], "no"))
                complete = False
    header = ("name", "value", "target", "met")
    with open(pathlib.Path(folder) / "targets.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(4)]
    for row in [header, *rows]:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())
    return 0 if complete else 1


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2]))
