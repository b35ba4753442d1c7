# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experiments' workflows: planned whole, and run on grids small enough for a test.

usage: workflows_test.py dry_run|tiny_grid|slurm PLIANT
"""

import os
import shutil
import subprocess

from support import ROOT, TINY, check_tiny_grid, main, need, snakemake


def dry_run(folder):
    """Every experiment's full grid can be planned: 5 seeds of 7 cells of 2 sets; every start with every choice."""
    need("snakemake")
    text = snakemake("simulated_colon", folder / "colon", "--dry-run", "--quiet")
    counts = {line.split()[0]: int(line.split()[1]) for line in text.splitlines() if line.split()[1:2] and
              line.split()[1].isdigit()}
    assert counts["simulate"] == 105 and counts["track"] == counts["evaluate"] == 70 * 7 + 35, text
    text = snakemake("regularizers", folder / "regularizers", "--dry-run", "--quiet", "--config", "sequences=", "sets=dm",
                     "cells=0:0", "seeds=1", "starts=true_map", "choices=spatial_off")
    assert "track" in text and "  2  " in next(line for line in text.splitlines() if line.startswith("track")), text
    text = snakemake("initialization", folder / "initialization", "--dry-run", "--quiet", "--config", "sequences=",
                     "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == "32" and counts["track"] == counts["evaluate"] == str(32 * 11), text
    assert "two_views_rows" in text and "two_views_plot" in text, text
    text = snakemake("initialization", folder / "initialization", "readme", "--dry-run", "--quiet", "--config",
                     "sequences=", "seeds=1")
    assert "first_maps" in text and "two_views_table" in text, text  # a table for each document
    text = snakemake("rigid_baseline", folder / "baseline", "--dry-run", "--quiet", "--config", "sequences=", "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["track"] == "10" and counts["reconstruct"] == "20" and counts["evaluate"] == "40", text
    assert counts["refine"] == "10", text
    text = snakemake("refinement", folder / "refinement", "--dry-run", "--quiet", "--config", "sequences=", "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["track"] == counts["refine"] == "28" and counts["evaluate"] == "56", text
    text = snakemake("surface", folder / "surface", "--dry-run", "--quiet", "--config", "sequences=", "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["track"] == counts["refine"] == "16" and counts["dense_depth"] == "32", text
    text = snakemake("long_sequences", folder / "long", "--dry-run", "--quiet", "--config", "variants=all", "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == counts["refine"] == "12" and counts["track"] == str(12 * 10), text
    assert counts["evaluate"] == str(12 * 11), text
    text = snakemake("soak", folder / "soak", "--dry-run", "--quiet", "--config", "alone_corners=300,500")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == "1" and counts["repeat"] == "2" and counts["track"] == "4", text
    text = snakemake("parts", folder / "parts", "--dry-run", "--quiet", "--config", "frames=1000")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["part"] == "7" and counts["join"] == counts["whole"] == counts["simulate"] == "1", text
    text = snakemake("parts", folder / "film", "--dry-run", "--quiet", "--config", "image_path=/film.mp4", "frames=300",
                     "compare=false")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["part"] == "2" and "whole" not in counts and "simulate" not in counts, text
    text = snakemake("fisheye", folder / "fisheye", "--dry-run", "--quiet")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == counts["track"] == counts["evaluate"] == "12", text
    text = snakemake("hamlyn", folder / "hamlyn", "--dry-run", "--quiet")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == counts["film"] == "6" and counts["track"] == counts["evaluate"] == "36", text
    recording = folder / "recording.avi"
    recording.write_bytes(b"pairs")
    text = snakemake("hamlyn", folder / "recorded", "--dry-run", "--quiet", "--config", f"hamlyn_20={recording}",
                     "stand_ins=none")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["track"] == counts["evaluate"] == "3" and "simulate" not in counts, text


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
    main(dry_run, tiny_grid, slurm)
