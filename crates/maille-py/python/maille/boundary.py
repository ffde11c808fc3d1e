"""The surface of all in-plane strains that a sheet can have, and where a strain lies to it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._extra import extra
from .design import DesignLike, chosen
from .errors import ShapeError
from .record import Progress, _Bar, _effort, _whole
from .table import Columns

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

__all__ = ["Boundary", "boundary"]

#: Strains that are compared with all triangles at once.
_CHUNK = 256


@dataclass(frozen=True)
class Boundary(Columns):
    """A closed surface of triangles in the space of Green strains (exx, eyy, exy), exy the tensor shear.

    Each vertex is the end of a ray from the written lattice, the origin. Strains are arrays of shape (3,) or (N, 3).
    """

    #: (V, 3): the farthest state on each ray that was found.
    vertices: NDArray[np.float64]
    #: (V,): proven bound of its distance from the origin, infinite where there is none.
    bound: NDArray[np.float64]
    #: (V,): `global`, `local`, `uncertified` or `l2-not-reached`.
    status: NDArray[np.str_]
    #: (T, 3): vertices of each triangle, counter-clockwise from outside.
    triangles: NDArray[np.int64]
    #: Largest expected distance between the surface and its triangles.
    arch: float

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns: a row for each vertex, of exx, eyy, exy, bound and status."""
        return {**dict(zip(("exx", "eyy", "exy"), self.vertices.T)), "bound": self.bound, "status": self.status}

    def plot(self, *, ax: Axes3D | None = None, **surface: Any) -> Axes3D:
        """Draws the surface in three dimensions, and gives the axes."""
        if ax is None:
            with extra("plot"):
                from matplotlib import pyplot
            from mpl_toolkits.mplot3d import Axes3D

            made = pyplot.figure(layout="constrained").add_subplot(projection="3d")
            assert isinstance(made, Axes3D)
            ax = made
        look = {"cmap": "viridis", "edgecolor": "white", "linewidth": 0.1, "alpha": 0.9}
        x, y, z = self.vertices.T
        ax.plot_trisurf(x, y, z, triangles=self.triangles, **{**look, **surface})
        ax.set_xlabel("exx")
        ax.set_ylabel("eyy")
        ax.set_zlabel("exy")
        return ax

    def contains(self, strain: ArrayLike) -> NDArray[np.bool_]:
        """(N,), or a scalar: whether a strain lies in the surface or on it, to 1e-12.

        The sheet can be strained so, as far as the triangles are the surface: see `arch`.
        """
        strains, single = _strains(strain)
        inside = self._share(strains) <= 1.0 + 1e-12
        return np.asarray(inside[0]) if single else inside

    def margin(self, strain: ArrayLike) -> NDArray[np.float64]:
        """(N,), or a scalar: distance of a strain from the surface in the space of (exx, eyy, exy); negative outside."""
        strains, single = _strains(strain)
        distance = np.linalg.norm(strains - self._nearest(strains), axis=1)
        signed = np.where(self._share(strains) <= 1.0, distance, -distance)
        return np.asarray(signed[0]) if single else signed

    def project(self, strain: ArrayLike) -> NDArray[np.float64]:
        """(N, 3), or (3,): the strain itself where it is in the surface, else the nearest point of the surface."""
        strains, single = _strains(strain)
        inside = self._share(strains) <= 1.0
        out = np.where(inside[:, None], strains, self._nearest(strains))
        return np.asarray(out[0]) if single else out

    def _share(self, strains: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far along its ray to the surface each strain is: 1 on it. The surface is met by each ray once."""
        corners = self.vertices[self.triangles]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        normal = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
        volume = np.einsum("tk,tk->t", a, normal[:, 0])
        flat = np.abs(volume) <= 1e-300
        weights = normal / np.where(flat, 1.0, volume)[:, None, None]
        out = np.empty(len(strains))
        for first in range(0, len(strains), _CHUNK):
            part = strains[first : first + _CHUNK]
            w = np.einsum("tik,nk->nti", weights, part)
            least = np.where(flat, -np.inf, w.min(axis=2))
            # The cone that holds the strain is the one of whose weights the least is largest.
            cone = np.argmax(least / np.maximum(np.abs(w).sum(axis=2), 1e-300), axis=1)
            out[first : first + _CHUNK] = w[np.arange(len(part)), cone].sum(axis=1)
        out[np.all(strains == 0.0, axis=1)] = 0.0
        return out

    def _nearest(self, strains: NDArray[np.float64]) -> NDArray[np.float64]:
        corners = self.vertices[self.triangles]
        out = np.empty_like(strains)
        for first in range(0, len(strains), _CHUNK):
            part = strains[first : first + _CHUNK]
            points = _on_triangles(part[:, None, :], corners[None, :, 0], corners[None, :, 1], corners[None, :, 2])
            best = np.argmin(np.linalg.norm(points - part[:, None, :], axis=2), axis=1)
            out[first : first + _CHUNK] = points[np.arange(len(part)), best]
        return out


def boundary(
    design: DesignLike,
    *,
    tolerance: float = 3e-3,
    vertices: int = 5000,
    cell: str = "1x1",
    effort: str = "normal",
    starts: int | None = None,
    minor_radius: float | None = None,
    seed: int = 1,
    progress: Progress = None,
    threads: int | None = None,
) -> Boundary:
    """The closed surface of all in-plane strains of a sheet: what `maille boundary` finds.

    Rays are added until the surface is expected within `tolerance` of its triangles, or there are that many `vertices`.
    `effort`, or a number of `starts`, says how long each is searched; with the cell `auto` unstable waves are followed
    into larger cells.
    """
    search = _search(tolerance, vertices, effort, starts, cell, seed)
    with _Bar(progress, unit="ray") as told:
        found, triangles, arch = _native.boundary(
            chosen(design, minor_radius)._inner,
            search,
            progress=told,
            threads=None if threads is None else _whole("threads", threads, 1),
        )
    return _surface(found, triangles, arch)


def _search(tolerance: float, vertices: int, effort: str, starts: int | None, cell: str, seed: int) -> str:
    return _native.boundary_options(
        tolerance=tolerance,
        vertices=_whole("vertices", vertices, 162),
        effort=_effort(effort),
        starts=None if starts is None else _whole("starts", starts, 1),
        cell=cell,
        seed=_whole("seed", seed, 0),
    )


def _surface(found: list[str], triangles: list[tuple[int, int, int]], arch: float) -> Boundary:
    rays = [json.loads(vertex) for vertex in found]
    return Boundary(
        vertices=np.array([ray["direction"] for ray in rays]) * np.array([[ray["distance"] or 0.0] for ray in rays]),
        bound=np.array([np.inf if ray["bound"] is None else ray["bound"] for ray in rays]),
        status=np.array([ray["status"] for ray in rays]),
        triangles=np.array(triangles, dtype=np.int64),
        arch=arch,
    )


def _strains(strain: ArrayLike) -> tuple[NDArray[np.float64], bool]:
    array = np.asarray(strain, dtype=np.float64)
    if array.shape == (2, 2):
        raise ShapeError("strain", "has the shape (2, 2)", "give (exx, eyy, exy)", value=array.shape)
    if array.ndim not in (1, 2) or array.shape[-1] != 3:
        raise ShapeError("strain", f"has the shape {array.shape}", "give (3,) or (N, 3): exx, eyy, exy", value=array.shape)
    return np.atleast_2d(array), array.ndim == 1


def _on_triangles(
    p: NDArray[np.float64], a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Nearest points of triangles: that in the plane if it is inside, else the nearest of the three sides."""
    ab, ac = b - a, c - a
    normal = np.cross(ab, ac)
    area_sq = np.maximum(np.einsum("...k,...k", normal, normal), 1e-300)
    v = np.einsum("...k,...k", np.cross(p - a, ac), normal) / area_sq
    w = np.einsum("...k,...k", np.cross(ab, p - a), normal) / area_sq
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    best: NDArray[np.float64] = a + v[..., None] * ab + w[..., None] * ac
    distance = np.where(inside, np.linalg.norm(best - p, axis=-1), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        side = end - start
        length_sq = np.maximum(np.einsum("...k,...k", side, side), 1e-300)
        t = np.clip(np.einsum("...k,...k", p - start, side) / length_sq, 0.0, 1.0)
        point = start + t[..., None] * side
        away = np.linalg.norm(point - p, axis=-1)
        best = np.where((away < distance)[..., None], point, best)
        distance = np.minimum(distance, away)
    return best
