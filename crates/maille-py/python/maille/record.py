"""Maps of limits, and their records."""

from __future__ import annotations

import io
import json
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native, _polar
from ._extra import extra
from .design import Design, DesignLike, chosen
from .errors import ArgumentError
from .sheet import Sheet
from .table import Columns

if TYPE_CHECKING:
    import pyarrow
    from matplotlib.projections.polar import PolarAxes

__all__ = ["Progress", "Record", "Sensitivities", "State", "characterize", "read_record"]

#: Called with what is done and what there is to do; or True for a bar of tqdm.
Progress = Union[None, bool, Callable[[int, int], object]]
Quantity = Literal["stretch", "l1", "lambda1"]
Held = Literal["fixed", "free"]


@dataclass(frozen=True)
class _AtLimit:
    #: Direction of the pull, degrees counter-clockwise from x.
    direction_deg: float = 0.0
    #: Stretch - 1 held across it.
    l2: float = 0.0
    #: Outcome of the search, as in the column `status`.
    status: str = ""
    #: (2, 2): in-plane deformation gradient F.
    deformation_gradient: NDArray[np.float64] = field(default_factory=lambda: np.eye(2))


@dataclass(frozen=True)
class State(_AtLimit, Sheet):
    """The solved cell at a limit. Its `document` is the line of `states.jsonl`: contacts with forces, the chain of the bound,
    residual, note."""

    @classmethod
    def _of(cls, design: Design, cell: str, document: dict[str, Any]) -> State:
        return cls(
            **Sheet.fields(design, cell, document),
            direction_deg=document["direction_deg"],
            l2=document["l2"],
            status=document["status"],
            deformation_gradient=np.array(document["deformation_gradient"], dtype=np.float64),
        )


class Record(Columns):
    """Limits of a map: one row a direction and l2, and the state at each. What `maille characterize` leaves in a folder.

    `docs/record.md` says what the columns are.
    """

    _inner: _native.Record

    def __init__(self, native: _native.Record) -> None:
        self._inner = native

    def __len__(self) -> int:
        return len(self._inner)

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, self._inner.texts())

    def __repr__(self) -> str:
        return f"<maille.Record of {self.design.name!r}, {len(self)} limits>"

    @property
    def design(self) -> Design:
        """The design that was computed."""
        return Design._of(self._inner.design())

    @property
    def run(self) -> dict[str, Any]:
        """`run.json`: design, parameters, hash of both, counters."""
        out: dict[str, Any] = json.loads(self._inner.run())
        return out

    @property
    def states(self) -> list[State]:
        """The states, in the order of the rows."""
        design, cells = self.design, self.to_numpy()["cell"].tolist()
        return [State._of(design, cell, json.loads(state)) for cell, state in zip(cells, self._inner.states())]

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns, each an array of one value a row.

        Numbers are float64, NaN where nothing was earned; counts and flags are masked arrays of int64 and bool; text is
        an array of strings, empty where there is none.
        """
        out: dict[str, NDArray[Any]] = {}
        for column in self._inner.columns():
            values = column["values"]
            missing = [value is None for value in values]
            if column["type"] == "number":
                out[column["name"]] = np.array([np.nan if v is None else v for v in values], dtype=np.float64)
            elif column["type"] == "text":
                out[column["name"]] = np.array(["" if v is None else v for v in values], dtype=np.str_)
            else:
                kind = np.int64 if column["type"] == "count" else np.bool_
                out[column["name"]] = np.ma.MaskedArray([0 if v is None else v for v in values], missing, dtype=kind)
        return out

    def to_arrow(self) -> pyarrow.Table:
        """A `pyarrow.Table`: what `maille table -o FILE.parquet` holds, with units, meanings and the run's inputs as metadata."""
        from pyarrow import parquet

        table: pyarrow.Table = parquet.read_table(io.BytesIO(self._inner.parquet(False)))
        return table

    def plot(self, quantity: Quantity = "stretch", *, ax: PolarAxes | None = None, **line: Any) -> PolarAxes:
        """Draws the limits against the direction of pull, a curve for each l2, as `maille plot` does, and gives the axes.

        `quantity`: stretch (1 + l1), l1, or lambda1 (the larger eigenvalue of C, less 1). The centre is the sheet as it
        is written, or below it if a limit is. Filled markers are limits that attain their proven bound, dashed lines bounds
        that others do not; a cross marks a direction in which no limit was found. A map to 180 degrees is drawn all
        round: a pull is the same in the opposite direction.
        """
        label = {"stretch": "1 + l1", "l1": "l1", "lambda1": "lambda1 - 1"}.get(quantity)
        if label is None:
            raise ArgumentError("quantity", f"{quantity!r} is none", "give stretch, l1 or lambda1")
        if ax is None:
            with extra("plot"):
                from matplotlib import pyplot
            from matplotlib.projections import polar

            # Constrained: the legend beside the axes stays in the picture.
            made = pyplot.figure(figsize=(7.5, 5.0), layout="constrained").add_subplot(projection="polar")
            assert isinstance(made, polar.PolarAxes)
            ax = made
        _polar.draw(ax, self.to_numpy(), quantity, line)
        ax.set_rlabel_position(67.5)
        ax.set_title(f"{self.design.name}: {label}", loc="left", pad=24)
        ax.legend(loc="upper left", bbox_to_anchor=(1.1, 1.0), frameon=False)
        return ax

    def sensitivities(self) -> Sensitivities:
        """How each certified limit changes with the wire, the spacing and the parameters of the file: from the states and their
        forces, with no further solve. What `maille characterize --sensitivities` writes as `sensitivities.csv`.

        >>> slopes = characterize("1.1", [0], [0]).sensitivities().to_numpy()
        >>> slopes["number"].tolist(), slopes["derivative"].round(6).tolist()
        (['minor_radius', 'spacing'], [-1.6, -1.44])
        """
        return Sensitivities(self._inner.sensitivities())

    def save(
        self,
        folder: str | os.PathLike[str],
        *,
        quantity: Quantity = "stretch",
        overwrite: bool = False,
        sensitivities: bool = False,
    ) -> None:
        """Writes the folder that `maille characterize` writes, with its plot of `quantity`, and with `sensitivities.csv` where that
        is asked for or there already."""
        self._inner.save(os.fspath(folder), quantity, overwrite, sensitivities)


