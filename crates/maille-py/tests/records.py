"""What of a record is the same in each run of the same inputs: all but the times."""

import csv
import json
from pathlib import Path


def table(file: Path) -> list[dict[str, str]]:
    """The rows of a table without the time that each took; of joint tables, records by name."""
    with open(file, newline="") as text:
        rows = list(csv.DictReader(text))
    for row in rows:
        row.pop("wall_s", None)
        if "record" in row:
            row["record"] = Path(row["record"]).name
    return rows


def content(file: Path) -> bytes:
    """The bytes of a file; of `run.json` without the checksum of the table, which holds times."""
    if file.name != "run.json":
        return file.read_bytes()
    run = json.loads(file.read_text())
    del run["files"]["limits.csv"]
    return json.dumps(run).encode()
