#!/usr/bin/env python3
"""Published limits of three sheets (Tang, Coros and Thomaszewski 2023) beside those of maille, like for like.

    python3 validation/published.py --program PATH [--out docs/published.md]

Each published element is a mesh. Here it is a tube about the same polygon, or a body of rings, in a design file that
this script writes. `maille limit` gives E, the largest or least Green strain along a direction, all other strains
held at 0 or, where the table says so, free; `maille roll --free width,shear` gives K, the curvature of the tightest
roll, 1 over the neutral radius. Cell 1x1 unless the table says otherwise; 8 starts for E, `--effort low` for K. The
tables are printed or, with --out, replace what stands between the two marks in that page. About 90 runs, 100 s in all.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

BEGIN = "<!-- tables made by `validation/published.py` from here on -->"
END = "<!-- tables end here -->"
SIN, COS = 0.573576, 0.819152  # the rings of European 4-in-1 lean by 35 degrees
CUT_20, CUT_13 = math.cos(math.pi / 20), math.cos(math.pi / 13)  # apothem by circumradius of a section
FOUR_RAYS = [0, 30, 45, 60, 90]
FOUR_TENSION = [0.0555, 0.0588, 0.0680, 0.0832, 0.1194]
FOUR_COMPRESSION = [0.0495, 0.0647, 0.0837, 0.1165, 0.1071]
FOUR_EXTREMES = [("maximize", "exx", 0.0556), ("maximize", "eyy", 0.1539), ("maximize", "exy", 0.1115),
                 ("minimize", "exx", -0.0498), ("minimize", "eyy", -0.1193)]
KNOT_TENSION = [(0, (0.0194, 0.0181)), (45, (0.0193,))]  # 0 degrees: along x, along y
KNOT_ROLLS = [(0, (96.4, 107.6)), (30, (37.2,)), (45, (31.1,))]
BODY = [(0, 0.0400, 16.71), (30, 0.0306, 16.70)]


def design(name: str, radius: float, a1: list[float], a2: list[float], elements: list[str]) -> str:
    head = f'schema = 1\nname = "{name}"\nunit = "mm"\nreference_radius = {radius}\n'
    lattice = f"[lattice]\na1 = {[*a1, 0.0]}\na2 = {[*a2, 0.0]}\n"
    return head + "allow_initial_overlap = true\n" + lattice + "".join("[[elements]]\n" + text for text in elements)


def four_in_one(wire: float, sides: int = 20) -> str:
    """European 4-in-1: rings whose core is a polygon with corners on 4.9 mm; sides = 0: circles."""
    angles = [2 * math.pi * k / max(sides, 1) for k in range(sides)]
    core = f"polyline = {{ points = {[[4.9 * math.cos(t), 4.9 * math.sin(t), 0.0] for t in angles]} }}"
    elements = []
    for name, center, lean in (("a", [0.0, 0.0, 0.0], SIN), ("b", [6.1, -3.0, 0.0], -SIN)):
        form = f"curves = [{{ {core}" if sides else "rings = [{ major_radius = 4.9"
        rest = f"minor_radius = {wire}, normal = [0.0, {lean}, {COS}] }}]"
        elements.append(f'name = "{name}"\ncenter = {center}\n{form}, {rest}\n')
    return design("four", 4.9, [12.2, 0.0], [0.0, 6.0], elements)


def knot_corners(sides: int) -> list[list[float]]:
    outs = [(t, 5.5 + 2.7 * math.cos(4 * t)) for t in (2 * math.pi * k / sides for k in range(sides))]
    return [[out * math.cos(t), out * math.sin(t), -2.7 * math.sin(4 * t)] for t, out in outs]


def sharpest_turn(points: list[list[float]]) -> float:
    corners = zip(points[-1:] + points, points, points[1:] + points[:1])
    return max(math.acos(sum((q - p) * (s - q) for p, q, s in zip(a, b, c)) / math.dist(a, b) / math.dist(b, c))
               for a, b, c in corners)


def knot(wire: float, sides: int = 40) -> str:
    """The (1, 4) torus knot as a polygon; sides = 0: the smooth curve."""
    smooth, step = "torus_knot = { p = 1, q = 4, R = 5.5, a = 2.7 }", 38.5 / 3
    form = f"polyline = {{ points = {knot_corners(sides)} }}" if sides else smooth
    text = f'name = "knot"\ncenter = [0.0, 0.0, 0.0]\ncurves = [{{ {form}, minor_radius = {wire} }}]\n'
    return design("knot", 5.5, [step, 0.0], [0.0, step], [text])


def circles(half_width: float, half_height: float, count: int = 7) -> list[tuple[float, float]]:
    """Heights and radii of circles in the ellipse of a section: its widest ones, up to that of its top's curvature."""
    square = half_height**2 - half_width**2
    heights = [square / half_height * (2 * k / (count - 1) - 1) for k in range(count)]
    return [(h, half_width * math.sqrt(1 - h * h / square)) for h in heights]


