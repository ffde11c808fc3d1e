"""What other programs read in a Parquet table: `python check_table.py FOLDER`, which holds table.parquet, expected.json.

expected.json has columns (name, type, unit, meaning), rows (null where a value is missing) and the schema's number; it is
not written by the code that writes the Parquet.
"""

import json
import sys
from pathlib import Path

import duckdb
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq

ARROW = {"text": pa.string(), "number": pa.float64(), "count": pa.int64(), "flag": pa.bool_()}
POLARS = {"text": pl.String, "number": pl.Float64, "count": pl.Int64, "flag": pl.Boolean}
DUCKDB = {"text": "VARCHAR", "number": "DOUBLE", "count": "BIGINT", "flag": "BOOLEAN"}


def check(name, found, wanted):
    if found != wanted:
        raise SystemExit(f"FAILED {name}: found {found}, wanted {wanted}")


def main(folder):
    file = folder / "table.parquet"
    expected = json.loads((folder / "expected.json").read_text(encoding="utf-8"))
    columns, rows = expected["columns"], expected["rows"]
    names = [column["name"] for column in columns]
    kinds = {column["name"]: column["type"] for column in columns}

    table = pq.read_table(file)
    check("pyarrow: columns", table.column_names, names)
    check("pyarrow: types", {f.name: f.type for f in table.schema}, {n: ARROW[k] for n, k in kinds.items()})
    check("pyarrow: rows", table.to_pylist(), rows)
    for column in columns:
        metadata = {k.decode(): v.decode() for k, v in table.schema.field(column["name"]).metadata.items()}
        wanted = {"unit": column["unit"], "meaning": column["meaning"]}
        check(f"pyarrow: metadata of {column['name']}", metadata, {k: v for k, v in wanted.items() if v is not None})
    check("pyarrow: schema", table.schema.metadata[b"maille.schema"].decode(), str(expected["schema"]))
    records = json.loads(table.schema.metadata[b"maille.records"])
    check("pyarrow: records", records, expected["records"])

    frame = pd.read_parquet(file)
    check("pandas: columns", list(frame.columns), names)
    for name, kind in kinds.items():
        wanted = [row[name] for row in rows]
        found = [None if pd.isna(x) else x for x in frame[name]]
        check(f"pandas: {name}", found, wanted)
        if kind == "number":
            check(f"pandas: type of {name}", str(frame[name].dtype), "float64")
    nullable = pd.read_parquet(file, dtype_backend="numpy_nullable")
    check("pandas: type of zero_modes", str(nullable["zero_modes"].dtype), "Int64")

    check("polars: types", dict(pl.read_parquet_schema(file)), {n: POLARS[k] for n, k in kinds.items()})
    check("polars: rows", pl.read_parquet(file).to_dicts(), rows)
    check("polars: chosen", pl.scan_parquet(file).filter(pl.col("l1") > 0.3).select(pl.len()).collect().item(),
          sum(row["l1"] is not None and row["l1"] > 0.3 for row in rows))

    with duckdb.connect() as connection:
        described = connection.execute(f"DESCRIBE SELECT * FROM '{file}'").fetchall()
        check("duckdb: types", {row[0]: row[1] for row in described}, {n: DUCKDB[k] for n, k in kinds.items()})
        found = connection.execute(f"SELECT * FROM '{file}'").fetchall()
        check("duckdb: rows", [dict(zip(names, row)) for row in found], rows)
        keys = connection.execute(f"SELECT key FROM parquet_kv_metadata('{file}')").fetchall()
        check("duckdb: metadata", {b"maille.schema", b"maille.records"} <= {key for (key,) in keys}, True)

    print(f"{len(rows)} rows of {len(names)} columns read alike by pyarrow, pandas, polars, DuckDB; {file.stat().st_size} bytes")


main(Path(sys.argv[1]))
