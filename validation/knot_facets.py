"""Limits of the (1, 4) torus-knot sheet of Tang, Coros and Thomaszewski (2023) as a polygon of n segments, and as biarcs.

    python validation/knot_facets.py target/release/maille

Prints the gap at rest and the largest Green strain along x, all others held at 0, in the written cell.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

HEAD = """schema = 1
name = "knot"
unit = "mm"
minor_radius = 1.5
reference_radius = 5.5
[lattice]
a1 = [12.833333333333334, 0.0, 0.0]
a2 = [0.0, 12.833333333333334, 0.0]
[[elements]]
name = "knot"
center = [0.0, 0.0, 0.0]
"""


def corner(t):
    out = 5.5 + 2.7 * math.cos(4 * t)
    return [out * math.cos(t), out * math.sin(t), -2.7 * math.sin(4 * t)]


def measured(program, curve):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "knot.toml"
        file.write_text(HEAD + f"curves = [{curve}]\n")
        run = lambda *words: subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout
        gap = next(line for line in run("inspect", file).splitlines() if line.startswith("smallest gap"))
        limit = run("limit", file, "--maximize", "exx", "--cell", "1x1").splitlines()
        strain = next(line for line in limit if line.strip().startswith("exx"))
        return gap.split()[2], strain.split()[1], limit[0].rsplit(" ", 1)[1]


def main():
    program = sys.argv[1]
    print("segments  gap at rest  exx       status")
    for n in [40, 41, 60, 80, 120, 160, 240, 320]:
        points = [corner(2 * math.pi * k / n) for k in range(n)]
        print(f"{n:8}", *measured(program, f"{{ polyline = {{ points = {points} }} }}"), flush=True)
    print("  biarcs", *measured(program, "{ torus_knot = { p = 1, q = 4, R = 5.5, a = 2.7 } }"), flush=True)


if __name__ == "__main__":
    main()
