"""The native part. What users need is in the Python modules beside it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__VERSION__: str

_Floats = NDArray[np.float64]
_Progress = Callable[[int, int], object]

class Design:
    @staticmethod
    def from_toml(text: str, name: str) -> Design: ...
    @staticmethod
    def builtin(name: str) -> Design | None: ...
    @staticmethod
    def from_json(text: str) -> Design: ...
    def to_toml(self) -> str: ...
    def to_json(self) -> str: ...
    def with_minor_radius(self, minor_radius: float) -> Design: ...
    def with_number(self, path: str, value: float) -> Design: ...
    def spaced(self, factor: float) -> Design: ...
    def scaled(self, factor: float) -> Design: ...
    def check(self) -> None: ...

class Record:
    def columns(self) -> list[dict[str, Any]]: ...
    def parquet(self, states: bool) -> bytes: ...
    def limits(self) -> list[tuple[str, str]]: ...
    def states(self) -> list[str]: ...
    def run(self) -> str: ...
    def design(self) -> Design: ...
    def save(self, folder: str, quantity_name: str, overwrite: bool) -> None: ...
    def __len__(self) -> int: ...

class Sheet:
    def __new__(cls, design: Design, cell: str, finite: bool, state: str | None) -> Sheet: ...
    def picture(self, tile: tuple[int, int] | None, size: tuple[int, int], view: str, color: str) -> bytes: ...
    def mesh(
        self, tile: tuple[int, int], around: int, across: int
    ) -> list[tuple[str, NDArray[np.float32], NDArray[np.uint32]]]: ...

def simulate(design: Design, tile: tuple[int, int], plan: str, progress: _Progress | None) -> tuple[str, str, str | None]: ...
def open_simulation(folder: Path) -> tuple[str, str, str | None]: ...
def save_simulation(folder: Path, record: str, frames: str, forces: str | None) -> None: ...
def builtin_names() -> list[str]: ...
def nearest_builtin_name(name: str) -> str | None: ...
def numbers(name: str, text: str | None = None, values: list[float] | None = None) -> list[float]: ...
def read_record(folder: str) -> Record: ...

def map_question(
    *,
    directions: list[float] | None,
    l2: list[float] | None,
    lateral_free: bool,
    shear_free: bool,
    compression: bool,
    method: str,
    cell: str,
    starts: int,
    seed: int,
    energy: str,
) -> str: ...
def characterize(
    design: Design,
    question: str,
    quantity_name: str,
    *,
    out: str | None,
    overwrite: bool,
    progress: _Progress | None,
    threads: int | None,
) -> Record: ...

class OpenMap:
    def __init__(self, design: Design, question: str, quantity_name: str, out: str | None, overwrite: bool) -> None: ...
    def count(self) -> tuple[int, int]: ...
    def chains(self) -> list[tuple[list[float], int, str]]: ...
    def chain(self, directions_deg: list[float]) -> Record: ...
    def keep(self, file: str, limits: list[tuple[str, str]]) -> int: ...
    def close(self) -> None: ...
    def finish(self) -> Record: ...

def joint_csv(names: list[str], records: list[Record]) -> str: ...
def study(name: str, text: str) -> str: ...
def folder_name(name: str) -> str: ...
def limit(
    design: Design,
    goal: str,
    sign: float,
    *,
    fix: list[tuple[str, float]],
    free: list[str],
    direction_deg: float,
    cell: str,
    starts: int | None,
    seed: int,
) -> str: ...
def extreme(
    design: Design,
    *,
    thickest: bool,
    lattice_free: bool,
    starts: int,
    seed: int,
    threads: int | None,
) -> tuple[str, Design | None]: ...
def boundary(
    design: Design,
    *,
    tolerance: float,
    vertices: int,
    starts: int,
    cell: str,
    seed: int,
    progress: _Progress | None,
    threads: int | None,
) -> tuple[list[str], list[tuple[int, int, int]], float]: ...

class SurfaceFolder:
    @staticmethod
    def open(
        design: Design, starts: int, cell: str, seed: int, folder: Path, overwrite: bool
    ) -> tuple[SurfaceFolder, list[str]]: ...
    def keep(self, vertices: list[str]) -> None: ...
    def close(self) -> None: ...

def solve_rays(design: Design, rays: list[str], starts: int, cell: str, seed: int) -> list[str]: ...
def boundary_by(
    design: Design,
    tolerance: float,
    vertices: int,
    starts: int,
    cell: str,
    seed: int,
    known: list[str],
    solve: Callable[[list[str], bool], list[str]],
) -> tuple[list[str], list[tuple[int, int, int]], float]: ...
def circle_distance_minima(
    center_a: _Floats,
    normal_a: _Floats,
    radius_a: _Floats,
    center_b: _Floats,
    normal_b: _Floats,
    radius_b: _Floats,
    count: NDArray[np.int64],
    distance: _Floats,
    point_a: _Floats,
    point_b: _Floats,
    kind: NDArray[np.uint8],
    /,
) -> None: ...
def linking_number(
    center_a: _Floats,
    normal_a: _Floats,
    radius_a: _Floats,
    center_b: _Floats,
    normal_b: _Floats,
    radius_b: _Floats,
    linking: NDArray[np.int64],
    /,
) -> None: ...
def torus_gap(
    center_a: _Floats,
    normal_a: _Floats,
    radius_a: _Floats,
    minor_radius_a: _Floats,
    center_b: _Floats,
    normal_b: _Floats,
    radius_b: _Floats,
    minor_radius_b: _Floats,
    gap: _Floats,
    /,
) -> None: ...
