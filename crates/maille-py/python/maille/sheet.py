"""A sheet in one state: poses as arrays, drawn, and shown in three dimensions."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._extra import extra
from ._files import write_whole
from .design import Design, DesignLike
from .errors import ArgumentError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Sheet", "View", "show"]

#: Okabe and Ito's colours: apart for colour-blind eyes.
_COLORS = (0x0072B2, 0xE69F00, 0x009E73, 0xCC79A7, 0x56B4E9, 0xD55E00, 0xF0E442, 0x999999)


@dataclass(frozen=True)
class Sheet:
    """A design in one state. Lengths in the design's unit."""

    #: The design.
    design: Design
    #: The cell that the poses are of, as `1x1`; of a finite sheet all of it.
    cell: str
    #: (2, 3): the lattice vectors of that cell.
    lattice: NDArray[np.float64]
    #: Names of the M elements, as `flat` or `flat@1,0`.
    elements: tuple[str, ...]
    #: (M, 3): positions of their reference points.
    position: NDArray[np.float64]
    #: (M, 4): unit quaternions (w, x, y, z) that turn them from the design's pose.
    rotation: NDArray[np.float64]
    #: What the record holds of it: poses, and perhaps contacts with forces, the chain of the bound, a certificate.
    document: dict[str, Any] = field(repr=False)
    #: Whether the sheet ends where the cell does.
    finite: bool = False

    def plot(self, *, tile: tuple[int, int] = (2, 2), ax: Axes | None = None, **line: Any) -> Axes:
        """Draws the core circles of all rings from above, and gives the axes. `tile`: cells along a1 and a2."""
        if ax is None:
            with extra("plot"):
                from matplotlib import pyplot

            ax = pyplot.figure(layout="constrained").add_subplot()
        circles = self.circles()
        shifts = [(0, 0)] if self.finite else [(i, j) for i in range(tile[0]) for j in range(tile[1])]
        for kind, circle in circles:
            color = f"#{_COLORS[kind % len(_COLORS)]:06x}"
            for i, j in shifts:
                x, y, _ = (circle + i * self.lattice[0] + j * self.lattice[1]).T
                ax.plot(x, y, **{"color": color, "linewidth": 1.5, **line})
        ax.set_aspect("equal")
        unit = "" if self.design.unit is None else f" [{self.design.unit}]"
        ax.set_xlabel(f"x{unit}")
        ax.set_ylabel(f"y{unit}")
        ax.set_title(self.design.name)
        return ax

    def circles(self, points: int = 73) -> list[tuple[int, NDArray[np.float64]]]:
        """Core circles of the cell: (kind, (points, 3)), the kind being the element's place in the design; closed."""
        kinds = {element.name: k for k, element in enumerate(self.design.elements)}
        angle = np.linspace(0.0, 2.0 * np.pi, points)[:, None]
        out: list[tuple[int, NDArray[np.float64]]] = []
        for name, position, rotation in zip(self.elements, self.position, self.rotation):
            kind = kinds[name] if name in kinds else kinds[name.rsplit("@", 1)[0]]
            for ring in self.design.elements[kind].rings:
                normal = np.asarray(ring.normal, dtype=np.float64) / np.linalg.norm(ring.normal)
                side = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
                side /= np.linalg.norm(side)
                circle = np.cos(angle) * side + np.sin(angle) * np.cross(normal, side)
                circle = np.asarray(ring.offset, dtype=np.float64) + ring.major_radius * circle
                out.append((kind, position + _turned(rotation, circle)))
        return out

    def show(
        self,
        *,
        tile: tuple[int, int] = (4, 4),
        size: tuple[int, int] = (800, 600),
        view: str = "tilted",
        color: Literal["element", "load"] = "element",
        interactive: bool | None = None,
    ) -> View:
        """The sheet in three dimensions, in a notebook: see `maille.show`."""
        columns, rows = (_count("tile", n) for n in tile)
        width, height = (_count("size", n) for n in size)
        native = _native.Sheet(self.design._inner, self.cell, self.finite, json.dumps(self._document()))
        if interactive is None:
            interactive = _has_widget()
        png = native.picture((columns, rows), (width, height), view, color)
        return View(png, native if interactive else None, (columns, rows))

    def _document(self) -> dict[str, Any]:
        poses = [
            {"element": name, "position": position, "rotation": rotation}
            for name, position, rotation in zip(self.elements, self.position.tolist(), self.rotation.tolist())
        ]
        a1, a2 = self.lattice.tolist()
        return {"a1": a1, "a2": a2, "poses": poses, "contacts": self.document.get("contacts") or []}

    @staticmethod
    def fields(design: Design, cell: str, document: dict[str, Any]) -> dict[str, Any]:
        """The fields of a sheet from a document with `poses`, `a1` and `a2`."""
        poses = document["poses"]
        return {
            "design": design,
            "cell": cell,
            "lattice": np.array([document["a1"], document["a2"]], dtype=np.float64),
            "elements": tuple(pose["element"] for pose in poses),
            "position": np.array([pose["position"] for pose in poses], dtype=np.float64).reshape(-1, 3),
            "rotation": np.array([pose["rotation"] for pose in poses], dtype=np.float64).reshape(-1, 4),
            "document": document,
        }


