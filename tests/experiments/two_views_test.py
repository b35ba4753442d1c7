# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The grid of two views: its cells, its program, its workflow.

usage: two_views_test.py two_views|two_views_program|two_views_workflow PLIANT
"""

import csv
import pathlib
import subprocess
import sys

from support import MIN_PLOT_BYTES, ROOT, SKIPPED, experiment_modules, main, need, snakemake

experiment_modules("initialization")

DEPTH_ERROR = 0.02  # median, relative: of 200 points at the default noise
MIN_INLIER_SHARE = 0.7  # there are no outliers, and most pixels lie within the threshold


def two_views(folder):
    """Cells are the product of the factors; a success is better than chance; medians are over the maps alone."""
    import two_views as table

    config = {"crosses": "all", "seeds": 3, "program": "", "plots": {},
              "factors": {"solver": {"a": "--Init.solver nister", "b": "--Init.solver homography"},
                          "noise": {"0": "", "1": "--Scene.noise_px 1"}},
              "cross_options": {"both": {"options": "--Scene.noise_px 0.5", "rows": ["solver"], "columns": "noise",
                                         "factors": {"solver": "all", "noise": ["0", "1"]}}}}
    crosses = table.Crosses(config)
    cells = crosses.cells("both")
    assert len(cells) == 4 and cells[1] == {"solver": "a", "noise": "1"}, cells
    assert crosses.options("both", cells[1]) == ["--Scene.noise_px", "1", "--Init.solver", "nister"]
    config["cross_options"]["both"]["factors"]["noise"] = ["2"]
    try:
        table.Crosses(config)
        raise AssertionError("an unknown value is an error")
    except ValueError as error:
        assert str(error) == "noise of both: '2' is not one of 0, 1", error
    config["cross_options"]["both"]["factors"]["noise"] = "all"
    assert table.Crosses({**config, "program": "x"}).program(ROOT, None) == str(ROOT / "x")
    assert crosses.program(ROOT, "/b/pliant") == "/b/pliant_two_views"

    def row(solver, noise, error, null=0.3, ms=4):
        figures = {"median_depth_error": error, "null_depth_error": null, "rotation_deg": 0.5, "direction_deg": "",
                   "depth_rmse": error, "map_points": 100} if error != "" else {}
        return {"solver": solver, "noise": noise, "status": "refused" if error == "" else "made", "inlier_share": 0.9,
                "ms": ms, **dict.fromkeys(table.FIGURES[3:-2], ""), **figures}

    assert table.is_success(row("a", "0", 0.05))
    assert not table.is_success(row("a", "0", 0.11))
    assert not table.is_success(row("a", "0", 0.05, null=0.09))  # nearly as good at one distance
    assert not table.is_success(row("a", "0", ""))
    rows = [row("a", "0", 0.01), row("a", "0", 0.03), row("a", "0", "", ms=10), row("a", "1", 0.2), row("b", "1", "")]
    table.grid.write_rows(folder / "both.csv", list(rows[0]), rows)
    crosses.write_tables([folder / "both.csv"], folder / "table.md", folder / "table.csv")
    lines = (folder / "table.md").read_text(encoding="utf-8").splitlines()
    assert "| a | 67 % | 0 % | 25 % | 0.50 | - | 3.0 % | 3.0 % | 30.0 % | 4.00 |" in lines, lines
    assert "| b | - | 0 % | 100 % | - | - | - | - | - | 4.00 |" in lines, lines
    first = table.grid.read_rows(folder / "table.csv")[0]
    assert first["trials"] == "3" and first["solver"] == "a" and float(first["median_depth_error"]) == 0.02, first


def two_views_program(folder):
    """A row a trial, the same every time; a manual; wrong usage and a file that cannot be written are told apart."""
    program = str(pathlib.Path(sys.argv[2]).resolve().with_name("pliant_two_views"))

    def call(*arguments):
        return subprocess.run([program, *arguments], capture_output=True, text=True, check=False)

    def rows(name, *arguments):
        result = call("--seeds", "3", "--output_path", str(folder / name), *arguments)
        assert result.returncode == 0 and result.stdout + result.stderr == "", result
        with open(folder / name, newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key != "ms"} for row in csv.DictReader(file)]

    made = rows("made.csv", "--Scene.points", "200")
    assert [row["seed"] for row in made] == ["1", "2", "3"] and made[0]["solver"] == "nister", made
    for row in made:
        assert row["status"] == "made" and float(row["median_depth_error"]) < DEPTH_ERROR, row
        assert MIN_INLIER_SHARE < float(row["inlier_share"]) <= 1 and 0 < int(row["map_points"]) < 200, row
    assert rows("again.csv", "--Scene.points", "200") == made
    for row in rows("still.csv", "--Scene.motion", "still"):
        assert row["status"] == "refused" and row["median_depth_error"] == "" and "stood still" in row["reason"], row
    # Every start answers, with all that is wrong with the pixels.
    for method in ("gated", "paper", "window"):
        for wrong in (["--Scene.points", "0"], ["--Scene.points", "7"], ["--Scene.defect", "one_ray"]):
            for row in rows("wrong.csv", "--Init.method", method, *wrong):
                assert row["status"] == "refused" and row["reason"], (method, wrong, row)
    for row in rows("nan.csv", "--Scene.defect", "not_a_number"):
        assert row["status"] == "made" and float(row["median_depth_error"]) < DEPTH_ERROR, row

    manual = call("--help")
    assert manual.returncode == 0 and manual.stdout.startswith("pliant_two_views - "), manual
    assert "--Scene.gap_frames 20  [frames]" in manual.stdout and "--Init.solver nister" in manual.stdout
    for arguments, sentence in (([], "--output_path FILE is missing"), (["--Scene.nois_px", "1"], "--Scene.noise_px"),
                                (["--output_path", "x", "--Init.method", "depth"], "takes no rays")):
        result = call(*arguments)
        assert result.returncode == 2 and sentence in result.stderr and result.stderr.count("\n") == 1, result
        assert result.stderr.startswith("pliant_two_views: "), result
    result = call("--seeds", "1", "--output_path", str(folder / "none/rows.csv"))
    assert result.returncode == 1 and "cannot write" in result.stderr, result


def two_views_workflow(folder):
    """Rows, table and plot of one cross; a second call has nothing to do."""
    need("snakemake")
    config = folder / "small.yaml"
    config.write_text("two_views: {crosses: refinements, seeds: 1, factors: {noise_px: {'0.1': --Scene.points 100}}}\n",
                      encoding="utf-8")
    arguments = ["initialization", folder, "two_views/refinements.svg", "two_views/table.md", "--configfile", str(config)]
    try:
        snakemake(*arguments)
    except AssertionError as error:
        if "No module named 'matplotlib'" not in str(error):
            raise
        print("skipped: Snakemake's Python has no matplotlib")
        sys.exit(SKIPPED)
    with open(folder / "two_views/refinements.csv", newline="", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 4 * 2 * 3 * 2
    assert "| window | sideways | " in (folder / "two_views/table.md").read_text(encoding="utf-8")
    assert (folder / "two_views/refinements.png").stat().st_size > MIN_PLOT_BYTES
    assert "Nothing to be done" in snakemake(*arguments)


if __name__ == "__main__":
    main(two_views, two_views_program, two_views_workflow)
