"""Finite sheets: held at edges, pulled, under weight."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._extra import extra
from .design import Design, DesignLike, chosen
from .errors import ArgumentError, NotARecordError, ShapeError
from .record import Progress, _Bar, _sequence, _whole
from .sheet import Sheet
from .table import Columns

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Simulation", "read_simulation", "simulate"]

_FILE = "simulation.json"


@dataclass(frozen=True)
class Simulation(Columns):
    """What became of a finite sheet: F frames, each at rest, of M elements. Lengths in the design's unit."""

    #: `reached` (the pull was done, or the sheet is at rest), `locked`, or `not-converged`.
    end: str
    #: Largest share of the pull that was reached.
    share: float
    #: Smallest gap there; negative where tori overlap; None where no rings are near each other.
    smallest_gap: float | None
    #: Whether the links are those of the start.
    links_ok: bool
    #: Newton iterations, random kicks, and steps against a drag without a balance of forces.
    iterations: int
    kicks: int
    unbalanced: int
    #: What happened, where `end` does not say it.
    note: str | None
    #: The design, and its cells along a1 and a2.
    design: Design
    tile: str
    #: Names of the elements, as `flat@0,1`.
    elements: tuple[str, ...]
    #: (F,): share of the pull in each frame.
    frame_share: NDArray[np.float64]
    #: (F,): energy of each frame, in beta R^2.
    energy: NDArray[np.float64]
    #: (F, M, 3): positions of the elements' reference points.
    position: NDArray[np.float64]
    #: (F, M, 4): unit quaternions (w, x, y, z) that turn them from the design's pose.
    rotation: NDArray[np.float64]
    #: The columns of `forces.csv`, of F rows, NaN where a cell is empty: `stretch`, `mean_force`, `f_xx`, `force_left_x` and so
    #: on, as docs/record.md has them. None where a folder has no such table.
    forces: dict[str, NDArray[np.float64]] | None = field(repr=False)
    #: `simulation.json` and the lines of `frames.jsonl`.
    document: dict[str, Any] = field(repr=False)
    frames: tuple[dict[str, Any], ...] = field(repr=False)
    _forces_csv: str | None = field(repr=False, compare=False)

    @classmethod
    def _of(cls, text: str, lines: str, forces: str | None) -> Simulation:
        document: dict[str, Any] = json.loads(text)
        frames: tuple[dict[str, Any], ...] = tuple(json.loads(line) for line in lines.splitlines())
        poses = [frame["poses"] for frame in frames]
        return cls(
            **document["outcome"],
            design=Design._of(_native.Design.from_json(json.dumps(document["design"]))),
            tile=document["tile"],
            elements=tuple(pose["element"] for pose in poses[0]),
            frame_share=np.array([frame["share"] for frame in frames], dtype=np.float64),
            energy=np.array([frame["energy"] for frame in frames], dtype=np.float64),
            position=np.array([[pose["position"] for pose in frame] for frame in poses], dtype=np.float64),
            rotation=np.array([[pose["rotation"] for pose in frame] for frame in poses], dtype=np.float64),
            forces=None if forces is None else _columns(forces),
            document=document,
            frames=frames,
            _forces_csv=forces,
        )

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns: a row for each element in each frame, of frame, share, energy, element, position x, y, z and rotation
        w, i, j, k."""
        count, of = len(self.frames), len(self.elements)
        out: dict[str, NDArray[Any]] = {
            "frame": np.repeat(np.arange(count), of),
            "share": np.repeat(self.frame_share, of),
            "energy": np.repeat(self.energy, of),
            "element": np.tile(np.array(self.elements, dtype=np.str_), count),
        }
        out.update(zip("xyz", self.position.reshape(-1, 3).T))
        out.update(zip(("qw", "qi", "qj", "qk"), self.rotation.reshape(-1, 4).T))
        return out

    def plot(self, *, ax: Axes | None = None, **line: Any) -> Axes:
        """Draws the energy against the share of the pull, and gives the axes."""
        if ax is None:
            with extra("plot"):
                from matplotlib import pyplot

            ax = pyplot.figure(layout="constrained").add_subplot()
        ax.plot(self.frame_share, self.energy, **{"marker": "o", **line})
        ax.set_xlabel("share of the pull")
        ax.set_ylabel("energy [beta R^2]")
        ax.set_title(f"{self.design.name}, {self.tile} cells: {self.end}")
        return ax

    def plot_force(self, *, ax: Axes | None = None, **line: Any) -> Axes:
        """Draws the mean force along the pull on a pulled element against the stretch, and gives the axes."""
        if self.forces is None or not np.isfinite(self.forces["stretch"]).any():
            raise ArgumentError("plot_force", "no frame has a stretch along a pull", "hold an edge and pull the one opposite to it")
        if ax is None:
            with extra("plot"):
                from matplotlib import pyplot

            ax = pyplot.figure(layout="constrained").add_subplot()
        ax.plot(self.forces["stretch"], self.forces["mean_force"], **{"marker": "o", **line})
        ax.set_xlabel("stretch between the pulled place and the opposite one")
        ax.set_ylabel("mean force on a pulled element [beta R/1000]")
        ax.set_title(f"{self.design.name}, {self.tile} cells: {self.end}")
        return ax

    def sheet(self, frame: int = -1) -> Sheet:
        """The sheet in a frame, as poses to draw and to show."""
        columns, rows = (int(n) for n in self.tile.split("x"))
        a1 = [columns * x for x in self.design.a1]
        a2 = [rows * x for x in self.design.a2]
        document = {**self.frames[frame], "a1": a1, "a2": a2}
        return Sheet(**Sheet.fields(self.design, self.tile, document), finite=True)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the folder that `maille simulate` writes; `maille render --from FOLDER` draws it."""
        lines = "".join(json.dumps(frame, ensure_ascii=False) + "\n" for frame in self.frames)
        _native.save_simulation(Path(folder), json.dumps(self.document, ensure_ascii=False) + "\n", lines, self._forces_csv)


