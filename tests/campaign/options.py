# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random options of `pliant track`, within the ranges that the program states where it refuses a value."""

import functools
import math
import re
import subprocess

# Paths, threads, and what serves or reads live images.
LEFT_OUT = ("General.threads", "LiveInput.", "Live.", "TrackFile.")
FILES = {"Init.model_path": "run/sparse", "DepthPrior.path": "seq/depth"}  # of the material
# More only costs time, or demands more points than the images have, which ends a run before it begins.
MOST = {"Corners.max_corners": 1000, "Corners.border_px": 40, "Corners.min_distance_px": 30,
        "Init.max_iterations": 3000, "Init.min_points": 50, "Init.depth_min_points": 50,
        "Init.model_min_points": 50, "Init.stereo_min_points": 50,
        "WindowInit.min_points": 50, "WindowInit.min_views": 20, "WindowInit.max_points": 1000, "WindowInit.views": 50,
        "WindowInit.rigid_views": 50, "Window.nodes": 60, "Window.sample_points": 1000, "Window.max_iterations": 100,
        "CameraPose.min_points": 50, "CameraPose.max_iterations": 1000, "Optimization.min_points": 50,
        "Optimization.max_iterations": 2000, "Tracking.min_points": 50, "Tracking.min_corners": 50,
        "Relocalization.max_corners": 2000, "AbsolutePose.max_iterations": 5000, "Refine.max_iterations": 60,
        "Refine.nodes_in_view": 60, "Refine.views_per_track": 100, "Refine.max_rank": 8}
GROUP = re.compile(r"(\w+):")
OPTION = re.compile(r"  (\w+): +(\S+) +# \[(.*?)\]")
RANGE = re.compile(r"give a (whole )?number from (\S+) to (\S+)")


def _answer(program, *words):
    return subprocess.run([program, "track", "seq", "--print_config", *words], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, check=False)


@functools.cache
def table(program):
    """Of every option its default and its unit, which of a choice is "one | another"."""
    options, group = {}, ""
    for line in _answer(program).stdout.splitlines():
        if found := GROUP.match(line):
            group = found[1]
        elif found := OPTION.match(line):
            name = f"{group}.{found[1]}"
            if not name.startswith(LEFT_OUT):
                options[name] = found[2], found[3]
    return options


@functools.cache
def span(program, name):
    """Least and largest value, and whether it is a whole number; None of text."""
    answer = _answer(program, f"--{name}", "x")
    if found := RANGE.search(answer.stderr):
        return float(found[2]), float(found[3]), bool(found[1])
    if answer.returncode == 0:
        return None
    raise ValueError(f"{name}: no range is found in {answer.stderr!r}")


def check(program):
    """That the program says what is read here. Options that are not understood would never be drawn."""
    if not table(program):
        raise ValueError("no options are found in what --print_config prints")
    for name, (_, unit) in sorted(table(program).items()):
        if name not in FILES and " | " not in unit:
            span(program, name)


def _number(low, high, whole, default, chance, near):
    """One of the ends, else log-uniform where the range spans decades. `near`: within ten times the default."""
    if near and default != 0:
        ends = sorted([default / 10, default * 10])
        low, high = max(low, ends[0]), min(high, ends[1])
    if chance.random() < (0.05 if near else 0.2):
        value = chance.choice([low, high])
    elif low >= 0 and high > 100 * max(low, 0.1):
        least = low or min(1.0 if whole else 1e-6, high)
        value = math.exp(chance.uniform(math.log(least), math.log(high)))
    else:
        value = chance.uniform(low, high)
    return str(round(value)) if whole else repr(min(max(value, low), high))


def draw(program, chance):
    """The text of some options: of one to all of them, or of one to all of one group."""
    options = table(program)
    names = sorted(options)
    if chance.random() < 0.5:
        group = chance.choice(sorted({name.split(".")[0] for name in names}))
        names = [name for name in names if name.startswith(group + ".")]
    count = round(math.exp(chance.uniform(0, math.log(len(names)))))
    near = chance.random() < 0.6
    drawn = {}
    for name in sorted(chance.sample(names, count)):
        default, unit = options[name]
        if name in FILES:
            drawn[name] = FILES[name]
        elif " | " in unit:
            drawn[name] = chance.choice(unit.split(" | "))
        elif bounds := span(program, name):
            low, high, whole = bounds
            drawn[name] = _number(low, min(high, MOST.get(name, high)), whole, float(default), chance, near)
    if any(name.startswith("Oracle.") for name in drawn):
        drawn.pop("Image.scale", None)  # they exclude each other
    return drawn


def yaml(drawn):
    """As `--config` reads it."""
    lines, group = [], None
    for name, value in sorted(drawn.items()):
        if name.split(".")[0] != group:
            group = name.split(".")[0]
            lines.append(f"{group}:")
        lines.append(f"  {name.split('.')[1]}: {value}")
    return "\n".join(lines) + "\n"