def body(half_width: float) -> str:
    """A flat ring and three standing ones, welded; the nearest bodies are at 30, 90 ... degrees from x."""
    rings = [f"{{ major_radius = 4.25, minor_radius = {r}, normal = [0.0, 0.0, 1.0], offset = [0.0, 0.0, {h}] }}"
             for h, r in circles(half_width, 1.5)]
    for degrees in (30, 150, 270):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        for h, r in circles(half_width, 1.4):
            place = f"normal = [{-s}, {c}, 0.0], offset = [{6.8 * c - h * s}, {6.8 * s + h * c}, 0.0]"
            rings.append(f"{{ major_radius = 2.6, minor_radius = {r}, {place} }}")
    a1, a2 = ([11.075 * math.cos(t), 11.075 * math.sin(t)] for t in (math.pi / 6, math.pi / 2))
    return design("body", 4.25, a1, a2, [f'name = "body"\ncenter = [0.0, 0.0, 0.0]\nrings = [{", ".join(rings)}]\n'])


class Program:
    def __init__(self, path: str, folder: str) -> None:
        self.path, self.folder = path, Path(folder)

    def answer(self, command: str, text: str, *words: object) -> dict:
        file = self.folder / "design.toml"
        file.write_text(text)
        line = [self.path, command, file, "--json", *map(str, words)]
        try:
            run = subprocess.run(line, capture_output=True, text=True, timeout=120, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise SystemExit(f"{self.path} {command}: {error}") from error
        if run.returncode:
            raise SystemExit(f"{' '.join(map(str, line))} ended with {run.returncode}: {run.stderr.strip()}")
        print(".", end="", file=sys.stderr, flush=True)
        return json.loads(run.stdout)

    def strain(self, text: str, angle: int = 0, sign: str = "maximize", cell: str = "1x1", strain: str = "exx",
               free: str = "") -> float:
        words = ["--" + sign, strain, "--direction", angle, "--cell", cell, "--starts", 8]
        return self.answer("limit", text, *words, *["--free", free] * bool(free))["value"]

    def rolls(self, text: str, angles: list[int]) -> dict[tuple[float, str], float]:
        words = ["--directions", ",".join(map(str, angles)), "--free", "width,shear", "--effort", "low"]
        rolls = self.answer("roll", text, *words, "--overwrite", "--out", self.folder / "roll")["rolls"]
        return {(roll["direction_deg"], roll["axis"]): 1e3 / roll["neutral_radius"] for roll in rolls}


def table(head: str, rows: list[list[str]]) -> str:
    lines = ["| " + " | ".join(row).replace("-", "−") + " |" for row in rows]
    return "\n".join([head, "|" + " --- |" * len(rows[0]), *lines])


def four_rows(program: Program) -> list[list[str]]:
    alike, thin, thick = (four_in_one(1.15 * cut) for cut in (CUT_20, CUT_20**2, 1.0))
    smooth, rows = four_in_one(1.15, 0), []

    def row(name: str, published: float, cell: str = "1x1", **question: object) -> None:
        ours = [program.strain(text, cell=cell, **question) for text in (alike, thick, thin, smooth)]
        rows.append([name, f"{published:.4f}", f"{ours[0]:.4f}", f"{published / ours[0]:.2f}",
                     f"{ours[1]:.4f} to {ours[2]:.4f}", f"{ours[3]:.4f}", f"{ours[3] / published:.2f}"])

    for angle, published in zip(FOUR_RAYS, FOUR_TENSION):
        row(f"largest E, {angle}°", published, angle=angle)
    for angle, published in zip(FOUR_RAYS, FOUR_COMPRESSION):
        row(f"least E, {angle}°", -published, angle=angle, sign="minimize")
        if angle in (0, 30):
            row(f"least E, {angle}°, cell 2x1", -published, angle=angle, sign="minimize", cell="2x1")
    for sign, strain, published in FOUR_EXTREMES:
        word = "largest" if sign == "maximize" else "least"
        others = ",".join(other for other in ("exx", "eyy", "exy") if other != strain)
        row(f"{word} {strain}, others free", published, sign=sign, strain=strain, free=others)
    return rows


def knot_rows(program: Program) -> list[list[str]]:
    cut = math.cos(sharpest_turn(knot_corners(40)) / 2)
    texts = [knot(1.5 * CUT_13), knot(1.5), knot(1.5 * CUT_13 * cut), knot(1.5, 0)]
    rolled = [program.rolls(text, [angle for angle, _ in KNOT_ROLLS]) for text in texts]
    quantities = [(f"largest E, {angle}°", published, ".4f", [program.strain(text, angle) for text in texts])
                  for angle, published in KNOT_TENSION]
    quantities += [(f"K in 1/m, {angle}°, axis {side}", published, ".1f", [roll[angle, side] for roll in rolled])
                   for side in ("below", "above") for angle, published in KNOT_ROLLS if side == "below" or angle == 30]
    rows = []
    for name, published, form, ours in quantities:
        alike, thick, thin, smooth = (format(value, form) for value in ours)
        ratios = ", ".join(f"{value / ours[0]:.2f}" for value in published)
        theirs = ", ".join(format(value, form) for value in published)
        rows.append([name, theirs, alike, ratios, f"{thick} to {thin}", smooth])
    return rows


def body_rows(program: Program) -> list[list[str]]:
    texts = [body(half) for half in (0.95, 1.0, 1.05)]
    rolled = [program.rolls(text, [0, 30]) for text in texts]
    rows = [[f"largest E, {angle}°", f"{published:.4f}", *(f"{program.strain(text, angle):.4f}" for text in texts)]
            for angle, published, _ in BODY]
    return rows + [[f"K in 1/m, {angle}°", f"{published:.1f}", *(f"{roll[angle, 'below']:.1f}" for roll in rolled)]
                   for angle, _, published in BODY]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", type=Path, help="the page whose tables are made anew")
    args = parser.parse_args()
    page = args.out.read_text(encoding="utf-8") if args.out else f"{BEGIN}\n{END}\n"
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise SystemExit(f"{args.out} needs both lines, in this order:\n{BEGIN}\n{END}")
    with tempfile.TemporaryDirectory() as folder:
        program = Program(args.program, folder)
        heads = "| published | ours, like for like | published / ours | bracket |"
        four = table(f"| European 4-in-1 {heads} round wire | round / published |", four_rows(program))
        knots = table(f"| (1, 4) torus knot {heads} smooth knot |", knot_rows(program))
        bodies = table("| three-fold body | published | half width 0.95 mm | 1.00 mm | 1.05 mm |", body_rows(program))
    text = f"{before}{BEGIN}\n\n{four}\n\n{knots}\n\n{bodies}\n\n{END}{after}"
    print(file=sys.stderr)
    if args.out is None:
        print(text)
    else:
        new = args.out.with_name(args.out.name + ".new")
        new.write_text(text, encoding="utf-8")
        new.replace(args.out)


if __name__ == "__main__":
    main()
