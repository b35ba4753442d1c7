# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The experiments' workflows on grids small enough for a test.

usage: experiments_test.py dry_run|tables|choices|staying|soak|first_maps|first_map_plots|tiny_grid|tiny_first_maps|slurm|
                           two_views|two_views_program|two_views_workflow PLIANT
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
sys.path.insert(0, str(ROOT / "experiments/regularizers"))
sys.path.insert(0, str(ROOT / "experiments/initialization"))
sys.path.insert(0, str(ROOT / "experiments/long_sequences"))
sys.path.insert(0, str(ROOT / "experiments/soak"))


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
    assert counts["track"] == "10" and counts["reconstruct"] == "20" and counts["evaluate"] == "30", text
    text = snakemake("long_sequences", folder / "long", "--dry-run", "--quiet", "--config", "variants=all", "seeds=1,2")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == "12" and counts["track"] == counts["evaluate"] == str(12 * 10), text
    text = snakemake("soak", folder / "soak", "--dry-run", "--quiet", "--config", "alone_corners=300,500")
    counts = {line.split()[0]: line.split()[1] for line in text.splitlines() if len(line.split()) > 1}
    assert counts["simulate"] == "1" and counts["repeat"] == "2" and counts["track"] == "4", text
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


def soak(folder):
    """A way repeated, a program's memory, the frames that count, and the line between two runs; by hand."""
    import soak as figures

    (folder / "way/images").mkdir(parents=True)
    (folder / "way/camera.yaml").write_text("model: PINHOLE\n", encoding="utf-8")
    for i in range(3):
        (folder / f"way/images/{i:06d}.png").write_text(str(i), encoding="utf-8")
    figures.repeat(folder / "way", folder / "long", 3, 8)
    images = sorted((folder / "long/images").iterdir())
    assert [path.read_text(encoding="utf-8") for path in images] == list("01201201"), images
    assert (folder / "long/camera.yaml").exists()

    program = folder / "program"
    program.write_text('#!/bin/sh\nmkdir -p "$5"\necho "$@" > "$5/arguments"\n', encoding="utf-8")
    program.chmod(0o755)
    figures.track(program, "sequence", folder / "run", ["--a", "b"])
    assert (folder / "run/arguments").read_text(encoding="utf-8").endswith("--quiet --a b\n")
    assert 0.5 < figures.json.loads((folder / "run/process.json").read_text(encoding="utf-8"))["peak_mb"] < 100

    # 40 slow frames make the map, 100 are told at either end of 1000; the reader's time does not count.
    figures.FIRST = 40
    with open(folder / "run/frames.csv", "w", encoding="utf-8") as file:
        file.write("frame,tracked,ms_prepare,ms_pose,ms_joint\n")
        for i in range(1000):
            file.write(f"{i},{500 if i < 140 else 0},77,{90 if i < 40 else 3 if i < 140 else 5},1\n")
    (folder / "run/run.json").write_text('{"counts": {"frames_tracked": 1000}, "timings": {"frames_per_second": 25}}',
                                         encoding="utf-8")
    row = figures.row_of("long", folder / "run", 140)
    assert (row["points"], row["ms"], row["ms_last"], row["median_ms"]) == (500, 4, 6, 4), row
    runs = [{"points": points, "ms": ms} for points, ms in ((100, 1), (400, 10), (600, 20))]
    assert figures.alone_at(450, runs) == 12.5 and figures.alone_at(700, runs) == 25, "on the line through the nearest"


