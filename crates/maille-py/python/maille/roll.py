"""How tightly a sheet can be rolled, closed tubes, and sheets of given curvature."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from .design import DesignLike, chosen
from .record import Progress, _Bar, _effort, _free, _numbers, _whole
from .table import Columns

__all__ = ["Rolls", "roll"]

_WORDS = ("axis", "sought", "lateral", "shear", "cell", "status")
_NUMBERS = ("direction_deg", "wrap", "at_curvature", "curvature", "neutral_radius", "neutral_stretch", "l2", "gamma", "min_gap", "n_starts", "n_distinct", "better_chance", "wall_s")


@dataclass(frozen=True)
class Rolls(Columns):
    """States of a rolled sheet: a row for each. Lengths are in the unit of the design."""

    #: Each with its state, contacts and certificate, as `maille roll --json` prints it.
    documents: tuple[dict[str, Any], ...]

    def __len__(self) -> int:
        return len(self.documents)

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns of `rolls.csv` but for the figures of the certificate; numbers that are not known are nan."""
        words = {name: np.array([roll.get(name, "tightest") for roll in self.documents], dtype=np.str_) for name in _WORDS}
        numbers = {
            name: np.array([np.nan if roll.get(name) is None else roll[name] for roll in self.documents], dtype=np.float64)
            for name in _NUMBERS
        }
        return {**numbers, **words}


def roll(
    design: DesignLike,
    *,
    directions: str | ArrayLike | None = None,
    axis: str = "both",
    wrap: Sequence[int] = (),
    curvature: Sequence[float] = (),
    lateral: str = "fixed",
    shear: str = "fixed",
    l2: float = 0.0,
    gamma: float = 0.0,
    cell: str = "1x1",
    effort: str = "low",
    minor_radius: float | None = None,
    seed: int = 1,
    progress: Progress = None,
    threads: int | None = None,
) -> Rolls:
    """How tightly a sheet can be rolled along each direction: what `maille roll` finds.

    `axis` is `below` the sheet, `above` it, or `both`; width along it and shear are `fixed`, at `l2` and `gamma`, or `free`. With `wrap`,
    numbers of cells that go once round, closed tubes in place of it: the widest gaps, and the least and largest radius and length of
    each. With `curvature`, in 1/unit, the same of a sheet that is bent so far.
    """
    with _Bar(progress, unit="roll") as told:
        found = _native.rolls(
            chosen(design, minor_radius)._inner,
            directions=None if directions is None else _numbers("directions", directions),
            axis=axis,
            wrap=[_whole("wrap", cells, 2) for cells in wrap],
            curvature=[float(given) for given in curvature],
            width_free=_free("lateral", lateral),
            shear_free=_free("shear", shear),
            l2=float(l2),
            gamma=float(gamma),
            cell=cell,
            effort=_effort(effort),
            seed=_whole("seed", seed, 0),
            progress=told,
            threads=None if threads is None else _whole("threads", threads, 1),
        )
    return Rolls(tuple(json.loads(roll) for roll in found))
