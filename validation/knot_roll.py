"""The tightest rolls of a sheet of (1, 4) torus knots with straight sides, by `maille roll` and by a search that shares nothing with it.

    python3 knot_roll.py [--sides 40] [--directions 0,30,45,60,90] [--free] [--shear lines|symmetric] [--starts 8] [--maille maille]

Needs numpy and scipy. The sheet is that of Tang, Coros and Thomaszewski (2023): R 5.5, a 2.7, wire 1.5, square lattice of 38.5/3, all mm. The search
is a sequence of linear programs (HiGHS) in a trust region, from the flat sheet and from states that are pushed at random; all pairs of sides of a
knot and of twelve images near it are gaps, each found by the nearest points of two segments. Turns are given for each unit of the written
length along the direction; the height is free, and with --free the width and the shear, too. `--shear symmetric` leans both ways by half, so that the axis
turns against the lattice: lines along the axis no longer stay along it, and `maille roll` has no such shear. Printed: curvatures in 1/m of `maille roll`
(axis below), and of the starts; linking numbers are checked in each.
"""
import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from roll_two_ways import W, rotation, solve

R, A, WIRE, LATTICE = 5.5, 2.7, 1.5, 38.5 / 3
IMAGES = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 0), (0, 2), (2, 1), (1, 2), (2, -1), (1, -2), (2, 2), (2, -2)]
# Half widths of a trust region of size 1: curvature, width, shear, height, turn.
SIZES = np.array([0.02, 1, 1, R, 1, 1, 1.0])


def knot(sides):
    t = 2 * np.pi * np.arange(sides) / sides
    out = R + A * np.cos(4 * t)
    return np.stack([out * np.cos(t), out * np.sin(t), -A * np.sin(4 * t)], 1)


def nearest(p, q):
    """The nearest points of all pairs of sides of two polygons."""
    p0, q0 = p[:, None], q[None]
    along, other, way = np.roll(p, -1, 0)[:, None] - p0, np.roll(q, -1, 0)[None] - q0, p0 - q0
    a, e, b = (along * along).sum(-1), (other * other).sum(-1), (along * other).sum(-1)
    c, f = (along * way).sum(-1), (other * way).sum(-1)
    crossed = a * e - b * b
    s = np.clip(np.where(crossed > 1e-12 * a * e, (b * f - c * e) / np.maximum(crossed, 1e-300), 0.5), 0, 1)
    t = np.clip((b * s + f) / e, 0, 1)
    s = np.clip((b * t - c) / a, 0, 1)
    t = np.clip((b * s + f) / e, 0, 1)
    return p0 + np.clip((b * t - c) / a, 0, 1)[..., None] * along, q0 + t[..., None] * other


def linking(p, q):
    """The linking number of two polygons: solid angles of the parallelograms of their sides."""
    p1, q1 = np.roll(p, -1, 0)[:, None], np.roll(q, -1, 0)[None]
    p0, q0 = p[:, None], q[None]
    corners = [p0 - q0, p0 - q1, p1 - q1, p1 - q0]

    def solid(a, b, c):
        na, nb, nc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
        below = na * nb * nc + (a * b).sum(-1) * nc + (b * c).sum(-1) * na + (c * a).sum(-1) * nb
        return 2 * np.arctan2((a * np.cross(b, c)).sum(-1), below)

    a, b, c, d = corners
    return round(float((solid(a, b, c) + solid(c, d, a)).sum() / (4 * np.pi)))


class Sheet:
    """Images along and across the direction; `leans` is the part of the shear that turns the axis against the lattice."""

    def __init__(self, direction_deg, leans):
        t = np.radians(direction_deg)
        a1, a2 = LATTICE * np.array([np.cos(t), -np.sin(t)]), LATTICE * np.array([np.sin(t), np.cos(t)])
        self.images = [i * a1 + j * a2 for i, j in IMAGES]
        self.into = np.array([[np.cos(t), np.sin(t), 0], [-np.sin(t), np.cos(t), 0], [0, 0, 1]])
        self.leans = leans


