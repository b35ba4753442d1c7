# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experiments' workflows on grids small enough for a test.

usage: experiments_test.py dry_run|tables|choices|tiny_grid|slurm PLIANT
"""

import csv
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
# One cell, 12 frames of 160x120 of a coarse scene. The method's own start finds no map in so few; an oracle's does.
TINY = ["--config", "sets=dm", "cells=2.5:2.5", "seeds=1", "frames=12", "variants=default,oracle_all",
        "simulate_options=--Camera.width 160 --Camera.height 120 --Scene.mesh_step_mm 0.8 --Scene.view_mm 120 "
        "--Texture.texel_mm 0.3 --Texture.smallest_mm 0.8"]

sys.path.insert(0, str(ROOT / "experiments/common"))
sys.path.insert(0, str(ROOT / "experiments/simulated_colon"))
sys.path.insert(0, str(ROOT / "experiments/regularisers"))


def need(*programs):
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        print(f"skipped: {', '.join(missing)} not found")
        sys.exit(SKIPPED)


def snakemake(experiment, folder, *arguments, **environment):
    result = subprocess.run(
        ["snakemake", "--snakefile", str(ROOT / "experiments" / experiment / "Snakefile"), "--directory", str(folder),
         "--cores", "2", *arguments],
        env={**os.environ, "PLIANT_PROGRAM": os.path.abspath(sys.argv[2]), "XDG_CACHE_HOME": str(folder / "cache"),
             **environment},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert result.returncode == 0, result.stdout
    return result.stdout


def check_tiny_grid(folder):
    with open(folder / "figures.csv", newline="", encoding="utf-8") as file:
        none, oracle = csv.DictReader(file)
    assert none["variant"] == "default" and none["status"] == "failed" and none["rmse_mm"] == "", none
    assert oracle["variant"] == "oracle_all" and oracle["frames_tracked"] == "12", oracle
    assert 0 < float(oracle["rmse_mm"]) < 1.77, oracle  # everything is true: far below the paper's
    lines = (folder / "table.md").read_text(encoding="utf-8").splitlines()
    overview = next(line for line in lines if line.startswith("| 2.5 | 2.5 | 1.77 |"))
    assert overview == f"| 2.5 | 2.5 | 1.77 | - | {float(oracle['rmse_mm']):.2f} |", overview


def dry_run(folder):
    """Every experiment's full grid can be planned: 5 seeds of 7 cells of 2 sets; every start with every choice."""
    need("snakemake")
    text = snakemake("simulated_colon", folder / "colon", "--dry-run", "--quiet")
    counts = {line.split()[0]: int(line.split()[1]) for line in text.splitlines() if line.split()[1:2] and
              line.split()[1].isdigit()}
    assert counts["simulate"] == 70 and counts["track"] == 70 * 7 and counts["evaluate"] == 70 * 7, text
    text = snakemake("regularisers", folder / "regularisers", "--dry-run", "--quiet", "--config", "sequences=", "sets=dm",
                     "cells=0:0", "seeds=1", "starts=true_map", "choices=spatial_off")
    assert "track" in text and "  2  " in next(line for line in text.splitlines() if line.startswith("track")), text


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


def tiny_grid(folder):
    """Simulate, track, evaluate, table; a second call has nothing to do; one that was stopped goes on."""
    need("snakemake")
    snakemake("simulated_colon", folder, *TINY)
    check_tiny_grid(folder)
    assert "Nothing to be done" in snakemake("simulated_colon", folder, *TINY)
    shutil.rmtree(folder / "runs/oracle_all")  # as if it had been stopped there
    for name in ("figures.csv", "table.md", "table.csv"):
        (folder / name).unlink()
    text = snakemake("simulated_colon", folder, *TINY)
    assert "rule track:" in text and "rule simulate:" not in text and text.count("rule track:") == 1, text
    check_tiny_grid(folder)


def slurm(folder):
    """The same through the Slurm profile, on this machine as a cluster of one node."""
    need("snakemake", "munged", "slurmctld", "slurmd", "sbatch")
    cluster = [str(ROOT / "third_party_configs/slurm/one_node.sh")]
    os.environ["SLURM_ONE_NODE_PORT"] = str(20000 + os.getpid() % 20000)
    subprocess.run(cluster + ["start", str(folder / "slurm")], check=True)
    try:
        snakemake("simulated_colon", folder / "grid", "--profile", str(ROOT / "third_party_configs/snakemake/slurm"), *TINY,
                  SLURM_CONF=str(folder / "slurm/slurm.conf"))
        check_tiny_grid(folder / "grid")
        assert len(list((folder / "grid/slurm").glob("track-*.log"))) == 2
    finally:
        subprocess.run(cluster + ["stop", str(folder / "slurm")], check=False)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        for part in ("colon", "regularisers", "cache", "grid"):
            (pathlib.Path(temporary) / part).mkdir()
        globals()[sys.argv[1]](pathlib.Path(temporary))
    print("passed")
