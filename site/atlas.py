"""The atlas's table as a script that its page reads: python site/atlas.py TABLE DESIGNS.json OUT.js

TABLE is what `cargo xtask atlas` writes, DESIGNS.json the list that `maille designs --json` prints. A page that is opened from the
disk cannot read other files, but it can run a script.
"""

import json
import sys

import pyarrow.parquet as parquet

table, designs, out = sys.argv[1:]
rows = parquet.read_table(table).to_pylist()
directions = sorted({row["direction_deg"] for row in rows})
place = {direction: at for at, direction in enumerate(directions)}
about = {design["name"]: design for design in json.load(open(designs, encoding="utf-8"))}
names = sorted({row["design"] for row in rows}, key=list(about).index)
index = {name: at for at, name in enumerate(names)}

cells: dict[tuple[str, float, float], tuple[list[float | None], list[str]]] = {}
for row in rows:
    key = (row["design"], row["minor_radius"], row["spacing"])
    l1, proved = cells.setdefault(key, ([None] * len(directions), ["-"] * len(directions)))
    if row["l1"] is not None and row["status"] in ("global", "local"):
        l1[place[row["direction_deg"]]] = round(row["l1"], 5)
        proved[place[row["direction_deg"]]] = row["status"][0]

data = {
    "directions": directions,
    "designs": [
        {key: about[name][key] for key in ("name", "title", "minor_radius", "reference_radius")} for name in names
    ],
    "rows": [
        [index[name], minor_radius, spacing, l1, "".join(proved)]
        for (name, minor_radius, spacing), (l1, proved) in cells.items()
        if any(value is not None for value in l1)
    ],
    "without": sum(all(value is None for value in l1) for l1, _ in cells.values()),
}
with open(out, "w", encoding="utf-8") as file:
    file.write("window.atlas = " + json.dumps(data, separators=(",", ":"), allow_nan=False) + ";\n")
print(f"{len(data['rows'])} designs, {data['without']} without any limit")
