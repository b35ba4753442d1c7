# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The options of the jobs, with the names of the command line."""

from __future__ import annotations

from typing import Any

from . import _pliant


class Options(dict[str, Any]):
    """Option names and their defaults. A copy with changed values can be given to the job.

    Attributes:
        help: what each option is for, a sentence by name.
        unit: its unit, or the names that it may have ("window | gated | ...").
    """

    def __init__(self, fields: list[tuple[str, Any, str, str]], text: str):
        super().__init__((name, value) for name, value, _, _ in fields)
        self.help = {name: why for name, _, _, why in fields}
        self.unit = {name: unit for name, _, unit, _ in fields}
        self._text = text

    def __str__(self) -> str:
        """The defaults as an option file of the command line (--config), with units and reasons."""
        return self._text


def options(job: str, preset: str | None = None) -> Options:
    """The options of a job with their defaults.

    job: track, simulate, calibrate, refine, join, surface, evaluate, import, export or report.

    preset: of track default or paper, of simulate clean or endoscope. `print(pliant.options("track"))` lists all of
    them with their units and what they are for.

    Raises ValueError for a job or a preset that there is not.
    """
    if preset is None:
        preset = "clean" if job == "simulate" else "default"
    return Options(*_pliant.list_options(job, preset))