class View:
    """A sheet in a notebook: a widget to turn, where k3d is there, and else a picture.

    `png` is the picture. A notebook that is read without a kernel shows the picture, too.
    """

    png: bytes

    def __init__(self, png: bytes, native: _native.Sheet | None, tile: tuple[int, int]) -> None:
        self.png = png
        self._native = native
        self._tile = tile

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the picture as PNG, whole or not at all."""
        write_whole(Path(file), self.png)

    def widget(self) -> Any:
        """The widget: a `k3d.Plot`, with a mesh for each kind of element."""
        with extra("widget"):
            import k3d

        if self._native is None:
            raise ArgumentError("interactive", "this view is a picture", "show it with interactive=True")
        plot = k3d.plot(grid_visible=False, camera_auto_fit=True, axes_helper=0)
        for kind, (name, vertices, triangles) in enumerate(self._native.mesh(self._tile, 48, 16)):
            plot += k3d.mesh(vertices, triangles, color=_COLORS[kind % len(_COLORS)], name=name, flat_shading=False)
        return plot

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        bundle: dict[str, Any] = {"text/plain": repr(self), "image/png": base64.b64encode(self.png).decode()}
        if self._native is not None:
            shown = self.widget()._repr_mimebundle_()
            widget: dict[str, Any] = shown[0] if isinstance(shown, tuple) else shown  # (data, metadata) of anywidget
            bundle.update({kind: data for kind, data in widget.items() if kind != "text/plain"})
        return bundle

    def __repr__(self) -> str:
        return f"<maille.View, {len(self.png)} bytes>"


def show(
    what: Sheet | DesignLike,
    *,
    tile: tuple[int, int] = (4, 4),
    size: tuple[int, int] = (800, 600),
    view: str = "tilted",
    color: Literal["element", "load"] = "element",
    interactive: bool | None = None,
) -> View:
    """A design, or a state of one, in three dimensions in a notebook.

    A widget of k3d, if it is installed (`pip install "maille[widget]"`), which is turned and zoomed with the mouse; else, with
    `interactive=False`, and where no kernel runs, the picture that `maille render` draws: exact tori, with the contact forces
    of a limit as arrows. `tile`: cells along a1 and a2; `size` of the picture in pixels; `view`: top, tilted, side, or
    `"azimuth,elevation"` in degrees; `color` by element or, of a limit, by load.

    >>> show("1.1", tile=(2, 2), interactive=False).png[1:4]
    b'PNG'
    """
    sheet = what if isinstance(what, Sheet) else start(Design.of(what))
    return sheet.show(tile=tile, size=size, view=view, color=color, interactive=interactive)


def start(design: Design) -> Sheet:
    """The state that a design is written in."""
    elements = design.elements
    poses = [
        {"element": element.name, "position": list(element.center), "rotation": [1.0, 0.0, 0.0, 0.0]} for element in elements
    ]
    return Sheet(**Sheet.fields(design, "1x1", {"poses": poses, "a1": list(design.a1), "a2": list(design.a2)}))


def _turned(rotation: Sequence[float] | NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points turned by a unit quaternion (w, x, y, z)."""
    w, axis = float(rotation[0]), np.asarray(rotation[1:], dtype=np.float64)
    twice = 2.0 * np.cross(axis, points)
    turned: NDArray[np.float64] = points + w * twice + np.cross(axis, twice)
    return turned


def _count(name: str, value: int) -> int:
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or value < 1:
        raise ArgumentError(name, f"{value!r} is no whole number from 1 on", "give two, as (4, 4)")
    return int(value)


def _has_widget() -> bool:
    from importlib.util import find_spec

    return find_spec("k3d") is not None
