"""Chains of limits: what a worker does, and the Parquet file of one.

A chain is the limits along one direction, each solved from its neighbour's state, and along the directions that are its images
under the symmetries of the design: the least that can be asked for alone.
"""

from __future__ import annotations

import io
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow
from pyarrow import parquet

from .. import _native
from ..design import Design
from ..errors import ChainError, MailleError

#: Column of the state beside those of `limits.csv`: the line of `states.jsonl`.
STATE = "state"
#: A worker keeps nothing.
ALONE: dict[str, Any] = {"out": None, "overwrite": False, "sensitivities": False, "progress": None, "threads": 1}
#: Rows and states, both as JSON.
Limits = list[tuple[str, str]]


@dataclass(frozen=True)
class Solved:
    """A chain, and its Parquet file."""

    limits: Limits
    file: bytes


def solve(design: Design, question: str, directions_deg: list[float], version: str) -> Solved | MailleError:
    """Solves a chain; what is wrong with the question comes back and is not tried again."""
    if version != _native.__VERSION__:
        return ChainError(f"the worker has maille {_native.__VERSION__}, not {version}")
    chain = json.dumps({**json.loads(question), "directions_deg": directions_deg})
    try:
        found = _native.characterize(design._inner, chain, "stretch", **ALONE)
    except MailleError as error:
        return error
    return Solved(found.limits(), found.parquet(True))


def read_limits(file: Path) -> Limits | None:
    """What the file of a chain holds; None where there is none, or it is damaged: then it is computed again."""
    try:
        table = parquet.read_table(io.BytesIO(file.read_bytes()))
        rows = table.drop_columns([STATE]).to_pylist()
        return [(json.dumps(row), state) for row, state in zip(rows, table.column(STATE).to_pylist())]
    except FileNotFoundError:
        return None
    except (pyarrow.ArrowException, KeyError):
        os.unlink(file)
        return None
