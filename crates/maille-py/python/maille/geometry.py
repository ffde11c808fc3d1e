"""Circles and tori in space, many pairs at once, on NumPy arrays.

A circle is given by its centre (3 numbers), a unit normal (3) and a radius. Arrays of N circles have the shapes
(N, 3), (N, 3) and (N,); a single circle, of shapes (3,), (3,) and (), is paired with each of the others. Lengths are in the
caller's unit. Arrays of `float64` in C order are read in place; others are copied once. Other Python threads run
meanwhile, and all cores are used; results do not depend on how many there are.

>>> import numpy as np
>>> minima = circle_distance_minima([0, 0, 0], [0, 0, 1], 1.0, [[1, 0, 0.5], [0, 0, 2]], [[0, 1, 0], [0, 0, 1]], 1.0)
>>> minima.kind.tolist()
['generic', 'coaxial']
>>> linking_number([0, 0, 0], [0, 0, 1], 1.0, [1, 0, 0], [0, 1, 0], 1.0).tolist()
[1]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from .errors import ShapeError

__all__ = ["KINDS", "MAX_MINIMA", "Minima", "circle_distance_minima", "linking_number", "torus_gap"]

#: Special positions of a pair, by `Minima.kind_code`: none; a common axis; one plane, different centres; one centre,
#: different planes; a constant distance without a common axis.
KINDS: tuple[str, ...] = ("generic", "coaxial", "coplanar", "concentric", "equidistant")
#: The most minima that are kept of a pair; more than two were never seen.
MAX_MINIMA: int = 4


@dataclass(frozen=True)
class Minima:
    """Local minima of the distance of N pairs of circles.

    Where the distance is constant (coaxial and equidistant pairs) one representative is given.
    """

    #: (N,) int64: how many there are, at least 1.
    count: NDArray[np.int64]
    #: (N, 4): distances in ascending order, NaN past `count`. The first is the distance of the circles.
    distance: NDArray[np.float64]
    #: (N, 4, 3): the points on the circles A.
    point_a: NDArray[np.float64]
    #: (N, 4, 3): the points on the circles B.
    point_b: NDArray[np.float64]
    #: (N,) uint8: place of the kind in `KINDS`.
    kind_code: NDArray[np.uint8]

    @property
    def kind(self) -> NDArray[np.str_]:
        """(N,): special position of each pair, one of `KINDS`."""
        names: NDArray[np.str_] = np.array(KINDS)
        return names[self.kind_code]

    def __len__(self) -> int:
        return len(self.count)


def circle_distance_minima(
    center_a: ArrayLike,
    normal_a: ArrayLike,
    radius_a: ArrayLike,
    center_b: ArrayLike,
    normal_b: ArrayLike,
    radius_b: ArrayLike,
) -> Minima:
    """All local minima of the distance between circles A and B, for N pairs.

    Shapes: centres and unit normals (N, 3), radii (N,), or those of one circle. Raises `ShapeError` for other shapes and
    `ArgumentError` for the first value that makes no circle.

    >>> one = circle_distance_minima([0, 0, 0], [0, 0, 1], 1.0, [3, 0, 0], [0, 0, 1], 1.0)
    >>> one.distance[0].round(12).tolist()
    [1.0, nan, nan, nan]
    >>> one.point_a[0, 0].round(12).tolist(), one.point_b[0, 0].round(12).tolist()
    ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0])
    """
    arrays, n = _pairs(
        center_a=center_a, normal_a=normal_a, radius_a=radius_a, center_b=center_b, normal_b=normal_b, radius_b=radius_b
    )
    out = Minima(
        count=np.empty(n, np.int64),
        distance=np.empty((n, MAX_MINIMA)),
        point_a=np.empty((n, MAX_MINIMA, 3)),
        point_b=np.empty((n, MAX_MINIMA, 3)),
        kind_code=np.empty(n, np.uint8),
    )
    ca, na, ra, cb, nb, rb = arrays
    _native.circle_distance_minima(ca, na, ra, cb, nb, rb, out.count, out.distance, out.point_a, out.point_b, out.kind_code)
    return out


def linking_number(
    center_a: ArrayLike,
    normal_a: ArrayLike,
    radius_a: ArrayLike,
    center_b: ArrayLike,
    normal_b: ArrayLike,
    radius_b: ArrayLike,
) -> NDArray[np.int64]:
    """(N,): linking number of each pair, -1, 0 or 1; circles run counter-clockwise about their normals. Shapes and errors
    as in `circle_distance_minima`. Turning one normal round changes the sign.

    >>> linking_number([0, 0, 0], [0, 0, 1], 1.0, [[1, 0, 0], [3, 0, 0]], [0, 1, 0], 1.0).tolist()
    [1, 0]
    """
    arrays, n = _pairs(
        center_a=center_a, normal_a=normal_a, radius_a=radius_a, center_b=center_b, normal_b=normal_b, radius_b=radius_b
    )
    out = np.empty(n, np.int64)
    ca, na, ra, cb, nb, rb = arrays
    _native.linking_number(ca, na, ra, cb, nb, rb, out)
    return out


def torus_gap(
    center_a: ArrayLike,
    normal_a: ArrayLike,
    radius_a: ArrayLike,
    minor_radius_a: ArrayLike,
    center_b: ArrayLike,
    normal_b: ArrayLike,
    radius_b: ArrayLike,
    minor_radius_b: ArrayLike,
) -> NDArray[np.float64]:
    """(N,): gap between the tori of each pair, the distance of their core circles less both minor radii, in the caller's
    unit; negative where they overlap. Shapes and errors as in `circle_distance_minima`.

    >>> torus_gap([0, 0, 0], [0, 0, 1], 1.0, 0.1, [3, 0, 0], [0, 0, 1], 1.0, [0.1, 0.6]).round(12).tolist()
    [0.8, 0.3]
    """
    arrays, n = _pairs(
        center_a=center_a,
        normal_a=normal_a,
        radius_a=radius_a,
        minor_radius_a=minor_radius_a,
        center_b=center_b,
        normal_b=normal_b,
        radius_b=radius_b,
        minor_radius_b=minor_radius_b,
    )
    out = np.empty(n)
    ca, na, ra, ma, cb, nb, rb, mb = arrays
    _native.torus_gap(ca, na, ra, ma, cb, nb, rb, mb, out)
    return out


def _pairs(**arguments: ArrayLike) -> tuple[list[NDArray[np.float64]], int]:
    """Arrays of one row a pair, or of one row; and the number of pairs."""
    out: list[NDArray[np.float64]] = []
    n: int | None = None
    of = ""
    for name, argument in arguments.items():
        vector = name.startswith(("center", "normal"))
        right = "(N, 3), or (3,) for a single circle" if vector else "(N,), or a number for a single circle"
        try:
            array = np.require(argument, np.float64, ["C", "A", "E"])  # columns of packed records are not aligned
            shape = np.shape(argument)
        except (TypeError, ValueError) as error:
            raise ShapeError(name, f"is no array of numbers ({error})", f"give numbers of the shape {right}") from None
        if len(shape) > 1 + vector or (vector and (not shape or shape[-1] != 3)):
            raise ShapeError(name, f"has the shape {shape}", f"give {right}", value=shape)
        single = len(shape) == int(vector)
        array = array.reshape((1, 3) if vector and single else (1,) if single else shape)
        out.append(array)
        if not single:
            if n is not None and len(array) != n:
                raise ShapeError(name, f"has {len(array)} rows, {of} has {n}", "give as many of each", value=shape)
            n, of = len(array), name
    return out, 1 if n is None else n
