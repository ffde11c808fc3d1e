"""What a run on a cluster leaves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow
from pyarrow import dataset as arrow_dataset

from ..errors import MailleError
from ..record import Record

if TYPE_CHECKING:
    import pandas

#: Folders and file of a run.
RECORDS, CHAINS, TABLE = "records", "chains", "limits.csv"


@dataclass(frozen=True)
class Failure:
    """What could not be computed: a whole map, or the chain that begins with one direction (degrees)."""

    name: str
    direction_deg: float | None
    error: MailleError

    def __str__(self) -> str:
        chain = "" if self.direction_deg is None else f", {self.direction_deg:g}°"
        first, *more = str(self.error).splitlines()
        return f"{self.name}{chain}: {first}" + (f" … and {len(more)} more" if more else "")


@dataclass(frozen=True)
class Results:
    """The records of a run, by name, and where they are."""

    #: Folder with `records/NAME/`, `chains/record=NAME/` (Parquet, a file for each chain) and `limits.csv` (the rows of all).
    out: Path
    #: One record for each map that could be opened.
    records: dict[str, Record]
    #: What could not be computed.
    failures: tuple[Failure, ...]
    #: Chains of all records, and those of them that this run has solved.
    chains: int
    solved: int

    def dataset(self) -> arrow_dataset.Dataset:
        """All rows, read when they are asked for; the column `record` has the name of the map, `state` the line of `states.jsonl`."""
        folders = [self.out / CHAINS / f"record={name}" for name in self.records]
        files = [str(file) for folder in folders if folder.is_dir() for file in sorted(folder.glob("*.parquet"))]
        names = arrow_dataset.partitioning(pyarrow.schema([("record", pyarrow.string())]), flavor="hive")
        return arrow_dataset.dataset(files, partitioning=names, partition_base_dir=str(self.out / CHAINS))

    def to_pandas(self) -> pandas.DataFrame:
        """All rows without the states, a `pandas.DataFrame`."""
        dataset = self.dataset()
        names = [name for name in dataset.schema.names if name != "state"]
        frame: pandas.DataFrame = dataset.to_table(columns=names).to_pandas()
        return frame
