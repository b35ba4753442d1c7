# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The rules that every experiment on a grid shares: simulate -> track -> evaluate -> figures.csv. An experiment's
# Snakefile names its config file, includes this, and turns figures.csv into table.md and table.csv in a rule `table`.
# Paths are relative to the working directory, where everything is left; `./run experiment` sets it.
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(workflow.current_basedir).resolve()))
import grid

EXPERIMENT = pathlib.Path(workflow.basedir)
ROOT = EXPERIMENT.parent.parent
GRID = grid.Grid(config)
PROGRAM = os.environ.get("PLIANT_PROGRAM") or str(ROOT / config["program"])
THREADS = int(config["threads"])
# Which table stands in which document of the experiment; one with more documents adds them.
DOCUMENTS = {"README.md": "table.md"}


# The mark of a whole sequence: among those that were rendered elsewhere, or here.
def sequence_of(scene):
    elsewhere = config["sequences"] and ROOT / config["sequences"] / scene / "done"
    return str(elsewhere) if elsewhere and elsewhere.exists() else f"sequences/{scene}/done"


wildcard_constraints:
    scene=r"\w+_A[\d.]+_w[\d.]+_s\d+",
    variant=r"[\w.-]+",


localrules:
    figures,
    table,
    readme,


# Rendering takes longest, so a new build of the program alone does not repeat it; `--forcerun simulate` does.
rule simulate:
    output:
        touch("sequences/{scene}/done"),
    input:
        ancient(PROGRAM),
    params:
        options=lambda wildcards: GRID.simulate_options(wildcards.scene),
    threads: THREADS
    shell:
        "{input} simulate --overwrite --output_path sequences/{wildcards.scene} --quiet {params.options} --Simulation.threads {threads}"


# A run that never found a first map is an answer (`failed`, no frame tracked); an interrupted one is none.
rule track:
    output:
        "runs/{variant}/{scene}/run.json",
    input:
        program=PROGRAM,
        done=lambda wildcards: sequence_of(wildcards.scene),
    params:
        sequence=lambda wildcards, input: os.path.dirname(input.done),
        run="runs/{variant}/{scene}",
        options=lambda wildcards: GRID.track_options(wildcards.variant),
    threads: THREADS
    shell:
        "rm -rf {params.run}\n"
        "{input.program} track --image_path {params.sequence} --output_path {params.run} --quiet"
        " --General.threads {threads} {params.options} || grep -q '\"status\": \"failed\"' {output}"


# A variant refined_X is the run of variant X, refined. Of a run without a map there is nothing to refine: its refined
# run is that run.
rule refine:
    output:
        "runs/refined_{variant}/{scene}/run.json",
    input:
        program=PROGRAM,
        run="runs/{variant}/{scene}/run.json",
    params:
        run="runs/{variant}/{scene}",
        refined="runs/refined_{variant}/{scene}",
        options=config.get("refine_options", ""),
    shell:
        "rm -rf {params.refined}\n"
        "if grep -q '\"frames_tracked\": 0' {input.run}; then cp -r {params.run} {params.refined}; else"
        " {input.program} refine --run {params.run} --output_path {params.refined} --quiet {params.options}; fi"


ruleorder: refine > track


rule evaluate:
    output:
        "runs/{variant}/{scene}/evaluation/evaluation.json",
    input:
        program=ancient(PROGRAM),
        run="runs/{variant}/{scene}/run.json",
        done=lambda wildcards: ancient(sequence_of(wildcards.scene)),
    params:
        sequence=lambda wildcards, input: os.path.dirname(input.done),
        run="runs/{variant}/{scene}",
        options=config.get("evaluate_options", ""),
    shell:
        "if grep -q '\"frames_tracked\": 0' {input.run}; then echo '{{}}' >{output}; else"
        " {input.program} evaluate --run {params.run} --sequence {params.sequence}"
        " --output_path {params.run}/evaluation --quiet {params.options}; fi"


rule figures:
    output:
        "figures.csv",
    input:
        [f"{run}/evaluation/evaluation.json" for run in GRID.runs()],
    run:
        grid.write_rows(output[0], grid.COLUMNS, [grid.figures_of(run) for run in GRID.runs()])


# On request: the tables in the experiment's documents are those just made.
rule readme:
    input:
        lambda wildcards: DOCUMENTS.values(),
    run:
        for document, table in DOCUMENTS.items():
            grid.put_into_readme(EXPERIMENT / document, table)
