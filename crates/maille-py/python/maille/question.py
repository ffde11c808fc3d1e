"""Single questions on a sheet: one strain as large or small as can be, the thickest wire, the widest gaps, the
closest cell."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _native
from .design import Design, DesignLike, chosen
from .errors import ArgumentError, MailleError
from .record import _effort, _sequence, _whole
from .sheet import Sheet, start
from .table import Columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Extreme", "StrainLimit", "limit", "roomiest", "tightest"]

Strain = Literal["exx", "eyy", "exy"]
_STRAINS: tuple[Strain, ...] = ("exx", "eyy", "exy")


@dataclass(frozen=True)
class StrainLimit(Columns):
    """The end of one in-plane strain. Strains are Green strains E = (C - 1)/2, C = FᵀF; exy is the tensor shear."""

    #: `global` (certified, and the proven bound is attained), `local` (certified), `uncertified`, `unreachable` (proved: no
    #: state has what is held), or `not-reached` (it was not reached; nothing is proved).
    status: str
    #: The strain that was sought; None without a state.
    value: float | None
    #: Proven bound of it.
    bound: float | None
    #: (3,): exx, eyy, exy of the state.
    strain: NDArray[np.float64] | None
    #: Direction of the strains' x axis, degrees counter-clockwise from the design's.
    direction_deg: float
    #: l1 of lines along a normal strain that was sought.
    l1: float | None
    #: Whether the links are those of the design.
    links_ok: bool | None
    #: Starts that were solved, and distinct certified values among them.
    n_starts: int
    n_distinct: int
    #: (cell, best certified value) of each cell that was solved.
    by_cell: tuple[tuple[str, float | None], ...]
    #: What was checked: smallest gap, residuals, multipliers, curvature.
    certificate: dict[str, Any] | None
    #: The state, as poses to draw and to show.
    state: Sheet | None

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns: one row of status, value, bound, exx, eyy, exy, l1, direction_deg, n_starts, n_distinct; NaN where
        nothing was found."""
        row: dict[str, Any] = {"status": self.status, "value": self.value, "bound": self.bound}
        strain = [None] * 3 if self.strain is None else self.strain.tolist()
        row.update(zip(_STRAINS, strain), l1=self.l1, direction_deg=self.direction_deg)
        row.update(n_starts=self.n_starts, n_distinct=self.n_distinct)
        return {name: np.array([np.nan if x is None else x]) for name, x in row.items()}

    def plot(self, *, ax: Axes | None = None, **line: Any) -> Axes:
        """Draws the state from above, and gives the axes: see `Sheet.plot`."""
        return _state(self.state).plot(ax=ax, **line)


