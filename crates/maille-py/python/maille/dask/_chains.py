"""Chains of limits: what a worker does, and the Parquet file of one.

A chain is the limits along one direction, each solved from its neighbour's state: the least that can be asked for alone.
"""

from __future__ import annotations

import io
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Union

import pyarrow  # type: ignore[import-untyped, unused-ignore]
from pyarrow import parquet

from .. import _native
from ..design import Design
from ..errors import ChainError, MailleError
from ..record import Record

if TYPE_CHECKING:
    from .._native import Asked

#: Column of the state beside those of `limits.csv`: the line of `states.jsonl`.
STATE = "state"
#: A file, or why there is none.
Solved = Union[bytes, MailleError]


def solve(design: Design, asked: Asked, direction_deg: float, version: str) -> Solved:
    """The file of a chain; what is wrong with the question comes back and is not tried again."""
    if version != _native.__VERSION__:
        return ChainError(f"the worker has maille {_native.__VERSION__}, not {version}")
    chain: Asked = {**asked, "directions": [direction_deg]}
    try:
        native = _native.characterize(design._inner, chain, out=None, overwrite=False, progress=None, threads=1)
    except MailleError as error:
        return error
    return chain_file(Record(native))


def chain_file(record: Record) -> bytes:
    """The table of a record with a column for the states, as Parquet."""
    table = record.to_arrow().append_column(STATE, pyarrow.array(record._inner.states(), pyarrow.string()))
    out = io.BytesIO()
    parquet.write_table(table, out)
    return out.getvalue()


def limits(data: bytes) -> list[tuple[str, str]]:
    """Each row and state of such a file, as JSON."""
    table = parquet.read_table(io.BytesIO(data))
    rows = table.drop_columns([STATE]).to_pylist()
    return [(json.dumps(row), state) for row, state in zip(rows, table.column(STATE).to_pylist())]


def read_limits(file: Path) -> list[tuple[str, str]] | None:
    """The same of a file on the disk; None where there is none, or it is damaged: then it is computed again."""
    try:
        return limits(file.read_bytes())
    except FileNotFoundError:
        return None
    except (pyarrow.ArrowException, KeyError):
        os.unlink(file)
        return None
