"""Fits from many starts on a cluster."""

from __future__ import annotations

import hashlib
import json
from contextlib import closing
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .. import _native
from ..design import DesignLike
from ..errors import MailleError
from ..fit import Fit, Targets, fit_request
from ..record import Progress, _Bar, _whole
from ._client import client_of, results

if TYPE_CHECKING:
    from collections.abc import Sequence

    import distributed


def fit(
    design: DesignLike,
    targets: Targets,
    *,
    starts: int,
    client: distributed.Client | None = None,
    free: Sequence[str] = (),
    free_each: Sequence[str] = (),
    shape: bool = False,
    min_gap: float | None = None,
    supercell: tuple[int, int] = (1, 1),
    norm: Literal["least-squares", "minimax"] = "least-squares",
    tolerance: float = 1e-6,
    designs: int = 60,
    cell: str = "1x1",
    effort: str = "low",
    seed: int = 1,
    retries: int = 2,
    progress: Progress = None,
) -> Fit:
    """The best of `starts` fits, each a task: the first begins at the given design, the others at numbers drawn between their bounds.

    A start from which no limit is found counts for nothing; if none comes to an end, the error of the first is raised. The other arguments
    are those of `maille.fit`.
    """
    count = _whole("starts", starts, 1)
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
        restarts=1,
        designs=designs,
        cell=cell,
        effort=effort,
        seed=seed,
    )
    bounds = [(number["min"], number["max"]) for number in json.loads(request)["free"]]
    random = np.random.default_rng(seed)
    drawn: list[list[float] | None] = [None]
    drawn += [[float(random.uniform(low, high)) for low, high in bounds] for _ in range(count - 1)]
    name = hashlib.sha256(request.encode()).hexdigest()[:32]
    calls: dict[str, tuple[Any, ...]] = {f"maille-fit-{name}-{k}": (request, begin) for k, begin in enumerate(drawn)}
    found: list[Fit] = []
    failures: list[MailleError] = []
    retries = _whole("retries", retries, 0)
    with _Bar(progress, "start") as told, closing(results(client_of(client), _solve, calls, retries)) as answers:
        for done, (_, value) in enumerate(answers, 1):
            if isinstance(value, MailleError):
                failures.append(value)
            else:
                found.append(Fit._of(value[0], _native.Design.from_json(value[1])))
            if told is not None:
                told(done, count)
    if not found:
        raise failures[0]
    return min(found, key=lambda one: (_cost(one, norm), one.worst_miss))


def _cost(found: Fit, norm: str) -> float:
    misses = [target["weight"] * target["miss"] for target in found.targets]
    return float(np.max(np.abs(misses)) if norm == "minimax" else np.sum(np.square(misses)))


def _solve(request: str, begin: list[float] | None) -> tuple[str, str]:
    """On a worker, with one thread."""
    text, design = _native.fit(request, begin=begin, threads=1, progress=None)
    return text, design.to_json()

