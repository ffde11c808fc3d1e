"""Designs for wanted limits: what `maille fit` does."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from .design import Design, DesignLike
from .errors import ArgumentError
from .record import Progress, _Bar, _effort, _whole

#: What is wanted: a CSV file, l1 by direction in degrees, or rows of direction and l1.
Targets = Union["os.PathLike[str]", str, Mapping[float, float], ArrayLike]


@dataclass(frozen=True)
class Fit:
    """A design whose limits are the wanted ones, as nearly as was found."""

    #: `reached`, or `missed`: then `targets` says by how much, and what holds the sheet.
    ended: Literal["reached", "missed", "interrupted"]
    #: The design. Its limits are those of `targets`.
    design: Design
    #: Its free numbers by their places.
    numbers: dict[str, float]
    #: The largest miss of a target: of l1, of a Poisson ratio, or of a gap in reference radii.
    worst_miss: float
    #: One for each target: `measure`, `wanted`, `before`, `after`, `miss`, `bound`, `family_bound`, `forbidden`, `held_by`; see docs/json.md.
    targets: list[dict[str, Any]]
    #: With `shape`, the limits are this times the wanted ones.
    shape_factor: float | None
    #: Designs that were solved.
    designs: int

    @classmethod
    def _of(cls, text: str, design: _native.Design) -> Fit:
        found = json.loads(text)
        return cls(
            ended=found["ended"],
            design=Design._of(design),
            numbers={row["number"]: row["after"] for row in found["numbers"]},
            worst_miss=found["worst_miss"],
            targets=found["targets"],
            shape_factor=found["shape_factor"],
            designs=found["designs"],
        )


def fit(
    design: DesignLike,
    targets: Targets,
    *,
    free: Sequence[str] = (),
    free_each: Sequence[str] = (),
    shape: bool = False,
    min_gap: float | None = None,
    supercell: tuple[int, int] = (1, 1),
    norm: Literal["least-squares", "minimax"] = "least-squares",
    tolerance: float = 1e-6,
    restarts: int = 8,
    designs: int = 60,
    cell: str = "1x1",
    effort: str = "low",
    seed: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Fit:
    """A design whose limits are those of `targets`, as nearly as can be found: what `maille fit` does.

    `targets` is a CSV file as `maille fit --help` has it, with Poisson ratios, too, or l1 by direction: `{0: 0.45, 90: 0.3}` or rows of both. `free` names
    numbers that may move with their bounds, as `"minor_radius=0.05:0.15"` or `"spacing=10%"`; `free_each` those with a number of its own
    for each element, as `"elements.*.rings.major_radius=30%"`; without both, the parameters of the file that have bounds. `min_gap` is
    in the design's unit. The other arguments are the options of the command.

    >>> found = fit("1.1", {0: 0.5}, free=["minor_radius=0.05:0.2"])
    >>> found.ended, round(found.numbers["minor_radius"], 6)
    ('reached', 0.0625)
    """
    request = fit_request(
        design,
        targets,
        free=free,
        free_each=free_each,
        shape=shape,
        min_gap=min_gap,
        supercell=supercell,
        norm=norm,
        tolerance=tolerance,
        restarts=restarts,
        designs=designs,
        cell=cell,
        effort=effort,
        seed=seed,
    )
    threads = None if threads is None else _whole("threads", threads, 1)
    with _Bar(progress, "design") as told:
        return Fit._of(*_native.fit(request, begin=None, threads=threads, progress=told))


def fit_request(
    design: DesignLike,
    targets: Targets,
    *,
    free: Sequence[str],
    free_each: Sequence[str],
    shape: bool,
    min_gap: float | None,
    supercell: tuple[int, int],
    norm: str,
    tolerance: float,
    restarts: int,
    designs: int,
    cell: str,
    effort: str,
    seed: int,
) -> str:
    """What is asked, as JSON that the native part reads."""
    if norm not in ("least-squares", "minimax"):
        raise ArgumentError("norm", f"{norm!r} is no norm", 'give "least-squares" or "minimax"')
    name, text = _targets(targets)
    options = {
        "norm": norm,
        "starts": _whole("restarts", restarts, 1),
        "seed": _whole("seed", seed, 0),
        "tolerance": float(tolerance),
        "designs": _whole("designs", designs, 1),
        "cells": "auto",
        "effort": _effort(effort),
    }
    n, m = supercell
    return _native.fit_request(
        Design.of(design)._inner,
        name,
        text,
        shape=shape,
        free=list(free),
        free_each=list(free_each),
        min_gap=None if min_gap is None else float(min_gap),
        supercell=(_whole("supercell", n, 1), _whole("supercell", m, 1)),
        cell=cell,
        options=json.dumps(options),
    )


def _targets(targets: Targets) -> tuple[str, str]:
    """A name and the text of a CSV file."""
    if isinstance(targets, (str, os.PathLike)):
        file = Path(targets)
        try:
            return str(file), file.read_text(encoding="utf-8")
        except FileNotFoundError:
            help = "give a CSV file with the columns direction_deg and l1, or l1 by direction"
            raise ArgumentError("targets", f"there is no file {file}", help) from None
    rows = list(targets.items()) if isinstance(targets, Mapping) else targets
    try:
        table = np.asarray(rows, dtype=np.float64).reshape(-1, 2)
    except (TypeError, ValueError):
        help = "give {0: 0.45, 90: 0.3}, rows of direction and l1, or the path of a CSV file"
        raise ArgumentError("targets", "they are neither a mapping nor rows of two numbers", help) from None
    lines = [f"{direction!r},{l1!r}\n" for direction, l1 in table.tolist()]
    return "targets", "direction_deg,l1\n" + "".join(lines)
