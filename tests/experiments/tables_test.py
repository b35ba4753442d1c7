# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the grids of scenes and choices.

usage: tables_test.py tables|before_and_after|dense_depths|choices PLIANT
"""

import os

from support import experiment_modules, main

experiment_modules("simulated_colon", "regularizers", "refinement", "surface")


def tables(folder):
    """A median over seeds counts a run without a map as worse than any other, and says that it is there."""
    import grid
    import table_one

    def row(seed, rmse, points=150, frames=95):
        return {"set": "dm", "amplitude_mm": "5", "omega_rad_s": "2.5", "seed": seed, "variant": "default",
                "status": "completed", "rmse_mm": rmse, "points": points, "frames_tracked": frames}

    def overview(rows):
        grid.write_rows(folder / "figures.csv", grid.COLUMNS, rows)
        table_one.write(folder / "figures.csv", 100, folder / "table.md", folder / "table.csv")
        text = (folder / "table.md").read_text(encoding="utf-8")
        return [line for line in text.splitlines() if line.startswith("| 5 | 2.5 | 1.84 |")][0].split(" | ")[-1], text

    assert overview([row(1, 1.0), row(2, 1.5), row(3, 9.0)])[0] == "**1.50** |"
    assert overview([row(1, 1.0), row(2, 1.5), row(3, "")])[0] == "**1.50** |"
    assert "2 of 3" in overview([row(1, 1.0), row(2, 1.5), row(3, "")])[1]
    assert overview([row(1, 1.0), row(2, ""), row(3, "")])[0] == "- |"
    assert overview([row(1, 1.0), row(2, 1.9), row(3, 9.0)])[0] == "1.90 |"  # not met
    assert overview([row(1, 1.0, points=99)])[0] == "1.00 |"  # too few points
    assert overview([row(1, 1.0, frames=89)])[0] == "1.00 |"  # too few frames

    readme = folder / "README.md"
    readme.write_text("before\n<!-- table -->\nold\n<!-- end of table -->\nafter\n", encoding="utf-8")
    (folder / "new.md").write_text("new\n", encoding="utf-8")
    for _ in range(2):  # putting it there twice changes nothing
        grid.put_into_readme(readme, folder / "new.md")
        assert readme.read_text(encoding="utf-8") == \
            "before\n<!-- table -->\n\nnew\n\n<!-- end of table -->\nafter\n"


def before_and_after(folder):
    """Runs are compared seed by seed; one that has no map before or after has no part in it."""
    import json

    import before_after
    import grid

    runs = grid.Grid({"sets": "dm", "set_options": {"dm": ""}, "variants": "online, refined_online", "seeds": "1, 2, 3",
                      "variant_options": {"online": "", "refined_online": ""}, "cells": "5:2.5"})
    rmse_mm = {"online": (2.0, 1.0, None), "refined_online": (0.8, 0.6, None)}
    for variant, values in rmse_mm.items():
        for seed, value in zip((1, 2, 3), values):
            evaluation = {"surface": {"estimate": {"mean_rmse_mm": value}}, "run_seconds": 1,
                          "uncertainty": {"within_1_sigma": 0.7, "within_2_sigma": 0.9, "nees": 1,
                                          "sparsification": {"area": 0.5, "oracle_area": 0.3}}} if value else {}
            path = folder / f"runs/{variant}/dm_A5_w2.5_s{seed}/evaluation/evaluation.json"
            path.parent.mkdir(parents=True)
            path.write_text(json.dumps(evaluation), encoding="utf-8")
    os.chdir(folder)
    before_after.write(runs, folder / "table.md", folder / "table.csv")
    line = (folder / "table.md").read_text(encoding="utf-8").splitlines()[2]
    assert line == ("| dm | 5 | 2.5 | online | 2 of 3 | 1.50 | 0.70 | - | - | 0.50 | 0.40..0.60 | 70, 90 | 70, 90 |"), line
    assert len(grid.read_rows(folder / "table.csv")) == 4


def dense_depths(folder):
    """A row a run in the CSV; medians over the seeds that have a depth in the table."""
    import json

    import dense
    import grid

    runs = grid.Grid({"sets": "dm", "set_options": {"dm": ""}, "variants": "online", "seeds": "1, 2, 3",
                      "variant_options": {"online": ""}, "cells": "5:2.5"})
    for seed, rmse in ((1, 0.4), (2, 0.6), (3, None)):
        path = folder / f"runs/online/dm_A5_w2.5_s{seed}/dense"
        (path / "surface").mkdir(parents=True)
        figures = {"rmse_mm": rmse, "abs_rel": 0.01, "within_2_mm": 0.9}
        evaluation = {"surface": {"estimate": {"mean_rmse_mm": 0.5}},
                      "dense": {"known_share": 0.8, "textured": {"known_share": 0.9}, "estimate": figures, "certain_half": figures,
                                "interpolation": figures, "null": figures, "mesh": figures if seed == 1 else None,
                                "mesh_alone": figures, "within_1_sigma": 0.7,
                                "within_2_sigma": 0.95}} if rmse else {}
        (path / "evaluation.json").write_text(json.dumps(evaluation), encoding="utf-8")
        (path / "surface/surface.json").write_text(json.dumps({"frames": [{"seconds": 1.0}, {"seconds": 1.4}]}),
                                                   encoding="utf-8")
    os.chdir(folder)
    dense.write(runs, folder / "table.md", folder / "table.csv")
    line = (folder / "table.md").read_text(encoding="utf-8").splitlines()[2]
    assert line == ("| dm | 5 | 2.5 | online | 2 of 3 | 0.50 | 80 | 90 | 0.50 | 1.00 | 0.50 | 0.50 | 1.00 | 1.0 | 0.40 | 90 | "
                    "70 | 95 | 1.2 |"), line
    assert len(grid.read_rows(folder / "table.csv")) == 2


def choices(folder):
    """A choice is compared with the default of its own start, in the cells where it tracked about as many frames."""
    import choices as table
    import grid

    def row(variant, amplitude, rmse, frames):
        return {"set": "dm", "amplitude_mm": amplitude, "omega_rad_s": "5", "seed": 1, "variant": variant,
                "status": "completed", "rmse_mm": rmse, "points": 150, "frames_tracked": frames, "frames_per_second": 20}

    grid.write_rows(folder / "figures.csv", grid.COLUMNS, [
        row("own_map.default", "5", 2.0, 100), row("own_map.default", "10", 3.0, 100),
        row("own_map.halved", "5", 1.0, 100), row("own_map.halved", "10", 1.5, 91),
        row("own_map.short", "5", 1.0, 30), row("own_map.short", "10", 6.0, 100),
        row("own_map.none", "5", "", 0), row("own_map.none", "10", "", 0)])
    table.write(folder / "figures.csv", 100, folder / "table.md", folder / "table.csv")
    by_choice = {line["choice"]: line for line in grid.read_rows(folder / "table.csv")}
    assert by_choice["default"]["ratio"] == "1.00"
    assert by_choice["halved"]["ratio"] == "0.50"
    assert by_choice["short"]["ratio"] == "2.00 (1 of 2)"
    assert by_choice["short"]["dm A 5, omega 5"] == "1.00 (30 frames)"
    assert by_choice["none"]["ratio"] == "-" and by_choice["none"]["dm A 5, omega 5"] == "-"

    config = {"starts": "true_map", "choices": "b", "start_options": {"true_map": "--Oracle.first_map on", "own_map": ""},
              "choice_options": {"default": "", "a": "--a 1", "b": "--b 2"}}
    assert table.variants(config)["variants"] == ["true_map.default", "true_map.b"]
    assert table.variants(config)["variant_options"]["true_map.b"] == "--Oracle.first_map on --b 2"


if __name__ == "__main__":
    main(tables, before_and_after, dense_depths, choices)
