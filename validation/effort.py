#!/usr/bin/env python3
"""How often more effort beats less: the same limits of random designs at two efforts.

    cargo run --release -p maille-io --example random_designs -- --seed 22 --count 60 --doubled 0 DESIGNS
    python3 validation/effort.py PROGRAM DESIGNS [--efforts normal thorough] [--cell 1x1] [--rows effort.csv]

An effort `10x` gives each limit ten times the time that the other effort took on the design's average limit. Three directions and three l2 of each design. Prints how many rows the second effort raises, and by how much. With --rows
each design's limits are added to that file when both efforts are done; a later run skips the designs that it has, so that
a long comparison can be stopped and continued.
"""

import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

QUESTION = ["--directions", "10,70,130", "--l2=-0.1,0,0.05", "--quiet"]
COLUMNS = ["design", "cell", "direction_deg", "l2", "effort", "l1", "status", "better_chance", "runs", "wall_s"]


def limits(program: str, design: Path, effort: str, cell: str, limit_s: float | None) -> list[dict[str, str]] | None:
    """The rows of one design at one effort; None where the time was not enough."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / design.stem
        command = [program, "characterize", str(design), *QUESTION, "--cell", cell, "--effort", effort]
        try:
            code = subprocess.run([*command, "--out", str(out)], check=False, timeout=limit_s).returncode
        except subprocess.TimeoutExpired:
            return None
        # 5: some limits were not found.
        if code not in (0, 5):
            raise SystemExit(f"{' '.join(command)} ended with {code}")
        with (out / "limits.csv").open() as file:
            rows = list(csv.DictReader(file))
    named = {"design": design.stem, "cell": cell}
    return [{column: named.get(column, row.get(column, "")) for column in COLUMNS} for row in rows]


def timed(effort: str, rows: list[dict[str, str]]) -> str:
    """The effort for the program: `10x` as a time."""
    if not effort.endswith("x"):
        return effort
    seconds = float(effort[:-1]) * sum(float(row["wall_s"]) for row in rows) / len(rows)
    return f"{max(seconds, 0.001):.3f}s"


def compare(efforts: list[str], rows: list[dict[str, str]]) -> None:
    by_effort = [{(r["design"], r["direction_deg"], r["l2"]): r for r in rows if r["effort"] == e} for e in efforts]
    raised, lowered = [], 0
    for key, less in by_effort[0].items():
        more = by_effort[1][key]
        gain = float(more["l1"] or "-inf") - float(less["l1"] or "-inf")
        lowered += gain < -1e-6
        if gain > 1e-6:
            raised.append(gain)
            name, direction_deg, l2 = key
            print(f"{name} {direction_deg}° l2 {l2}: {less['l1']} {more['l1']} (chance {less['better_chance']})")
    designs = len({key[0] for key in by_effort[0]})
    large = sum(gain > 1e-3 for gain in raised)
    print(f"{len(by_effort[0])} rows of {designs} designs; {efforts[1]} beats {efforts[0]} at {len(raised)}, "
          f"by more than 1e-3 at {large}; lower at {lowered}")
    print("seconds:", *(f"{sum(float(r['wall_s']) for r in found.values()):.1f}" for found in by_effort))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("designs", type=Path)
    parser.add_argument("--efforts", nargs=2, default=["normal", "thorough"])
    parser.add_argument("--cell", default="1x1")
    parser.add_argument("--only", default="", help="names of designs with commas; all where it is not given")
    parser.add_argument("--rows", type=Path, help="CSV to which finished designs are added")
    parser.add_argument("--limit-s", type=float, help="a design that takes longer at one effort is left out")
    args = parser.parse_args()
    rows = []
    if args.rows and args.rows.exists():
        with args.rows.open() as file:
            rows = [row for row in csv.DictReader(file) if row["cell"] == args.cell]
    only = [name for name in args.only.split(",") if name]
    for design in sorted(args.designs.glob("*.toml")):
        known = {row["effort"] for row in rows if row["design"] == design.stem}
        if only and design.stem not in only or known.issuperset(args.efforts):
            continue
        found = []
        for effort in args.efforts:
            here = limits(args.program, design, timed(effort, found), args.cell, args.limit_s)
            if here is None:
                print(f"{design.stem}: {effort} effort took more than {args.limit_s} s, left out", flush=True)
                break
            found += [{**row, "effort": effort} for row in here]
        else:
            rows += found
            if args.rows:
                new = not args.rows.exists()
                with args.rows.open("a", newline="") as file:
                    writer = csv.DictWriter(file, COLUMNS)
                    if new:
                        writer.writeheader()
                    writer.writerows(found)
    compare(args.efforts, [row for row in rows if row["effort"] in args.efforts])


if __name__ == "__main__":
    main()