class Sensitivities(Columns):
    """Derivatives of limits: one row a limit and number. `docs/record.md` says what the columns are."""

    _COLUMNS = ("direction_deg", "l2", "number", "derivative", "derivative_back")

    def __init__(self, rows: list[tuple[float, float, str, float | None, float | None]]) -> None:
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<maille.Sensitivities, {len(self)} derivatives>"

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns, each an array of one value a row; NaN where a derivative was not found."""
        columns = {name: [row[k] for row in self._rows] for k, name in enumerate(self._COLUMNS)}
        # A missing number becomes NaN.
        return {name: np.array(c, dtype=np.str_ if name == "number" else np.float64) for name, c in columns.items()}


def _again(name: str, run: str, limits: str, states: str) -> Record:
    """A record that came from another process."""
    return Record(_native.Record.of_texts(name, run, limits, states))


def read_record(folder: str | os.PathLike[str]) -> Record:
    """Reads a record that `maille characterize`, `maille sweep` or `Record.save` has written."""
    return Record(_native.read_record(os.fspath(folder)))


def characterize(
    design: DesignLike,
    directions: str | ArrayLike | None = None,
    l2: str | ArrayLike | None = None,
    *,
    lateral: Held = "fixed",
    shear: Held = "fixed",
    compression: bool = False,
    extremes: bool | None = None,
    method: Literal["exact", "energy"] = "exact",
    cell: str = "auto",
    minor_radius: float | None = None,
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    energy: dict[str, Any] | None = None,
    quantity: Quantity = "stretch",
    out: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    sensitivities: bool = False,
    progress: Progress = None,
    threads: int | None = None,
) -> Record:
    """How far a sheet stretches in each direction before it locks: what `maille characterize` does, with its defaults.

    `directions` (degrees counter-clockwise from x) and `l2` (stretch - 1 held across) are numbers or ranges as
    `"0:180:5"`. `lateral="free"` and `shear="free"` leave width and shear to the sheet. `compression` asks how far
    the sheet is compressed instead, in all cells up to 3x3. With `extremes` the largest and the smallest l1 of each l2 are
    sought between the directions, too, as rows of their own; by default where `directions` and `compression` are left out. `energy` has options of the energy
    method, as `{"tau": 0.01}`. With `out` the record is kept in that folder while limits come in, and the same call goes on
    where an earlier one stopped; without, it stays in memory. With `sensitivities` the folder gets the derivatives of the limits,
    too: those of `Record.sensitivities`. `progress` is True for a bar of tqdm, or is called with
    (done, total). Results do not depend on `threads`. Ctrl-C stops it; what was found is in `out`.

    >>> record = characterize("1.1", directions=[0], l2=[0])
    >>> record.to_numpy()["l1"].round(9).tolist(), record.to_numpy()["status"].tolist()
    ([0.44], ['global'])
    """
    inner = chosen(design, minor_radius)._inner
    lattice = json.loads(inner.to_json())["lattice"]
    if lattice.get("single"):
        # A chain is pulled along itself, and has no width.
        along = np.degrees(np.arctan2(lattice["a1"][1], lattice["a1"][0]))
        directions = [float(along)] if directions is None else directions
        l2 = [0.0] if l2 is None and lateral == "fixed" else l2
    question = _question(
        directions,
        l2,
        lateral=lateral,
        shear=shear,
        compression=compression,
        extremes=extremes,
        method=method,
        cell=cell,
        effort=effort,
        starts=starts,
        seed=seed,
        energy=energy,
    )
    with _Bar(progress) as told:
        native = _native.characterize(
            inner,
            question,
            quantity,
            out=None if out is None else os.fspath(out),
            overwrite=overwrite,
            sensitivities=sensitivities,
            progress=told,
            threads=None if threads is None else _whole("threads", threads, 1),
        )
    return Record(native)


def _question(
    directions: str | ArrayLike | None = None,
    l2: str | ArrayLike | None = None,
    *,
    lateral: Held = "fixed",
    shear: Held = "fixed",
    compression: bool = False,
    extremes: bool | None = None,
    method: Literal["exact", "energy"] = "exact",
    cell: str = "auto",
    effort: str = "normal",
    starts: int | None = None,
    seed: int = 1,
    energy: dict[str, Any] | None = None,
) -> str:
    """What a map asks, as the native part takes it."""
    if energy is not None and method != "energy":
        raise ArgumentError("energy", "is for the energy method", 'leave it out, or give method="energy"')
    return _native.map_question(
        directions=None if directions is None else _numbers("directions", directions),
        l2=None if l2 is None else _numbers("l2", l2),
        lateral_free=_free("lateral", lateral),
        shear_free=_free("shear", shear),
        compression=compression,
        extremes=extremes,
        method=method,
        cell=cell,
        effort=_effort(effort),
        starts=None if starts is None else _whole("starts", starts, 1),
        seed=_whole("seed", seed, 0),
        energy=json.dumps(energy or {}),
    )


def _effort(effort: str) -> str:
    if not isinstance(effort, str):
        raise ArgumentError("effort", f"{effort!r} is no effort", 'give "low", "normal", "thorough", or a time, as "30s"')
    return _native.effort(effort)


def _whole(name: str, value: int, least: int) -> int:
    # Seeds have 64 bits in the program, numbers of things 32.
    most = 2**64 - 1 if name == "seed" else 2**32 - 1
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not least <= value <= most:
        raise ArgumentError(name, f"{value!r} is no whole number from {least} to {most}", f"give {max(least, 1)} or more")
    return int(value)


def _free(name: str, held: str) -> bool:
    if held not in ("fixed", "free"):
        raise ArgumentError(name, f"{held!r} is neither fixed nor free", 'give "fixed" or "free"')
    return held == "free"


def _numbers(name: str, values: str | ArrayLike) -> list[float]:
    if isinstance(values, str):
        return _native.numbers(name, text=values)
    try:
        array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        array = np.empty((0, 0))
    if array.ndim != 1:
        raise ArgumentError(name, f"{values!r} is no list of numbers", 'give numbers, or a range as "0:180:15"')
    return _native.numbers(name, values=array.tolist())


class _Bar:
    """A callback from what the user gave as progress."""

    def __init__(self, progress: Progress, unit: str = "limit") -> None:
        self._progress = progress
        self._unit = unit
        self._bar: Any = None

    def __enter__(self) -> Callable[[int, int], object] | None:
        if self._progress is True:
            try:
                from tqdm.auto import tqdm
            except ModuleNotFoundError:
                problem = 'progress=True draws a bar of tqdm, which is not installed: pip install "maille[progress]"'
                warnings.warn(f"{problem}. The work goes on without a bar.", stacklevel=3)
                return None
            self._bar = tqdm(unit=self._unit)
            return self._tell
        return self._progress if callable(self._progress) else None

    def _tell(self, done: int, total: int) -> None:
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()


def _sequence(values: Sequence[str] | str) -> list[str]:
    return [values] if isinstance(values, str) else list(values)
