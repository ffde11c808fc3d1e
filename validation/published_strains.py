#!/usr/bin/env python3
"""Whether European 4-in-1 (R 4.9, r 1.15, cell 12.2 by 6.0 mm) has states at three published Green strains.

    python3 validation/published_strains.py PROGRAM [--copies 6] [--starts 16]

The lattice is held at the strain, and `maille tightest` seeks the thickest wire, in every cell of up to that many copies.
A state of the design exists where that is 1.15 mm or more. Prints the best cells of each strain.
"""

import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

STRAINS = [(-0.0271, -0.0874, -0.0543), (-0.0497, -0.0032, 0.0), (-0.0245, -0.1005, -0.0433)]
WIRE_MM, SIN, COS = 1.15, 0.573576, 0.819152


def design(strain: tuple[float, float, float], cell: tuple[int, int, int]) -> str:
    """The rings of the built-in design, moved with the lattice; the cell has a1' = n a1, a2' = k a1 + m a2."""
    exx, eyy, exy = strain
    f11 = math.sqrt(1.0 + 2.0 * exx)
    f12 = 2.0 * exy / f11
    f22 = math.sqrt(1.0 + 2.0 * eyy - f12 * f12)
    n, k, m = cell

    def at(x: float, y: float) -> str:
        return f"[{f11 * x + f12 * y!r}, {f22 * y!r}, 0.0]"

    text = f"""schema = 1
name = "strained"
unit = "mm"
minor_radius = {WIRE_MM}
reference_radius = 4.9
allow_initial_overlap = true
[lattice]
a1 = {at(12.2 * n, 0.0)}
a2 = {at(12.2 * k, 6.0 * m)}
"""
    for i in range(n):
        for j in range(m):
            for name, x, y, lean in (("a", 0.0, 0.0, SIN), ("b", 6.1, -3.0, -SIN)):
                center = at(x + 12.2 * i, y + 6.0 * j)
                rings = f"[{{ major_radius = 4.9, normal = [0.0, {lean}, {COS}] }}]"
                text += f'[[elements]]\nname = "{name}{i}{j}"\ncenter = {center}\nrings = {rings}\n'
    return text


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--copies", type=int, default=6)
    parser.add_argument("--starts", type=int, default=16)
    args = parser.parse_args()
    cells = [(n, k, m) for m in range(1, args.copies + 1) for n in range(1, args.copies // m + 1) for k in range(n)]
    with tempfile.TemporaryDirectory() as folder:
        for strain in STRAINS:
            found = []
            for cell in cells:
                file = Path(folder) / "strained.toml"
                file.write_text(design(strain, cell))
                command = [args.program, "tightest", file, "--lattice", "fixed", "--starts", str(args.starts), "--json"]
                answer = json.loads(subprocess.run(command, check=False, capture_output=True, text=True).stdout)
                if answer["status"] == "local":
                    found.append((answer["sizes"][0]["minor_radius"], cell))
            found.sort(reverse=True)
            best = ", ".join(f"{wire:.6f} ({n},0;{k},{m})" for wire, (n, k, m) in found[:4])
            print(f"{strain}: {len(found)} of {len(cells)} cells certified; thickest wire in mm: {best}", flush=True)


if __name__ == "__main__":
    main()
