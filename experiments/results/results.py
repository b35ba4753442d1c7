#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/results.md: published tables beside ours.

usage: results.py [--check] [--fresh DIR] [--output_path FILE]

The text is results.md.in, the published numbers are in published.yaml, and ours are read from the tables in the
READMEs of the experiments, which are their only place. --fresh takes the table of an experiment from
DIR/EXPERIMENT/table.md where there is one (build/experiments, after `./run experiment EXPERIMENT`). --check writes
nothing and compares with the page that is there. Needs PyYAML.

Ends with 0, or with 1 and one sentence if a table or a number is not where it should be, or the page is not current.
"""

import argparse
import pathlib
import re
import statistics
import sys
import textwrap

import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent / "common"))
import grid

PAGE = ROOT / "docs" / "results.md"
WIDTH = 120
MADE_BY = """<!-- Made by `python3 experiments/results/results.py` from the tables of the experiments, and from
results.md.in and published.yaml in its folder. Edit those, not this page. -->

"""
NOT_RECORDED = "not recorded"
COLMAP_RUNS = {"default": "Pliant", "refined_default": "Pliant, refined", "colmap_tracks": "COLMAP on our tracks",
               "colmap_sift": "COLMAP with SIFT"}


class Failure(Exception):
    """What is not where it should be, in one sentence."""


# Our tables.

class Table:
    """A Markdown table: its heading, its columns, its rows as dictionaries (of columns with one name, the first)."""

    def __init__(self, heading, columns, rows):
        self.heading, self.columns = heading, columns
        self.rows = [dict(zip(reversed(columns), reversed(row))) for row in rows]

    def row(self, **values):
        found = [row for row in self.rows if all(row[column] == value for column, value in values.items())]
        if len(found) != 1:
            raise Failure(f"the table below '{self.heading}' has {len(found)} rows with {values}")
        return found[0]


def cells_of(line):
    return [cell.strip().replace("**", "") for cell in line.strip().strip("|").split("|")]


def tables_in(text):
    """Every table of a Markdown text, with the heading that it stands below."""
    heading, block, found = "", [], []
    for line in [*text.splitlines(), ""]:
        if line.startswith("|"):
            block.append(cells_of(line))
            continue
        if len(block) > 2:
            found.append(Table(heading, block[0], block[2:]))
        block = []
        if line.startswith("#"):
            heading = line.lstrip("#").strip()
    return found


class Experiment:
    """The README of an experiment, with its table replaced by a fresh one where there is one."""

    def __init__(self, name, fresh=None):
        self.path = f"experiments/{name}/README.md"
        self.text = (ROOT / self.path).read_text(encoding="utf-8")
        new = fresh / name / "table.md" if fresh else None
        if new and new.is_file():
            before, rest = self.text.split("<!-- table -->")
            self.text = before + "\n" + new.read_text(encoding="utf-8") + "\n" + rest.split("<!-- end of table -->")[1]

    def table(self, *columns, heading=None):
        """The one table with these columns (below this heading)."""
        found = [table for table in tables_in(self.text)
                 if set(columns) <= set(table.columns) and heading in (None, table.heading)]
        if len(found) != 1:
            below = f" below '{heading}'" if heading else ""
            raise Failure(f"{self.path} has {len(found)} tables with the columns {', '.join(columns)}{below}")
        return found[0]

    def has(self, words):
        return " ".join(words.split()) in " ".join(self.text.split())


# Parts of the page.

def link(table):
    return f"[{table['paper']}]({table['url']})"


def sentence(what, entry):
    """A line of the list that says how numbers were made."""
    protocol = entry["protocol"]
    return f"- {what}. " + " ".join(f"*{key.capitalize()}*: {protocol[key]}." for key in
                                    ("aligned", "trimmed", "points", "frames"))


def published_protocol(table):
    return (sentence(f"**Published**, {link(table)}, {table['table']}", table) + f" *Unit*: {table['unit']}. "
            f"*Read in*: {table['read_in']}.")


def our_protocol(name, entry, experiment):
    facts = []
    for key in ("date", "machine", "build"):
        fact = entry.get(key)
        if fact and not experiment.has(fact["quote"]):
            raise Failure(f"{experiment.path} does not say '{fact['quote']}', as published.yaml does of its {key}")
        facts.append(f"*{key.capitalize()}*: {fact['text'] if fact else NOT_RECORDED}.")
    return (sentence(f"**Ours**, [{name}](../{experiment.path})", entry) + f" *Command*: `{entry['command']}`. " +
            " ".join(facts))


def number_in(row, column):
    try:
        return float(row[column])
    except ValueError:
        raise Failure(f"'{row[column]}' is not a number, in the column '{column}' of {row}") from None


def with_null(row, rmse, null):
    return f"{row[rmse]} ({row[null]})" if row[rmse] != "-" else "-"


def spread(rows, column):
    """Median and range over the rows."""
    numbers = [number_in(row, column) for row in rows]
    return f"{statistics.median(numbers):.2f} ({min(numbers):.2f}..{max(numbers):.2f})"


def extremes(rows, column, digits=0):
    numbers = [number_in(row, column) for row in rows]
    texts = [f"{value:.{digits}f}" for value in (min(numbers), max(numbers))]
    return " to ".join(dict.fromkeys(texts))


def worse_than_null(table):
    return [row for row in table.rows
            if row["RMSE mm"] != "-" and number_in(row, "RMSE mm") > number_in(row, "null RMSE mm")]


class Page:
    """What stands for each {{name}} of results.md.in."""

    def __init__(self, fresh=None):
        data = yaml.safe_load((HERE / "published.yaml").read_text(encoding="utf-8"))
        self.published, self.ours, self.missing = data["published"], data["ours"], data["not_shown"]
        self.experiments = {name: Experiment(name, fresh) for name in self.ours}

    def parts(self):
        return (self.table_one() | self.table_two() | self.stand_ins() | self.endo_depth() | self.surface() |
                self.colmap() | self.nasal() | {"not_shown": self.not_shown()})

    def protocols(self, tables, experiment=None):
        lines = [published_protocol(self.published[name]) for name in tables]
        if experiment:
            lines.append(our_protocol(experiment, self.ours[experiment], self.experiments[experiment]))
        return "\n".join(lines)

    def rows_from(self, name):
        """The content of the file that has the numbers of a published table."""
        return yaml.safe_load((ROOT / self.published[name]["rows_from"]).read_text(encoding="utf-8"))

    def table_one(self):
        experiment = self.experiments["simulated_colon"]
        by_set = {name: experiment.table("RMSE mm", "with a map", heading=f"`{name}`, default")
                  for name in ("dm", "hard", "dm_endoscope")}
        preset = experiment.table("RMSE mm", "with a map", heading="`dm`, paper")
        rows = []
        for cell in self.published["table_one"]["rows"]:
            key = {"A mm": cell["amplitude"], "omega rad/s": cell["omega"]}
            of = {name: table.row(**key) for name, table in by_set.items()}
            if any(row["paper RMSE mm"] != cell["rmse"] for row in of.values()):
                raise Failure(f"published.yaml and {experiment.path} have different published numbers for {key}")
            row = [*key.values(), cell["rmse"], with_null(of["dm"], "RMSE mm", "null RMSE mm"), of["dm"]["over seeds"],
                   of["dm"]["points"], self.maps(of["dm"])]
            for name in ("hard", "dm_endoscope"):
                row += [with_null(of[name], "RMSE mm", "null RMSE mm"), self.maps(of[name])]
            rows.append([*row, with_null(preset.row(**key), "RMSE mm", "null RMSE mm")])
        met = {name: str(sum(row["met"] == "yes" for row in table.rows)) for name, table in by_set.items()}
        worse = [f"`{name}` at A = {row['A mm']} mm, omega = {row['omega rad/s']} rad/s"
                 for name, table in by_set.items() for row in worse_than_null(table)]
        header = ["A, mm", "omega, rad/s", "published", "`dm`", "over seeds", "points", "maps", "`hard`", "maps",
                  "`dm_endoscope`", "maps", "`dm`, preset `paper`"]
        return {"table_one": grid.markdown(header, rows), "cells": str(len(rows)), "dm_met": met["dm"],
                "hard_met": met["hard"], "endoscope_met": met["dm_endoscope"],
                "endoscope_none": str(sum(row["RMSE mm"] == "-" for row in by_set["dm_endoscope"].rows)),
                "worse_than_null": ", ".join(worse) or "none", "paper_rmse": extremes(preset.rows, "RMSE mm"),
                "paper_worse": str(len(worse_than_null(preset))),
                "protocol_table_one": self.protocols(["table_one"], "simulated_colon")}

    @staticmethod
    def maps(row):
        frames = next(row[column] for column in row if column.startswith("frames of"))
        return f"{row['with a map'].split()[0]}, {frames}"

    def table_two(self):
        recordings = self.rows_from("table_two")
        names = {"hamlyn_20": "Hamlyn 20", "hamlyn_21": "Hamlyn 21"}
        systems = list(dict.fromkeys(system for name in names for system in recordings[name]["reported"]))
        rows = [[system, *(value for name in names
                           for value in recordings[name]["reported"].get(system, ["-", "-"]))] for system in systems]
        header = ["system", *(f"{name}: {what}" for name in names.values() for what in ("RMSE, mm", "frames"))]
        return {"table_two": grid.markdown(header, rows), "protocol_table_two": self.protocols(["table_two"])}

    def stand_ins(self):
        table = self.experiments["hamlyn"].table("set", "start", "truth", "RMSE mm")
        groups = {}
        for row in table.rows:
            kind = row["set"].rpartition("_")[0]
            if kind in ("surface", "lobes"):
                groups.setdefault((kind, row["start"]), {}).setdefault(row["truth"], []).append(row)
        rows = []
        for (kind, start), by_truth in groups.items():
            every = [row for found in by_truth.values() for row in found]
            rows.append([f"`{kind}`, simulated", start,
                         *(spread(by_truth[truth], "RMSE mm") for truth in ("pairs", "depth")),
                         extremes(every, "null mm", 1), extremes(every, "points"), extremes(every, "frames")])
        header = ["stand-in", "start", "RMSE against the disparity of the pairs", "RMSE against the exact depth",
                  "null", "points", "frames"]
        return {"table_stand_ins": grid.markdown(header, rows), "protocol_stand_ins": self.protocols([], "hamlyn")}

    def endo_depth(self):
        hamlyn, c3vd = self.published["endo_depth_hamlyn"], self.published["endo_depth_c3vd"]
        systems = {row["system"]: row["values"] for row in self.rows_from("endo_depth_c3vd")["reported"]}
        values = systems[c3vd["row"]]
        network = hamlyn["rows"][0]
        rows = [[hamlyn["data"], hamlyn["input"], network["abs_rel"], network["sq_rel"], network["rmse"],
                 network["below"], "-"],
                [c3vd["data"], c3vd["input"], "-", "-", values["depth_rmse"], "-", values["ate_mean"]]]
        header = ["data", "input", "AbsRel", "SqRel, mm", "depth RMSE, mm", "ratio below 1.25", "camera ATE, mm"]
        return {"table_endo_depth": grid.markdown(header, rows),
                "protocol_endo_depth": self.protocols(["endo_depth_hamlyn", "endo_depth_c3vd"])}

    def surface(self):
        table = self.experiments["surface"].table("set", "run", "AbsRel, %", "one depth: AbsRel, %")
        columns = ["A, mm", "known, %", "RMSE, mm", "AbsRel, %", "one depth: AbsRel, %", "seeds"]
        rows = [[f"`{row['set']}`, simulated", *(row[column] for column in columns)]
                for row in table.rows if row["run"] == "refined_online"]
        header = ["stand-in", "A, mm", "pixels with a depth, %", "RMSE, mm", "AbsRel, %", "null: AbsRel, %", "seeds"]
        return {"table_surface": grid.markdown(header, rows), "protocol_surface": self.protocols([], "surface")}

    def colmap(self):
        table = self.experiments["rigid_baseline"].table("A, mm", "run", "surface RMSE, mm", "null")
        amplitudes = list(dict.fromkeys(row["A, mm"] for row in table.rows))
        runs = {(a, run): table.row(**{"A, mm": a, "run": run}) for a in amplitudes for run in COLMAP_RUNS}
        rows = [[a, *(f"{with_null(runs[a, run], 'surface RMSE, mm', 'null')}, {runs[a, run]['points a frame']}"
                      for run in COLMAP_RUNS), runs[a, "default"]["seeds with a map"]] for a in amplitudes]
        rmse = {key: row["surface RMSE, mm"] for key, row in runs.items()}
        factor = (number_in(runs["2.5", "colmap_tracks"], "surface RMSE, mm") /
                  number_in(runs["2.5", "default"], "surface RMSE, mm"))
        return {"table_colmap": grid.markdown(["A, mm", *COLMAP_RUNS.values(), "seeds with a map"], rows),
                "colmap_factor": f"{factor:.1f}", "colmap_rigid": rmse["0", "colmap_tracks"],
                "ours_rigid": rmse["0", "default"], "protocol_colmap": self.protocols([], "rigid_baseline")}

    def nasal(self):
        table = self.experiments["recordings"].table("recording", "variant", "depth error", "null", "ATE")
        row = table.row(recording="nasal", variant="as it is")
        return {"nasal_depth": row["depth error"], "nasal_null": row["null"], "nasal_ate": row["ATE"],
                "protocol_recordings": self.protocols([], "recordings")}

    def not_shown(self):
        return "\n".join(f"- **[{entry['what']}]({entry['url']})**, {entry['tables']}: {entry['why'].strip()}."
                         for entry in self.missing)


# The page.

def wrapped(block):
    """A paragraph or a list in lines of WIDTH, `code` not broken; tables, blocks of code and headings as they are."""
    if block.startswith(("|", "    ", "#")):
        return block
    items = [re.sub(r"`[^`]+`", lambda code: code.group().replace(" ", "\0"), " ".join(item.split()))
             for item in re.split(r"\n(?=- )", block)]
    return "\n".join(textwrap.fill(item, WIDTH, break_long_words=False, break_on_hyphens=False,
                                   subsequent_indent="  " if item.startswith("- ") else "")
                     for item in items).replace("\0", " ")


def page(fresh=None):
    text = (HERE / "results.md.in").read_text(encoding="utf-8")
    parts = Page(fresh).parts()
    names = set(re.findall(r"\{\{(\w+)\}\}", text))
    if names != set(parts):
        raise Failure(f"results.md.in and results.py do not agree on {', '.join(sorted(names ^ set(parts)))}")
    text = re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match.group(1)].strip(), text)
    return MADE_BY + "\n\n".join(wrapped(block) for block in re.split(r"\n\n+", text.strip())) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; end with 1 if the page is not current")
    parser.add_argument("--fresh", type=pathlib.Path, metavar="DIR", help="new tables are DIR/EXPERIMENT/table.md")
    parser.add_argument("--output_path", type=pathlib.Path, default=PAGE, metavar="FILE", help="the page")
    given = parser.parse_args()
    try:
        text = page(given.fresh)
    except (Failure, OSError) as failure:
        print(f"results.py: {failure}", file=sys.stderr)
        return 1
    if not given.check:
        given.output_path.write_text(text, encoding="utf-8")
        return 0
    there = given.output_path.read_text(encoding="utf-8") if given.output_path.is_file() else ""
    if there != text:
        print(f"{given.output_path.name} is not what the tables give: run python3 experiments/results/results.py")
        return 1
    print(f"{given.output_path.name} is current")
    return 0


if __name__ == "__main__":
    sys.exit(main())
