"""Many maps on a cluster: which chains are left, and where each goes when it is solved."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import ArrayLike

from .. import _native
from .._files import PREFIX, write_whole
from ..design import Design
from ..errors import MailleError, OtherInputsError, RecordError
from ..record import Held, Progress, Quantity, Record, _Bar, _question, _whole
from ._chains import Solved, read_limits, solve
from ._client import client_of, results
from ._names import Designs, named
from ._results import CHAINS, RECORDS, TABLE, Failure, Results

if TYPE_CHECKING:
    import distributed


@dataclass(frozen=True)
class Keep:
    """What is kept of each map beside its limits."""

    #: What the plot shows.
    quantity: Quantity
    #: Whether records of other inputs are replaced.
    overwrite: bool
    #: Whether the derivatives of the limits are written.
    sensitivities: bool


def characterize(
    designs: Designs,
    directions: str | ArrayLike | None = None,
    l2: str | ArrayLike | None = None,
    *,
    out: str | os.PathLike[str],
    client: distributed.Client | None = None,
    lateral: Held = "fixed",
    shear: Held = "fixed",
    method: Literal["exact", "energy"] = "exact",
    cell: str = "auto",
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    energy: dict[str, Any] | None = None,
    quantity: Quantity = "stretch",
    overwrite: bool = False,
    sensitivities: bool = False,
    retries: int = 2,
    progress: Progress = None,
) -> Results:
    """The map of each design, as `maille.characterize` finds it, with the limits along each direction as one task;
    directions that the symmetries of the design make images of each other are one task together.

    `designs` is a list, or names with designs; designs of one name in a list get their minor radius behind it. Limits are
    kept in the folder `out` as they come in, and the same call goes on where an earlier one stopped. A chain whose worker is
    lost is solved again by another one; one that raises is tried `retries` times more. What cannot be used is in `.failures`,
    and stops nothing else. `client` is by default the current one of `dask.distributed`. `overwrite` replaces
    records of other inputs; chains that are part of both stay. With `sensitivities` each record has the derivatives of its limits. Extremes between
    the directions are not sought. The other arguments are those of `maille.characterize`.
    """
    question = _question(
        directions,
        l2,
        lateral=lateral,
        shear=shear,
        extremes=False,
        method=method,
        cell=cell,
        effort=effort,
        starts=starts,
        seed=seed,
        energy=energy,
    )
    asked = {name: (design, question) for name, design in named(designs).items()}
    keep = Keep(quantity, overwrite, sensitivities)
    return run(asked, out, client, keep, retries=retries, progress=progress)


def run(
    asked: Mapping[str, tuple[Design | MailleError, str]],
    out: str | os.PathLike[str],
    client: distributed.Client | None,
    keep: Keep,
    *,
    retries: int,
    progress: Progress,
) -> Results:
    """The map of each design, with what is asked of it; an error in place of a design is listed at the end."""
    client = client_of(client)
    retries = _whole("retries", retries, 0)
    folder = Path(out)
    if not (folder / CHAINS).is_dir():
        _native.check_records_folder(folder)
    maps: dict[str, _Map] = {}
    failures: list[Failure] = []
    for name, (design, question) in asked.items():
        try:
            if isinstance(design, MailleError):
                raise design
            maps[name] = _Map.open(folder, name, design, question, keep)
        except RecordError:
            # No other run gets a folder as long as a map has it open, and the traceback keeps the maps.
            for map in maps.values():
                map.native.close()
            raise
        except MailleError as error:
            failures.append(Failure(name, None, error))
    done, solved = 0, 0
    total = sum(chain.left for map in maps.values() for chain in map.left.values())
    with _Bar(progress) as told:
        tell: Callable[[int, int], object] = told or (lambda done, total: None)
        tell(done, total)
        # Under two names a design has the same chains.
        tasks: dict[str, list[tuple[_Map, _Chain]]] = {}
        calls: dict[str, tuple[Any, ...]] = {}
        for map in maps.values():
            for chain in map.left.values():
                key = f"maille-{chain.hash[:32]}"
                tasks.setdefault(key, []).append((map, chain))
                calls[key] = (map.design, asked[map.name][1], chain.directions_deg, _native.__VERSION__)
        try:
            with closing(results(client, solve, calls, retries)) as found:
                for key, value in found:
                    solved += isinstance(value, Solved)
                    for map, chain in tasks[key]:
                        if isinstance(value, Solved):
                            map.take(chain, value)
                        else:
                            failures.append(Failure(map.name, chain.directions_deg[0], value))
                            map.give_up(chain)
                        done += chain.left
                        tell(done, total)
        finally:
            # After Ctrl-C, too: what was found is written.
            records = {map.name: map.finish() for map in maps.values()}
            if records:
                names = [str(folder / RECORDS / name) for name in records]
                table = _native.joint_csv(names, [record._inner for record in records.values()])
                write_whole(folder / TABLE, table.encode())
    chains = sum(map.chains for map in maps.values())
    return Results(folder, records, tuple(failures), chains, solved)


@dataclass(frozen=True)
class _Chain:
    #: Images of each other under the symmetries of the design.
    directions_deg: list[float]
    #: Limits of it that are not in the record.
    left: int
    hash: str
    file: Path


@dataclass
class _Map:
    name: str
    design: Design
    native: _native.OpenMap
    #: All chains, and those that are not solved yet, by hash.
    chains: int
    left: dict[str, _Chain] = field(default_factory=dict[str, "_Chain"])
    record: Record | None = None

    @classmethod
    def open(cls, out: Path, name: str, design: Design, question: str, keep: Keep) -> _Map:
        """Brings the record and the chains' files to the same state: what one of them has, the other gets."""
        folder = out / CHAINS / f"record={name}"
        record = os.fspath(out / RECORDS / name)
        native = _native.OpenMap(design._inner, question, keep.quantity, record, keep.overwrite, keep.sensitivities)
        chains = [
            _Chain(directions, left, hash, folder / f"{directions[0]:g}-{hash[:32]}.parquet")
            for directions, left, hash in native.chains()
        ]
        map = cls(name, design, native, len(chains))
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _clear(folder, {chain.file.name for chain in chains}, keep.overwrite)
            for chain in chains:
                if chain.left > 0:
                    found = read_limits(chain.file)
                    if found is None or native.keep(str(chain.file), found) < chain.left:
                        map.left[chain.hash] = chain
                elif not chain.file.exists():
                    # The program has solved it.
                    write_whole(chain.file, native.chain(chain.directions_deg).parquet(True))
        except BaseException:
            native.close()
            raise
        return map

    def take(self, chain: _Chain, found: Solved) -> None:
        """Keeps a chain."""
        write_whole(chain.file, found.file)
        self.native.keep(str(chain.file), found.limits)
        self.give_up(chain)

    def give_up(self, chain: _Chain) -> None:
        """A chain for which nothing is waited any more; after the last the record is written."""
        del self.left[chain.hash]
        if not self.left:
            self.finish()

    def finish(self) -> Record:
        if self.record is None:
            self.record = Record(self.native.finish())
        return self.record


def _clear(folder: Path, known: set[str], overwrite: bool) -> None:
    """Removes what a killed run left half written, and chains of other inputs if they may be replaced."""
    for file in folder.iterdir():
        if file.name.startswith(PREFIX):
            file.unlink()
        elif file.suffix == ".parquet" and file.name not in known:
            if not overwrite:
                difference = f"{file.name} is not of this map"
                raise OtherInputsError(f"{folder} holds chains of other inputs: {difference}", folder, difference)
            file.unlink()