def read_simulation(folder: str | os.PathLike[str]) -> Simulation:
    """Reads what `maille simulate` or `Simulation.save` has written."""
    if not (Path(folder) / _FILE).is_file():
        found = ", ".join(sorted(p.name for p in Path(folder).glob("*"))[:3]) or "nothing"
        raise NotARecordError(f"{folder} holds no simulation", Path(folder), found)
    return Simulation._of(*_native.open_simulation(Path(folder)))


def simulate(
    design: DesignLike,
    tile: tuple[int, int] = (4, 4),
    *,
    fix: str | Sequence[str] = (),
    pull: Mapping[str, ArrayLike] | None = None,
    gravity: ArrayLike | None = None,
    force: Mapping[str, ArrayLike] | None = None,
    floor: float | None = None,
    bend: Sequence[float] | None = None,
    drag: float | None = None,
    steps: int = 10,
    minor_radius: float | None = None,
    alpha: float | None = None,
    tau: float | None = None,
    max_iterations: int = 2000,
    seed: int = 1,
    out: str | os.PathLike[str] | None = None,
    progress: Progress = None,
) -> Simulation:
    """A finite sheet of `tile` cells, held at edges, pulled in steps, under weight: what `maille simulate` does.

    Places are `left`, `right`, `top`, `bottom`, an element (`flat`), or its copy in one cell (`flat@0,2`). `pull` moves places by a
    vector (3,), or along several (N, 3), all from the start, in the design's unit. `gravity` is the weight of every element, `force`
    acts on places; 1 is a thousandth of the stiffness of a pull at R. `floor` is a height, `bend` the curvatures along x and y of a surface onto
    which the sheet is bent, `drag` slows the sheet. With `out` the
    folder of `maille simulate` is written.

    >>> sheet = simulate("1.1", (2, 2), fix="left", pull={"right": (0.2, 0, 0)}, steps=1)
    >>> sheet.end, sheet.position.shape
    ('reached', (2, 12, 3))
    """
    pulls = [{"place": place, "way": _vectors("pull", way)} for place, way in (pull or {}).items()]
    forces = [{"place": place, "force": _vector("force", at)} for place, at in (force or {}).items()]
    plan = {
        "fix": _sequence(fix),
        "pull": pulls,
        "gravity": None if gravity is None else _vector("gravity", gravity),
        "force": forces,
        "floor": None if floor is None else _number("floor", floor),
        **({} if bend is None else {"bend": _pair("bend", bend)}),
        "drag": None if drag is None else _positive("drag", drag),
        "steps": _whole("steps", steps, 1),
        "max_iterations": _whole("max_iterations", max_iterations, 1),
        "seed": _whole("seed", seed, 0),
    }
    plan.update({name: _positive(name, x) for name, x in (("alpha", alpha), ("tau", tau)) if x is not None})
    columns, rows = _cells(tile)
    if out is not None:
        _native.check_simulation_folder(Path(out))
    with _Bar(progress, unit="step") as told:
        found = _native.simulate(chosen(design, minor_radius)._inner, (columns, rows), json.dumps(plan), told)
    simulation = Simulation._of(*found)
    if out is not None:
        simulation.save(out)
    return simulation


def _cells(tile: tuple[int, int]) -> tuple[int, int]:
    try:
        columns, rows = tile
    except (TypeError, ValueError):
        raise ArgumentError("tile", f"{tile!r} is no pair of numbers", "give the cells along a1 and a2, as (4, 4)") from None
    return _whole("tile", columns, 1), _whole("tile", rows, 1)


def _columns(text: str) -> dict[str, NDArray[np.float64]]:
    header, *rows = csv.reader(io.StringIO(text, newline=""))
    of = [[float(cell) if cell else np.nan for cell in row] for row in rows]
    return dict(zip(header, np.array(of, dtype=np.float64).reshape(len(rows), len(header)).T))


def _number(name: str, value: float) -> float:
    if not np.isfinite(value):
        raise ArgumentError(name, f"{value!r} is not finite", "give a number")
    return float(value)


def _positive(name: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0):
        raise ArgumentError(name, f"{value!r} is not positive", "give a positive number")
    return float(value)


def _pair(name: str, values: Sequence[float]) -> list[float]:
    found = [_number(name, value) for value in values]
    if len(found) != 2:
        raise ShapeError(name, f"has {len(found)} numbers", "give two curvatures, as (0.02, -0.02)", value=(len(found),))
    return found


def _vectors(name: str, values: ArrayLike) -> list[list[float]]:
    array = np.atleast_2d(np.asarray(values, dtype=np.float64))
    if array.ndim != 2 or array.shape[1] != 3 or array.shape[0] == 0:
        raise ShapeError(name, f"has the shape {np.shape(values)}", "give (3,) or (N, 3)", value=np.shape(values))
    if not np.all(np.isfinite(array)):
        raise ArgumentError(name, f"{values!r} is not finite", "give finite numbers")
    rows: list[list[float]] = array.tolist()
    return rows


def _vector(name: str, values: ArrayLike) -> list[float]:
    rows = _vectors(name, values)
    if len(rows) != 1:
        raise ShapeError(name, f"has {len(rows)} vectors", "give one, (3,)", value=np.shape(values))
    return rows[0]
