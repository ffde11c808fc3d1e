#!/usr/bin/env python3
"""How often more effort beats less: the same limits of random designs at two efforts.

    cargo run --release -p maille-io --example random_designs -- --seed 22 --count 60 --doubled 0 DESIGNS
    python3 validation/effort.py PROGRAM DESIGNS [--efforts normal thorough] [--cell 1x1]

Three directions and three l2 of each design. Prints how many rows the second effort raises, and by how much.
"""

import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

QUESTION = ["--directions", "10,70,130", "--l2=-0.1,0,0.05", "--quiet"]


def limits(program: str, design: Path, effort: str, cell: str, out: Path) -> dict[tuple[str, str], dict[str, str]]:
    command = [program, "characterize", str(design), *QUESTION, "--cell", cell, "--effort", effort]
    # 5: some limits were not found.
    code = subprocess.run([*command, "--out", str(out)], check=False).returncode
    if code not in (0, 5):
        raise SystemExit(f"{' '.join(command)} ended with {code}")
    with (out / "limits.csv").open() as file:
        return {(row["direction_deg"], row["l2"]): row for row in csv.DictReader(file)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("designs", type=Path)
    parser.add_argument("--efforts", nargs=2, default=["normal", "thorough"])
    parser.add_argument("--cell", default="1x1")
    args = parser.parse_args()
    rows, raised, wall_s = 0, [], [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        for design in sorted(args.designs.glob("*.toml")):
            less, more = (
                limits(args.program, design, effort, args.cell, Path(folder) / effort / design.stem)
                for effort in args.efforts
            )
            for key, row in less.items():
                rows += 1
                other = more[key]
                wall_s = [wall_s[0] + float(row["wall_s"]), wall_s[1] + float(other["wall_s"])]
                gain = float(other["l1"] or "-inf") - float(row["l1"] or "-inf")
                if gain > 1e-6:
                    raised.append(gain)
                    print(f"{design.stem} {key[0]}° l2 {key[1]}: {row['l1']} {other['l1']} (chance {row['better_chance']})")
    large = sum(gain > 1e-3 for gain in raised)
    print(f"{rows} rows; {args.efforts[1]} beats {args.efforts[0]} at {len(raised)}, by more than 1e-3 at {large}")
    print(f"seconds: {wall_s[0]:.1f} {wall_s[1]:.1f}")


if __name__ == "__main__":
    main()
