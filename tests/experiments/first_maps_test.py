# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures, plots and the workflow of first maps.

usage: first_maps_test.py first_maps|first_map_plots|tiny_first_maps PLIANT
"""

import csv
import os
import subprocess
import sys

from support import ROOT, ROUND_OFF, SKIPPED, TINY, experiment_modules, main, need, snakemake

experiment_modules("initialization")

TRUE_DEPTH = 0.001  # median, relative: steps of depth images
FLAT_DEPTH = 0.01  # the scene is not flat
LIMITS = (0.1, 50)
CELL_NAMES = {"0:0": "rigid", "5:5": "fast"}


def made_up_first_maps():
    """Two seeds of `gated` in a fast scene, of which one failed; one of `window`, and one without a map."""

    def row(variant, seed, cell=("5", "5"), **figures):
        return {"set": "dm", "amplitude_mm": cell[0], "omega_rad_s": cell[1], "seed": seed, "variant": variant,
                "declared": "yes" if figures else "no", **figures}

    return [row("gated", 1, median_depth=0.08, rmse_depth=0.2, null_median_depth=0.3, frames_waited=8, frames_before=8,
                rotation_error_deg=1, true_rotation_deg=2, initializer_ms=100, rmse_mm_after=3, frames_after=50),
            row("gated", 2, median_depth=0.3, rmse_depth=0.4, null_median_depth=0.3, frames_waited=10, frames_before=70,
                rotation_error_deg=3, true_rotation_deg=4, initializer_ms=300, rmse_mm_after=5, frames_after=20),
            row("window", 1, median_depth=0.01, rmse_depth=0.02, null_median_depth=0.2, frames_waited=30),
            row("window", 2), row("true_map", 1, ("0", "0"), median_depth=0, null_median_depth=0.2, frames_waited=0)]


def first_maps(folder):
    """Shares are of all runs, medians of those with a map; the surface error is that of the frame reached."""
    import grid
    import rendered

    grid.write_rows(folder / "first_maps.csv", rendered.FIGURES, made_up_first_maps())
    rendered.write(folder / "first_maps.csv", rendered.Limits(*LIMITS), CELL_NAMES, folder / "table.md",
                   folder / "table.csv")
    gated, window, true_map = grid.read_rows(folder / "table.csv")
    assert gated["speed"] == "fast" and gated["runs"] == "2", gated
    assert float(gated["declared_share"]) == 1 and float(gated["failed_share"]) == 0.5, gated
    assert abs(float(gated["median_depth"]) - 0.19) < ROUND_OFF and float(gated["frames_before"]) == 39, gated
    assert float(gated["rmse_mm_after"]) == 4 and float(gated["frames_after"]) == 35, gated
    assert float(window["declared_share"]) == 0.5 and float(window["failed_share"]) == 0, window
    assert float(window["median_depth"]) == 0.01 and window["rotation_error_deg"] == "", window
    assert true_map["set"] == "dm" and true_map["speed"] == "rigid", true_map
    text = (folder / "table.md").read_text(encoding="utf-8")
    assert "| gated | 100 | 50 | 19.0 (30.0) | 30.0 | 9 | 39 | 2.00 (3.00) | - | 200 | - | 4.00 (-) | 35 |" in text, text
    assert "### `dm`, fast (A 5 mm, omega 5 rad/s)" in text, text

    frames = [{"frame": frame} for frame in (3, 4, 5, 9)]
    assert rendered.after(frames, 4, 2)["frame"] == 5
    assert rendered.after(frames, 4, 50)["frame"] == 9
    assert rendered.after(frames, 10, 50) is None
    assert rendered.speed_of(("2.5", "5"), CELL_NAMES) == "A 2.5, omega 5"


def first_map_plots(folder):
    """Every plot is made, of starts that are not in every cell too."""
    import grid
    import rendered

    # Debian's matplotlib belongs to Debian's Python.
    pythons = [python for python in (sys.executable, "/usr/bin/python3") if os.path.exists(python) and
               subprocess.run([python, "-c", "import matplotlib"], stderr=subprocess.DEVNULL, check=False).returncode == 0]
    if not pythons:
        print("skipped: matplotlib not found")
        sys.exit(SKIPPED)
    grid.write_rows(folder / "first_maps.csv", rendered.FIGURES, made_up_first_maps())
    folders = [str(ROOT / "experiments" / name) for name in ("common", "initialization")]
    program = (f"import sys; sys.path[:0] = {folders}; import rendered, rendered_plots; rendered_plots.write("
               f"'first_maps.csv', rendered.Limits(*{LIMITS}), {CELL_NAMES}, '.')")
    subprocess.run([pythons[0], "-W", "error", "-c", program], cwd=folder, check=True)
    for name in ("depth_error", "failures", "waiting"):
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG"), name
        assert "</svg>" in (folder / f"{name}.svg").read_text(encoding="utf-8"), name


def tiny_first_maps(folder):
    """The true map is there at once and true, the published start waits for its frames, the gated one for more than these."""
    need("snakemake")
    snakemake("initialization", folder, "table", *[argument.replace("default,oracle_all", "true_map,paper,gated")
                                                   for argument in TINY])
    with open(folder / "first_maps.csv", newline="", encoding="utf-8") as file:
        true_map, paper, gated = csv.DictReader(file)
    assert true_map["declared"] == "yes" and true_map["frames_waited"] == "0", true_map
    assert float(true_map["median_depth"]) < TRUE_DEPTH and true_map["rotation_error_deg"] == "", true_map
    assert float(true_map["null_median_depth"]) > FLAT_DEPTH and true_map["frames_after"] == "11", true_map
    assert paper["declared"] == "yes" and paper["frames_waited"] == "3", paper
    assert float(paper["median_depth"]) > TRUE_DEPTH and float(paper["rotation_error_deg"]) > 0, paper
    assert float(paper["initializer_ms"]) >= float(paper["initializer_largest_ms"]) > 0, paper
    assert gated["declared"] == "no" and gated["median_depth"] == "" and gated["note"] != "", gated
    assert "| gated | 0 | 0 | - (-) |" in (folder / "table.md").read_text(encoding="utf-8")


if __name__ == "__main__":
    main(first_maps, first_map_plots, tiny_first_maps)