@dataclass(frozen=True)
class Extreme(Columns):
    """The thickest wire, the widest gaps, or the closest cell, with the state as a design. Lengths in the design's unit."""

    #: `local` where a certificate is complete, else `uncertified` or `not-converged`.
    status: str
    #: The smallest gap (`roomiest` alone).
    gap: float | None
    #: The area of the closest cell as a share of the written one (`roomiest` with `min_gap` alone).
    area_share: float | None
    #: The widest gap that was found, where no cell with `min_gap` was.
    widest_gap: float | None
    #: (K, 3): major radius, minor radius and aspect ratio (inner diameter / wire diameter) of each size of ring.
    sizes: NDArray[np.float64]
    #: Whether the lattice was `free` or `fixed`.
    lattice: str
    links_ok: bool
    n_starts: int
    n_distinct: int
    #: What was checked: smallest gap, residuals, multipliers, curvature.
    certificate: dict[str, Any] | None
    #: The state as a design of its own.
    design: Design | None
    #: The state, as poses to draw and to show.
    state: Sheet | None

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns: a row for each size of ring, of status, gap, major_radius, minor_radius, aspect_ratio."""
        count = len(self.sizes)
        columns = zip(("major_radius", "minor_radius", "aspect_ratio"), self.sizes.T)
        gap = np.nan if self.gap is None else self.gap
        return {"status": np.array([self.status] * count), "gap": np.full(count, gap), **dict(columns)}

    def plot(self, *, ax: Axes | None = None, **line: Any) -> Axes:
        """Draws the state from above, and gives the axes: see `Sheet.plot`."""
        return _state(self.state).plot(ax=ax, **line)


def limit(
    design: DesignLike,
    *,
    maximize: Strain | None = None,
    minimize: Strain | None = None,
    fix: Mapping[Strain, float] | None = None,
    free: Sequence[Strain] = (),
    direction: float = 0.0,
    cell: str = "auto",
    minor_radius: float | None = None,
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
) -> StrainLimit:
    """One strain (exx, eyy or exy) as large or as small as can be: what `maille limit` does.

    Strains of `fix` are held at their values, those of `free` left to the sheet, the others held at 0. Their x axis is turned by
    `direction`, degrees counter-clockwise from that of the design. The largest exx or eyy with no shear, or with width and shear
    free, is a pull: the limit is that of `characterize`.

    >>> limit("1.1", maximize="exx").status
    'global'
    """
    if (maximize is None) == (minimize is None):
        raise ArgumentError("maximize", "give one of maximize and minimize", 'as maximize="exx"')
    sought = _strain("maximize", maximize) if maximize is not None else _strain("minimize", minimize)
    held = [(_strain("fix", name), float(value)) for name, value in (fix or {}).items()]
    for name, value in held:
        if not np.isfinite(value):
            raise ArgumentError("fix", f"{name} = {value} is not finite", "give a strain, as 0.05")
    if not np.isfinite(direction):
        raise ArgumentError("direction", f"{direction} is not finite", "give an angle in degrees")
    of = chosen(design, minor_radius)
    left = [_strain("free", name) for name in _sequence(free)]
    goal = {"component": sought, "direction_deg": float(direction), "fix": held, "free": left}
    question = {
        "goal": {"strain": goal},
        "sense": "largest" if maximize is not None else "least",
        "effort": _effort(effort),
        "starts": None if starts is None else _whole("starts", starts, 1),
        "seed": _whole("seed", seed, 0),
    }
    text, _ = _native.answer(of._inner, json.dumps(question), cell=cell, threads=1)
    found = json.loads(text)
    solved = found["poses"] is not None
    strains = found["strains"]
    return StrainLimit(
        **{name: found[name] for name in ("status", "value", "bound", "direction_deg", "l1", "certificate")},
        **{name: found[name] for name in ("links_ok", "n_starts", "n_distinct")},
        strain=np.array([strains[name]["value"] for name in _STRAINS]) if solved else None,
        by_cell=tuple((cell["cell"], cell["value"]) for cell in found["by_cell"]),
        state=Sheet(**Sheet.fields(of, found["cell"], found)) if solved else None,
    )


def tightest(
    design: DesignLike,
    *,
    lattice: Literal["free", "fixed"] = "free",
    minor_radius: float | None = None,
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    threads: int | None = None,
) -> Extreme:
    """The thickest wire with which a weave exists, over all poses and, if free, the lattice: what `maille tightest` does.

    >>> tightest("1.1").status
    'local'
    """
    return _extreme(design, _lattice("wire", lattice), minor_radius, effort, starts, seed, threads)


def roomiest(
    design: DesignLike,
    *,
    min_gap: float | None = None,
    lattice: Literal["free", "fixed"] | None = None,
    minor_radius: float | None = None,
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    threads: int | None = None,
) -> Extreme:
    """The state of a weave with the widest gaps, for printing in place: what `maille roomiest` does.

    With `min_gap`, in the design's unit, the closest cell instead: the smallest area with every gap at least that. The lattice is
    fixed if not given, and always free with `min_gap`.

    >>> round(roomiest("1.1", min_gap=0.1).gap, 6)
    0.1
    """
    if min_gap is None:
        goal = _lattice("clearance", "fixed" if lattice is None else lattice)
        return _extreme(design, goal, minor_radius, effort, starts, seed, threads)
    if lattice == "fixed":
        raise ArgumentError("lattice", "the closest cell has a lattice of its own", 'leave it out, or give "free"')
    if not np.isfinite(min_gap) or min_gap < 0:
        raise ArgumentError("min_gap", f"{min_gap} is not a gap", "give a finite length, 0 or more")
    goal = {"goal": {"area": {"min_gap": float(min_gap)}}, "sense": "least"}
    return _extreme(design, goal, minor_radius, effort, starts, seed, threads)


def _lattice(goal: str, lattice: str) -> dict[str, Any]:
    if lattice not in ("free", "fixed"):
        raise ArgumentError("lattice", f"{lattice!r} is neither free nor fixed", 'give "free" or "fixed"')
    return {"goal": {goal: {"lattice_free": lattice == "free"}}}


def _extreme(
    design: DesignLike,
    goal: dict[str, Any],
    minor_radius: float | None,
    effort: str,
    starts: int | None,
    seed: int,
    threads: int | None,
) -> Extreme:
    question = {
        **goal,
        "effort": _effort(effort),
        "starts": None if starts is None else _whole("starts", starts, 1),
        "seed": _whole("seed", seed, 0),
    }
    threads = None if threads is None else _whole("threads", threads, 1)
    of = chosen(design, minor_radius)._inner
    text, state = _native.answer(of, json.dumps(question), cell="1x1", threads=threads)
    found = json.loads(text)
    sizes = [[size["major_radius"], size["minor_radius"], size["aspect_ratio"]] for size in found["sizes"]]
    own = None if state is None else Design._of(state)
    return Extreme(
        **{name: found[name] for name in ("status", "gap", "area_share", "widest_gap", "lattice")},
        **{name: found[name] for name in ("links_ok", "n_starts", "n_distinct")},
        sizes=np.array(sizes if own is not None else [], dtype=np.float64).reshape(-1, 3),
        certificate=found["certificate"],
        design=own,
        state=None if own is None else start(own),
    )


def stretch_sensitivity(
    design: Design, direction: float, l2: float, step: float | None, cell: str, effort: str, starts: int | None, seed: int
) -> dict[str, Any]:
    """See `Design.sensitivity`."""
    for name, value in (("direction", direction), ("l2", l2), ("step", 1.0 if step is None else step)):
        if not np.isfinite(value):
            raise ArgumentError(name, f"{value} is not finite", "give a finite number")
    if step is not None and step <= 0:
        raise ArgumentError("step", f"{step} is not positive", "give a length, as 0.1")
    question = {
        "goal": {"stretch": {"direction_deg": float(direction), "l2": float(l2)}},
        "effort": _effort(effort),
        "starts": None if starts is None else _whole("starts", starts, 1),
        "seed": _whole("seed", seed, 0),
    }
    text = _native.sensitivity(design._inner, json.dumps(question), cell=cell, step=step, threads=1)
    found: dict[str, Any] = json.loads(text)
    return found


def _strain(argument: str, name: str | None) -> str:
    if name not in _STRAINS:
        raise ArgumentError(argument, f'"{name}" is no strain', "give exx, eyy or exy")
    return name


def _state(state: Sheet | None) -> Sheet:
    if state is None:
        raise MailleError("no state was found", remedy="look at status")
    return state