def staying(folder):
    """What counts as visible, as survived, and as an end-point's error; of a run and a sequence made by hand."""
    import staying as figures

    sequence, run = folder / "seq", folder / "runs/default/loop_A2.5_w2.5_s3"
    (run / "evaluation").mkdir(parents=True)
    sequence.mkdir()
    (sequence / "simulation.yaml").write_text(
        "Sensor:  # levels\n  blackout_period_s: 9\nInterruption:  # what\n  blackout_period_s: 1  # [s] how often\n"
        "  blackout_s: 0.2  # [s]\n  blur_period_s: 0\n  blur_s: 1\nCamera:\n  blackout_s: 7\n", encoding="utf-8")
    times = [0.1 * i for i in range(32)]
    (sequence / "groundtruth.txt").write_text("".join(f"{t:.6f} {t:.6f} 0 0 0 0 0 1\n" for t in times), encoding="utf-8")
    dark = {10, 11, 20, 21, 30, 31}
    # Lost in the dark; after the second black-out another map is there, after the third nothing follows.
    rows = [{"frame": i, "state": "lost" if i in dark or i == 22 else "tracking", "submap": int(i > 22),
             "optimized": 0 if i in dark else 100 + i, "ms_a": 3, "ms_b": 4} for i in range(32)]
    figures.grid.write_rows(run / "frames.csv", list(rows[0]), rows)
    (run / "run.json").write_text('{"counts": {"submaps": 1}}', encoding="utf-8")
    (run / "trajectory.txt").write_text("".join(f"{t:.6f} {2.1 * t:.6f} 0 0 0 0 0 1\n" for i, t in enumerate(times)
                                                if rows[i]["state"] == "tracking"), encoding="utf-8")
    (run / "evaluation/evaluation.json").write_text(
        '{"surface": {"estimate": {"mean_rmse_mm": 1.5}}, "trajectory": {"scale": 0.5}}', encoding="utf-8")
    figures.grid.write_rows(run / "evaluation/evaluation.csv", ["frame", "rmse_mm", "scale"],
                            [{"frame": i, "rmse_mm": 1 + i, "scale": 2} for i in range(30) if i not in dark])
    row = figures.figures_of(run, sequence)
    assert row["visible_frames"] == 26 and row["tracked_visible"] == 25, row
    assert row["blackouts"] == 3 and row["blackouts_survived"] == 1, row
    assert row["fewest_points"] == 100 and row["ms_per_frame"] == 7, row
    assert abs(row["path_mm"] - 2.9) < 1e-9 and abs(row["end_point_mm"] - 0.05 * 2.9) < 1e-9, row
    assert row["scale_drift"] == 0 and row["rmse_mm"] == 1.5, row
    figures.write([(run, sequence)], folder / "table.md", folder / "table.csv")
    line = (folder / "table.md").read_text(encoding="utf-8").splitlines()[2]
    assert line.startswith("| loop | 2.5 | default | 96.2 | 1 of 3 | 1.0 |") and line.endswith("| 5.00 |"), line


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
    assert abs(float(gated["median_depth"]) - 0.19) < 1e-12 and float(gated["frames_before"]) == 39, gated
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
    assert float(true_map["median_depth"]) < 0.001 and true_map["rotation_error_deg"] == "", true_map
    assert float(true_map["null_median_depth"]) > 0.01 and true_map["frames_after"] == "11", true_map
    assert paper["declared"] == "yes" and paper["frames_waited"] == "3", paper
    assert float(paper["median_depth"]) > 0.001 and float(paper["rotation_error_deg"]) > 0, paper
    assert float(paper["initializer_ms"]) >= float(paper["initializer_largest_ms"]) > 0, paper
    assert gated["declared"] == "no" and gated["median_depth"] == "" and gated["note"] != "", gated
    assert "| gated | 0 | 0 | - (-) |" in (folder / "table.md").read_text(encoding="utf-8")


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
        assert row["status"] == "made" and float(row["median_depth_error"]) < 0.02, row
        assert 0.7 < float(row["inlier_share"]) <= 1 and 0 < int(row["map_points"]) < 200, row
    assert rows("again.csv", "--Scene.points", "200") == made
    for row in rows("still.csv", "--Scene.motion", "still"):
        assert row["status"] == "refused" and row["median_depth_error"] == "" and "stood still" in row["reason"], row
    # Every start answers, with all that is wrong with the pixels.
    for method in ("gated", "paper", "window"):
        for wrong in (["--Scene.points", "0"], ["--Scene.points", "7"], ["--Scene.defect", "one_ray"]):
            for row in rows("wrong.csv", "--Init.method", method, *wrong):
                assert row["status"] == "refused" and row["reason"], (method, wrong, row)
    for row in rows("nan.csv", "--Scene.defect", "not_a_number"):
        assert row["status"] == "made" and float(row["median_depth_error"]) < 0.02, row

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
    assert (folder / "two_views/refinements.png").stat().st_size > 10000
    assert "Nothing to be done" in snakemake(*arguments)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        for part in ("colon", "regularizers", "initialization", "baseline", "cache", "grid"):
            (pathlib.Path(temporary) / part).mkdir()
        globals()[sys.argv[1]](pathlib.Path(temporary))
    print("passed")