class State:
    """A knot over the axis, the turn for each length, the strain and the shear along the axis."""

    def __init__(self, knot, height, turn, kappa, l2=0.0, gamma=0.0):
        self.knot, self.height, self.turn, self.kappa, self.l2, self.gamma = knot, height, turn, kappa, l2, gamma
        self.points = knot @ turn.T + [0, 0, height]
        self.axis = np.array([0, 0, -1 / kappa])

    def moved(self, x):
        return State(self.knot, self.height + x[3], rotation(x[4:]) @ self.turn, self.kappa + x[0], self.l2 + x[1], self.gamma + x[2])

    def image(self, sheet, u, w):
        """The turn about the axis, the shift along it, and the knot in the image."""
        about = rotation(W * self.kappa * (u + sheet.leans * self.gamma * w))
        shift = ((1 + self.l2) * w + (1 - sheet.leans) * self.gamma * u) * W
        return about, shift, (self.points - self.axis) @ about.T + self.axis + shift

    def rows(self, sheet, margin):
        """Gaps below `margin` and their derivatives by curvature, width, shear, height, turn."""
        gaps, jacobians = [np.zeros(0)], [np.zeros((0, 7))]
        for u, w in sheet.images:
            about, shift, image = self.image(sheet, u, w)
            if np.linalg.norm(self.points.mean(0) - image.mean(0)) > 2 * (R + A + WIRE) + margin:
                continue
            xa, xb = nearest(self.points, image)
            between = xa - xb
            distance = np.linalg.norm(between, axis=-1)
            near = np.nonzero(distance - 2 * WIRE < margin)
            xa, xb, distance = xa[near], xb[near], distance[near]
            n = between[near] / np.maximum(distance, 1e-12)[:, None]
            jacobian = np.zeros((len(n), 7))
            turns, lifts = np.cross(W, xb - self.axis), np.array([0, 0, 1 / self.kappa ** 2])
            jacobian[:, 0] = -(n * ((u + sheet.leans * self.gamma * w) * turns + lifts - about @ lifts)).sum(1)
            jacobian[:, 1] = -w * n[:, 1]
            jacobian[:, 2] = -(1 - sheet.leans) * u * n[:, 1] - sheet.leans * w * self.kappa * (n * turns).sum(1)
            back = n @ about
            jacobian[:, 3] = n[:, 2] - back[:, 2]
            center = np.array([0, 0, self.height])
            arm = (xb - self.axis - shift) @ about + self.axis - center
            jacobian[:, 4:] = np.cross(xa - center, n) - np.cross(arm, back)
            gaps.append(distance - 2 * WIRE)
            jacobians.append(jacobian)
        return np.concatenate(gaps), np.concatenate(jacobians)

    def links(self, sheet):
        return [linking(self.points, self.image(sheet, u, w)[2]) for u, w in sheet.images]


def climbed(sheet, state, objective, free, steps, weight):
    return solve(sheet, state, objective, free, steps, weight, trust=0.03, sizes=SIZES, least=0.001, margin=6 * R, enough=1e-13)


def search(sheet, polygon, free, starts, seed):
    """The curvatures of states without overlap and with the links of the flat sheet, in 1/m, the largest first."""
    rng = np.random.default_rng(seed)
    linked = State(polygon, 0.0, np.eye(3), 1e-3).links(sheet)
    out = []
    for k in range(starts):
        state = State(polygon, 0.0, np.eye(3), rng.uniform(0.001, 0.006))
        if k:
            push = rng.normal(size=7) * [0, 1, 1, R, 1, 1, 1]
            state = climbed(sheet, state, push, free, int(rng.integers(2, 12)), 10.0)
        for weight in (0.1, 1.0, 10.0):
            state = state and climbed(sheet, state, np.eye(7)[0], free, 300, weight)
        if state and state.rows(sheet, 0.1)[0].min() > -1e-6 and state.links(sheet) == linked:
            out.append(1e3 * state.kappa)
    return sorted(out, reverse=True)


def by_maille(maille, polygon, directions, free):
    points = ", ".join(f"[{x:.15f}, {y:.15f}, {z:.15f}]" for x, y, z in polygon)
    design = f"""schema = 1
name = "knot"
unit = "mm"
minor_radius = {WIRE}
reference_radius = {R}
lattice = {{ a1 = [{LATTICE!r}, 0.0, 0.0], a2 = [0.0, {LATTICE!r}, 0.0] }}
elements = [{{ name = "knot", center = [0.0, 0.0, 0.0], curves = [{{ polyline = {{ points = [{points}] }} }}] }}]
"""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "knot.toml"
        file.write_text(design)
        command = [maille, "roll", file, "--directions", directions, "--axis", "below", "--json", "--out", Path(folder) / "roll"]
        found = subprocess.run(command + ["--free", "width,shear"] * free, check=True, capture_output=True, text=True)
    # In the file's unit, 1/mm.
    return {roll["direction_deg"]: 1e3 * roll["curvature"] for roll in json.loads(found.stdout)["rolls"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sides", type=int, default=40)
    parser.add_argument("--directions", default="0,30,45,60,90")
    parser.add_argument("--free", action="store_true", help="leave width and shear free, too")
    parser.add_argument("--shear", choices=["lines", "symmetric"], default="lines")
    parser.add_argument("--starts", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--maille", default="maille")
    arguments = parser.parse_args()
    polygon = knot(arguments.sides)
    rolls = by_maille(arguments.maille, polygon, arguments.directions, arguments.free)
    print("direction   maille  of starts   alike")
    for direction in map(float, arguments.directions.split(",")):
        sheet = Sheet(direction, 0.5 if arguments.shear == "symmetric" else 0.0)
        found = search(sheet, polygon @ sheet.into.T, arguments.free, arguments.starts, arguments.seed)
        best = max(found, default=float("nan"))
        alike = sum(value > best * (1 - 1e-4) for value in found)
        print(f"{direction:9g} {rolls[direction]:8.4f} {best:10.4f} {alike:3} / {arguments.starts}", flush=True)


main()
