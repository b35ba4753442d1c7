# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# First maps of rendered scenes: every start on every scene, its figures, its tables and its plots.
include: "../common/grid.smk"


sys.path.insert(0, workflow.basedir)
import rendered


localrules:
    first_maps,
    plots,


rule first_maps:
    output:
        "first_maps.csv",
    input:
        [f"{run}/evaluation/evaluation.json" for run in GRID.runs()],
    params:
        frames_after=config["frames_after"],
    run:
        rendered.write_figures(GRID.runs(), int(params.frames_after), output[0])


rule table:
    output:
        markdown="table.md",
        csv="table.csv",
    input:
        "first_maps.csv",
    params:
        limits=(config["failed_above"], config["frames_after"]),
        cell_names=config["cell_names"],
    run:
        rendered.write(input[0], rendered.Limits(*map(float, params.limits)), params.cell_names, output.markdown, output.csv)


rule plots:
    output:
        [f"{name}.{ending}" for name in ("depth_error", "failures", "waiting") for ending in ("png", "svg")],
    input:
        "first_maps.csv",
    params:
        limits=(config["failed_above"], config["frames_after"]),
        cell_names=config["cell_names"],
    run:
        import rendered_plots

        rendered_plots.write(input[0], rendered.Limits(*map(float, params.limits)), params.cell_names, ".")
