# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# First maps from synthetic rays: rows of every cross, table, plots. See two_views.md beside this file.
import os
import pathlib
import sys

TWO_VIEWS_FOLDER = pathlib.Path(str(workflow.current_basedir)).resolve()


configfile: str(TWO_VIEWS_FOLDER / "two_views.yaml")


sys.path.insert(0, str(TWO_VIEWS_FOLDER))
import two_views

TWO_VIEWS = two_views.Crosses(config["two_views"])
TWO_VIEWS_PROGRAM = TWO_VIEWS.program(TWO_VIEWS_FOLDER.parents[1], os.environ.get("PLIANT_PROGRAM"))


localrules:
    two_views,
    two_views_table,
    two_views_plot,
    two_views_readme,


rule two_views:
    input:
        "two_views/table.md",
        [f"two_views/{plot}.{suffix}" for plot in TWO_VIEWS.plots for suffix in ("png", "svg")],


rule two_views_rows:
    output:
        "two_views/{cross}.csv",
    input:
        TWO_VIEWS_PROGRAM,
    wildcard_constraints:
        cross="|".join(TWO_VIEWS.names),
    params:
        definition=lambda wildcards: TWO_VIEWS.definition(wildcards.cross),
    threads: workflow.cores
    run:
        TWO_VIEWS.run(wildcards.cross, input[0], threads, output[0])


rule two_views_table:
    output:
        markdown="two_views/table.md",
        csv="two_views/table.csv",
    input:
        [f"two_views/{cross}.csv" for cross in TWO_VIEWS.names],
    run:
        TWO_VIEWS.write_tables(input, output.markdown, output.csv)


rule two_views_plot:
    output:
        "two_views/{plot}.png",
        "two_views/{plot}.svg",
    input:
        lambda wildcards: f"two_views/{TWO_VIEWS.plots[wildcards.plot]['cross']}.csv",
    wildcard_constraints:
        plot="|".join(TWO_VIEWS.plots) or "none",
    run:
        import two_views_plot

        two_views_plot.draw(TWO_VIEWS, wildcards.plot, input[0], output)


# On request: the tables in two_views.md are those just made.
rule two_views_readme:
    input:
        "two_views/table.md",
    params:
        readme=str(TWO_VIEWS_FOLDER / "two_views.md"),
    run:
        two_views.grid.put_into_readme(params.readme, input[0])
