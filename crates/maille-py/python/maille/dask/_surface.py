"""Surfaces of attainable strains on a cluster: the rays of a pass as tasks."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import pyarrow
from pyarrow import parquet

from .. import _native
from .._files import write_whole
from ..boundary import Boundary, _search, _surface
from ..design import Design
from ..errors import ChainError, MailleError, RecordError
from ..record import Progress, _Bar, _whole
from ._client import client_of, results
from ._names import Designs, named
from ._results import Failure

if TYPE_CHECKING:
    import distributed

#: The folder of the vertices as Parquet.
RAYS = "rays"
#: Tasks for each thread of the workers in a pass, and rays in a task at most.
TASKS, MOST = 4, 32


@dataclass(frozen=True)
class Surfaces:
    """The surfaces of a run by name, and what could not be computed."""

    out: Path
    surfaces: dict[str, Boundary]
    failures: tuple[Failure, ...]
    #: Rays that this run has solved.
    solved: int


def boundary(
    designs: Designs,
    *,
    out: str | os.PathLike[str],
    client: distributed.Client | None = None,
    tolerance: float = 3e-3,
    vertices: int = 5000,
    cell: str = "1x1",
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    overwrite: bool = False,
    retries: int = 2,
    progress: Progress = None,
) -> Surfaces:
    """The surface of each design, as `maille.boundary` finds it, one after the other; the rays of a pass are shared among the workers.

    `out/NAME/boundary.jsonl` is the journal of `maille boundary`, which no other run may write to meanwhile, kept while rays come in: the same call goes on from there, and so
    does `maille boundary DESIGN --out out/NAME`, which writes meshes and a figure. `out/rays/record=NAME/` has the
    vertices as Parquet. `designs`, `client`, `retries` and failures are as in `characterize`, the rest as in `maille.boundary`.
    """
    client = client_of(client)
    search = _search(tolerance, vertices, effort, starts, cell, seed)
    retries = _whole("retries", retries, 0)
    surfaces: dict[str, Boundary] = {}
    failures: list[Failure] = []
    counted = _Counted()
    with _Bar(progress) as told:
        counted.told = told or (lambda done, total: None)
        for name, design in named(designs).items():
            try:
                if isinstance(design, MailleError):
                    raise design
                design.check()
                folder, known = _native.SurfaceFolder.open(design._inner, search, Path(out) / name, overwrite)
                with closing(folder):
                    ask = _Ask(client, design, search, retries, folder, counted)
                    found = _native.boundary_by(design._inner, search, known, ask.solve)
                _write_rays(Path(out) / RAYS / f"record={name}", found[0])
                surfaces[name] = _surface(*found)
            except RecordError:
                raise
            except MailleError as error:
                failures.append(Failure(name, None, error))
    return Surfaces(Path(out), surfaces, tuple(failures), counted.done)


class _Counted:
    done = 0
    total = 0

    def __init__(self) -> None:
        self.told: Callable[[int, int], object] = lambda done, total: None

    def more(self, done: int, total: int) -> None:
        self.done += done
        self.total += total
        self.told(self.done, self.total)


@dataclass
class _Ask:
    """Has rays solved by the workers."""

    client: Any
    design: Design
    search: str
    retries: int
    folder: _native.SurfaceFolder
    counted: _Counted

    def solve(self, rays: list[str], new: bool) -> list[str]:
        """The ends of the rays, in order; new ones are in the journal when they come in."""
        self.counted.more(0, len(rays))
        threads = max(sum(self.client.nthreads().values()), 1)
        size = min(max(len(rays) // (TASKS * threads), 1), MOST)
        first = range(0, len(rays), size)
        calls: dict[str, tuple[Any, ...]] = {}
        for k in first:
            part = rays[k : k + size]
            inputs = "".join([self.design.to_toml(), self.search, str(k), *part])
            question = (self.design, part, self.search, _native.__VERSION__)
            calls[f"maille-{sha256(inputs.encode()).hexdigest()[:32]}"] = question
        ends: dict[str, list[str]] = {}
        with closing(results(self.client, solve, calls, self.retries)) as found:
            for key, value in found:
                if isinstance(value, MailleError):
                    raise value
                ends[key] = value
                if new:
                    self.folder.keep(value)
                self.counted.more(len(value), 0)
        return [end for key in calls for end in ends[key]]


def solve(design: Design, rays: list[str], search: str, version: str) -> Union[list[str], MailleError]:
    """What a worker does: the ends of rays."""
    if version != _native.__VERSION__:
        return ChainError(f"the worker has maille {_native.__VERSION__}, not {version}")
    try:
        return _native.solve_rays(design._inner, rays, search)
    except MailleError as error:
        return error


def _write_rays(folder: Path, vertices: list[str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    out = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_pylist([json.loads(vertex) for vertex in vertices]), out)
    write_whole(folder / "rays.parquet", out.getvalue())
