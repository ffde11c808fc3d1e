"""Single questions on a sheet: one strain as large or small as can be, the thickest wire, the widest gaps."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _native
from .design import Design, DesignLike
from .errors import ArgumentError
from .record import _sequence, _whole

__all__ = ["Extreme", "StrainLimit", "limit", "roomiest", "tightest"]

Strain = Literal["exx", "eyy", "exy"]


@dataclass(frozen=True)
class StrainLimit:
    """The end of one in-plane strain. Strains are Green strains E = (C - 1)/2, C = FᵀF; exy is the tensor shear."""

    #: `global` (certified, and the proven bound is attained), `local` (certified), `uncertified`, `l2-unreachable` (proved: no
    #: state has what is held), or `l2-not-reached` (it was not reached; nothing is proved).
    status: str
    #: The strain that was sought; None without a state.
    value: float | None
    #: Proven bound of it.
    bound: float | None
    #: (3,): exx, eyy, exy of the state.
    strain: NDArray[np.float64] | None
    #: Whether the links are those of the design.
    links_ok: bool
    #: Starts that were solved, and distinct certified values among them.
    n_starts: int
    n_distinct: int
    #: (cell, best certified value) of each cell that was solved.
    by_cell: tuple[tuple[str, float | None], ...]
    #: Poses, lattice and certificate, in the design's unit.
    state: dict[str, Any] | None


@dataclass(frozen=True)
class Extreme:
    """The thickest wire, or the widest gaps, with the state as a design. Lengths in the design's unit."""

    #: `local` where a certificate is complete, else `uncertified` or `not-converged`.
    status: str
    #: The smallest gap (`roomiest` alone).
    gap: float | None
    #: (K, 3): major radius, minor radius and aspect ratio (inner diameter / wire diameter) of each size of ring.
    sizes: NDArray[np.float64]
    links_ok: bool
    n_starts: int
    n_distinct: int
    #: Poses, lattice and certificate.
    state: dict[str, Any] | None
    #: The state as a design of its own.
    design: Design | None


def limit(
    design: DesignLike,
    *,
    maximize: Strain | None = None,
    minimize: Strain | None = None,
    fix: Mapping[Strain, float] | None = None,
    free: Sequence[Strain] = (),
    cell: str = "auto",
    minor_radius: float | None = None,
    starts: int = 8,
    seed: int = 1,
) -> StrainLimit:
    """One strain (exx, eyy or exy) as large or as small as can be: what `maille limit` does.

    Strains of `fix` are held at their values, those of `free` left to the sheet, the others held at 0.

    >>> limit("1.1", maximize="exx").status
    'global'
    """
    if (maximize is None) == (minimize is None):
        raise ArgumentError("maximize", "give one of maximize and minimize", 'as maximize="exx"')
    goal, sign = (maximize, 1.0) if maximize is not None else (minimize, -1.0)
    held = [(str(name), float(value)) for name, value in (fix or {}).items()]
    for name, value in held:
        if not np.isfinite(value):
            raise ArgumentError("fix", f"{name} = {value} is not finite", "give a strain, as 0.05")
    text = _native.limit(
        _chosen(design, minor_radius)._inner,
        str(goal),
        sign,
        fix=held,
        free=_sequence(free),
        cell=cell,
        starts=_whole("starts", starts, 1),
        seed=_whole("seed", seed, 0),
    )
    found = json.loads(text)
    strain = found.pop("strain")
    by_cell = tuple((name, value) for name, value in found.pop("by_cell"))
    return StrainLimit(strain=None if strain is None else np.array(strain), by_cell=by_cell, **found)


def tightest(
    design: DesignLike,
    *,
    lattice: Literal["free", "fixed"] = "free",
    minor_radius: float | None = None,
    starts: int = 8,
    seed: int = 1,
    threads: int | None = None,
) -> Extreme:
    """The thickest wire with which a weave exists, over all poses and, if free, the lattice: what `maille tightest` does.

    >>> tightest("1.1", starts=1).status
    'local'
    """
    return _extreme(design, True, lattice, minor_radius, starts, seed, threads)


def roomiest(
    design: DesignLike,
    *,
    lattice: Literal["free", "fixed"] = "fixed",
    minor_radius: float | None = None,
    starts: int = 8,
    seed: int = 1,
    threads: int | None = None,
) -> Extreme:
    """The state of a weave with the widest gaps, for printing in place: what `maille roomiest` does."""
    return _extreme(design, False, lattice, minor_radius, starts, seed, threads)


def _chosen(design: DesignLike, minor_radius: float | None) -> Design:
    chosen = Design.of(design)
    return chosen if minor_radius is None else chosen.with_minor_radius(minor_radius)


def _extreme(
    design: DesignLike,
    thickest: bool,
    lattice: str,
    minor_radius: float | None,
    starts: int,
    seed: int,
    threads: int | None,
) -> Extreme:
    if lattice not in ("free", "fixed"):
        raise ArgumentError("lattice", f"{lattice!r} is neither free nor fixed", 'give "free" or "fixed"')
    text, state = _native.extreme(
        _chosen(design, minor_radius)._inner,
        thickest=thickest,
        lattice_free=lattice == "free",
        starts=_whole("starts", starts, 1),
        seed=_whole("seed", seed, 0),
        threads=None if threads is None else _whole("threads", threads, 1),
    )
    found = json.loads(text)
    sizes = np.array(found.pop("sizes"), dtype=np.float64).reshape(-1, 3)
    return Extreme(sizes=sizes, design=None if state is None else Design._of(state), **found)
