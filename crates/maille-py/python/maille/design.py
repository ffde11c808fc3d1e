"""Designs: a periodic sheet of rigid elements, each of one ring or several."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

from . import _native
from ._files import write_whole
from .errors import ArgumentError, DesignError, UnknownDesignError

__all__ = ["Design", "DesignLike", "Element", "Ring", "designs"]

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Ring:
    """A torus, in the unit of its design.

    `major_radius` is that of the core circle, `normal` that of its plane (any length but 0), `offset` the centre relative to the
    element's, `minor_radius` the wire's radius where it is not the design's.
    """

    major_radius: float
    normal: Sequence[float] = (0.0, 0.0, 1.0)
    offset: Sequence[float] = (0.0, 0.0, 0.0)
    minor_radius: float | None = None


@dataclass(frozen=True)
class Element:
    """A rigid body of one ring or several, with a name of its own and the position of its `center`."""

    name: str
    center: Sequence[float]
    rings: Sequence[Ring]


class Design:
    """A periodic sheet: elements in a cell, and the two lattice vectors that repeat it.

    Lengths are in the design's own unit (`unit` is a label). The lattice vectors `a1` and `a2` lie in the plane z = 0. What cannot be
    raises `DesignError` with all its problems.

    >>> ring = Ring(1.0, normal=(0, 0, 1))
    >>> design = Design(
    ...     "square", a1=(2.5, 0, 0), a2=(0, 2.5, 0), minor_radius=0.1, reference_radius=1.0,
    ...     elements=[
    ...         Element("flat", (0, 0, 0), [ring]),
    ...         Element("along-x", (1.25, 0, 0), [Ring(1.0, normal=(0, 1, 0))]),
    ...         Element("along-y", (0, 1.25, 0), [Ring(1.0, normal=(1, 0, 0))]),
    ...     ],
    ... )
    >>> design.with_minor_radius(0.05).minor_radius
    0.05
    >>> Design.builtin("1.1").name
    '1.1'
    """

    _inner: _native.Design

    def __init__(
        self,
        name: str,
        *,
        a1: Sequence[float],
        a2: Sequence[float],
        elements: Sequence[Element],
        reference_radius: float,
        minor_radius: float | None = None,
        unit: str | None = None,
        title: str = "",
        allow_initial_overlap: bool = False,
    ) -> None:
        fields: dict[str, Any] = {
            "name": name,
            "title": title,
            "reference_radius": float(reference_radius),
            "allow_initial_overlap": allow_initial_overlap,
            "lattice": {"a1": _floats(a1, "lattice.a1"), "a2": _floats(a2, "lattice.a2")},
            "elements": [_element(k, element) for k, element in enumerate(elements)],
        }
        if unit is not None:
            fields["unit"] = unit
        if minor_radius is not None:
            fields["minor_radius"] = float(minor_radius)
        self._inner = _native.Design.from_json(_json(fields))

    @classmethod
    def _of(cls, native: _native.Design) -> Design:
        out = cls.__new__(cls)
        out._inner = native
        return out

    @classmethod
    def builtin(cls, name: str) -> Design:
        """The built-in design of that name (see `designs`); `UnknownDesignError` if there is none."""
        native = _native.Design.builtin(name)
        if native is None:
            raise _unknown(name)
        return cls._of(native)

    @classmethod
    def load(cls, file: str | os.PathLike[str]) -> Design:
        """Reads a design file (TOML); `DesignError` names file, line and field of all that is wrong."""
        name = os.fspath(file)
        try:
            text = Path(file).read_text(encoding="utf-8")
        except FileNotFoundError:
            raise _unknown(name) from None
        return cls._of(_native.Design.from_toml(text, name))

    @classmethod
    def of(cls, design: DesignLike) -> Design:
        """A design as it is, a built-in one by its name, or a file by its path."""
        if isinstance(design, Design):
            return design
        try:
            name = os.fsdecode(design)
        except TypeError:
            remedy = "give a Design, the name of a built-in one, or the path of a file"
            raise ArgumentError("design", f"{design!r} is no design", remedy) from None
        if not os.path.isfile(name):
            return cls.builtin(name)
        return cls.load(name)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes the design as a TOML file, whole or not at all."""
        write_whole(Path(file), self.to_toml().encode())

    def to_toml(self) -> str:
        """The text of the design's file."""
        return self._inner.to_toml()

    def with_minor_radius(self, minor_radius: float) -> Design:
        """The same design with another wire; rings with a minor radius of their own keep it."""
        return Design._of(self._inner.with_minor_radius(minor_radius))

    def with_number(self, path: str, value: float) -> Design:
        """The same design with another value at a place of its file, as `lattice.a1.x` or `elements.standing-*.rings.major_radius`,
        where `*` stands for anything: all that match are set."""
        return Design._of(self._inner.with_number(path, value))

    @property
    def parameters(self) -> dict[str, float]:
        """The named numbers of the design's file with their values, in its order; computed ones too."""
        return {name: value for name, value, *_ in self._inner.parameters()}

    @property
    def free_parameters(self) -> dict[str, tuple[float | None, float | None]]:
        """The parameters that can be set, with their least and largest values where the file gives them."""
        return {name: (least, most) for name, _, least, most, free in self._inner.parameters() if free}

    def with_parameters(self, **values: float) -> Design:
        """The same design with other values of parameters, as `design.with_parameters(radius=5.0)`: what is computed from them
        is computed anew. Refused are names that are no free parameter, and values out of their bounds."""
        return Design._of(self._inner.with_parameters([(name, float(value)) for name, value in values.items()]))

    def spaced(self, factor: float) -> Design:
        """The same rings `factor` times as far apart."""
        return Design._of(self._inner.spaced(factor))

    def scaled(self, factor: float) -> Design:
        """The same design with every length multiplied by `factor`."""
        return Design._of(self._inner.scaled(factor))

    def check(self) -> None:
        """Raises `DesignError` if rings overlap in the starting state, or if it cannot be solved for another reason."""
        self._inner.check()

    def sensitivity(
        self,
        direction: float = 0.0,
        l2: float = 0.0,
        *,
        step: float | None = None,
        cell: str = "auto",
        effort: str = "normal",
        starts: int | None = None,
        seed: int = 1,
    ) -> dict[str, Any]:
        """How the limit along `direction` (degrees) with `l2` held changes with each number of the design: what
        `maille sensitivity` does, with the keys of its JSON document.

        `numbers` has a row for each, the largest change first: `number`, its `step`, the first-order `change` of l1 for a step
        forward and `change_back` for a step back, both derivatives, whether they differ (`kink`), and the pairs of rings
        `through` which it acts. `step`: of all lengths; by default 0.1 mm, or 1 % of the reference radius.
        A limit that is not certified has no derivatives: `ArgumentError`.

        >>> rows = Design.builtin("1.1").sensitivity(0)["numbers"]
        >>> wire = next(row for row in rows if row["number"].startswith("minor_radius"))
        >>> round(wire["derivative"], 6)
        -1.6
        """
        from .question import stretch_sensitivity

        return stretch_sensitivity(self, direction, l2, step, cell, effort, starts, seed)

    @property
    def name(self) -> str:
        """Its short name."""
        return str(self._fields["name"])

    @property
    def title(self) -> str:
        """One line on what it is."""
        return str(self._fields["title"])

    @property
    def unit(self) -> str | None:
        """Label of the unit of length."""
        return self._fields.get("unit")

    @property
    def minor_radius(self) -> float | None:
        """Wire radius of every ring that gives none."""
        return self._fields.get("minor_radius")

    @property
    def reference_radius(self) -> float:
        """R: tolerances, and lengths in units of R, are relative to it."""
        return float(self._fields["reference_radius"])

    @property
    def a1(self) -> Vector:
        """First lattice vector."""
        return _vector(self._fields["lattice"]["a1"])

    @property
    def a2(self) -> Vector:
        """Second lattice vector."""
        return _vector(self._fields["lattice"]["a2"])

    @property
    def elements(self) -> tuple[Element, ...]:
        """The elements of one cell."""
        return tuple(
            Element(e["name"], _vector(e["center"]), tuple(Ring(**ring) for ring in e["rings"]))
            for e in self._fields["elements"]
        )

    @property
    def _fields(self) -> dict[str, Any]:
        fields: dict[str, Any] = json.loads(self._inner.to_json())
        return fields

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Design) and self._inner.to_json() == other._inner.to_json()

    def __hash__(self) -> int:
        return hash(self._inner.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        return (_from_json, (self._inner.to_json(),))

    def __repr__(self) -> str:
        count = len(self._fields["elements"])
        return f"<maille.Design {self.name!r}, {count} element{'s' if count != 1 else ''}, r = {self.minor_radius}>"


#: What functions take as a design: one, the name of a built-in one, or the path of a file.
DesignLike = Union[Design, str, "os.PathLike[str]"]


def designs() -> list[str]:
    """Names of the built-in designs.

    >>> "european-4-in-1" in designs()
    True
    """
    return _native.builtin_names()


def chosen(design: DesignLike, minor_radius: float | None) -> Design:
    """The design, with another wire where one is given."""
    of = Design.of(design)
    return of if minor_radius is None else of.with_minor_radius(minor_radius)


def _from_json(text: str) -> Design:
    return Design._of(_native.Design.from_json(text))


def _unknown(name: str) -> UnknownDesignError:
    near = _native.nearest_builtin_name(name)
    if near is not None:
        return UnknownDesignError(name, f"did you mean {near}? maille.designs() lists them")
    return UnknownDesignError(name, f"built in are {', '.join(designs())}")


def _wrong(field: str, problem: str, remedy: str) -> DesignError:
    return DesignError(
        file=None,
        problems=[{"field": field, "problem": problem, "remedy": remedy, "line": None, "column": None}],
    )


def _floats(values: Sequence[float], field: str) -> list[float]:
    try:
        out = [float(x) for x in values]
    except (TypeError, ValueError):
        out = []
    if len(out) != 3:
        raise _wrong(field, f"{values!r} is no vector", "give three numbers")
    return out


def _element(k: int, element: Element) -> dict[str, Any]:
    at = f"elements[{k}]"
    rings = []
    for j, ring in enumerate(element.rings):
        fields: dict[str, Any] = {
            "major_radius": float(ring.major_radius),
            "normal": _floats(ring.normal, f"{at}.rings[{j}].normal"),
            "offset": _floats(ring.offset, f"{at}.rings[{j}].offset"),
        }
        if ring.minor_radius is not None:
            fields["minor_radius"] = float(ring.minor_radius)
        rings.append(fields)
    return {"name": element.name, "center": _floats(element.center, f"{at}.center"), "rings": rings}


def _json(fields: dict[str, Any]) -> str:
    try:
        return json.dumps(fields, allow_nan=False)
    except ValueError:
        raise _wrong("design", "a number is not finite", "give finite numbers") from None


def _vector(values: Sequence[float]) -> Vector:
    x, y, z = values
    return (x, y, z)
