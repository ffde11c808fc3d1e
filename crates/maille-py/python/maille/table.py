"""What all results share: columns as arrays, and tables of pyarrow, pandas and polars made from them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._extra import extra

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

__all__ = ["Columns"]


class Columns:
    """A result with columns."""

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """The columns, each an array of one value a row."""
        raise NotImplementedError

    def to_arrow(self) -> pyarrow.Table:
        """A `pyarrow.Table`."""
        with extra("table"):
            import pyarrow

        columns = {name: (column, pyarrow.float64() if column.dtype.kind == "f" else None) for name, column in self.to_numpy().items()}
        return pyarrow.table({name: pyarrow.array(_plain(column), kind) for name, (column, kind) in columns.items()})

    def to_pandas(self) -> pandas.DataFrame:
        """A `pandas.DataFrame`."""
        with extra("table"):
            frame: pandas.DataFrame = self.to_arrow().to_pandas()
        return frame

    def to_polars(self) -> polars.DataFrame:
        """A `polars.DataFrame`."""
        with extra("polars"):
            import polars

        frame = polars.from_arrow(self.to_arrow())
        assert isinstance(frame, polars.DataFrame)
        return frame


def _plain(column: NDArray[Any]) -> list[Any]:
    """Python's own values, None where nothing is known."""
    values: list[Any] = column.tolist()
    return [None if isinstance(x, float) and np.isnan(x) else x for x in values]
