"""The tightest roll of a sheet of single rings, by `maille roll` and by a search that shares nothing with it.

    python3 roll_two_ways.py DESIGN.toml [--directions 0,30,60,90] [--free] [--starts 12] [--seed 1] [--maille maille]

Directions are multiples of 7.5, as `maille roll` is asked for all of these: they hand their states on. Needs numpy and
scipy. Here the rings lie in coordinates about the axis, so there is no curvature to let go to zero and no gauge;
distances are found by sampling one circle, exact to the other, and golden sections; the search is a sequence of
linear programs (HiGHS) in a trust region, from the flat sheet and from random states. Which pairs count is as in
docs/theory/roll.md. Printed for each direction: the curvature, in 1/R, of `maille roll` (axis
below), of the best of the random starts, how many starts came within 1e-4 of that, and the curvature that linear
programs reach from the state of the record. Links and the side of the axis are checked in every result.
"""
import argparse
import json
import subprocess
import tempfile
import tomllib
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

SAMPLES = 96
W = np.array([0.0, 1.0, 0.0])


def turn(angle):
    """Rotations about the axis, y, that take z to x."""
    c, s, o, i = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.moveaxis(np.array([[c, o, s], [o, i, o], [-s, o, c]]), (0, 1), (-2, -1))


def rotation(v):
    """The rotation matrix of a rotation vector."""
    t = np.linalg.norm(v)
    k = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + np.sinc(t / np.pi) * k + 0.5 * np.sinc(t / 2 / np.pi) ** 2 * k @ k


def frame_of(normal):
    """A rotation whose third column is the normal."""
    n = np.asarray(normal, float) / np.linalg.norm(normal)
    a = np.cross(n, np.eye(3)[np.argmin(abs(n))])
    a /= np.linalg.norm(a)
    return np.stack([a, np.cross(n, a), n], axis=1)


class Sheet:
    """Rings of one cell, the lattice along and across the direction, lengths in the first major radius."""

    def __init__(self, path, direction_deg):
        design = tomllib.loads(Path(path).read_text())
        rings = [element["rings"][0] for element in design["elements"]]
        if any(len(element["rings"]) != 1 for element in design["elements"]):
            raise SystemExit("each element must be one ring")
        unit = design["reference_radius"]
        t = np.radians(direction_deg)
        into = np.array([[np.cos(t), np.sin(t), 0], [-np.sin(t), np.cos(t), 0], [0, 0, 1]])
        self.names = [element["name"] for element in design["elements"]]
        self.major = np.array([ring["major_radius"] for ring in rings]) / unit
        self.minor = np.array([ring.get("minor_radius", design["minor_radius"]) for ring in rings]) / unit
        self.centers = np.array([into @ element["center"] for element in design["elements"]]) / unit
        self.frames = np.array([frame_of(into @ ring["normal"]) for ring in rings])
        self.cell = np.array([into @ design["lattice"][key] for key in ("a1", "a2")])[:, :2] / unit
        self.pairs = self.counting()

    def counting(self):
        """Pairs (e, f, shift along u, shift along w), each once, with the distance along u and whether links join them."""
        span = range(-6, 7)
        n = len(self.major)
        found = [(e, f, i, j) for i in span for j in span for e in range(n) for f in range(n)
                 if (i, j) > (0, 0) or ((i, j) == (0, 0) and e < f)]
        reach = 2 * self.major.max() + 2 * self.minor.max()
        shift = np.array([[i, j] for _, _, i, j in found]) @ self.cell
        e, f = np.array([p[:2] for p in found]).T
        between = self.centers[f] + np.pad(shift, ((0, 0), (0, 1))) - self.centers[e]
        near = np.linalg.norm(between, axis=1) < reach
        linked = np.zeros(len(found), bool)
        linked[near] = crossings(self.centers[e[near]], self.frames[e[near]], self.major[e[near]],
                                 self.centers[f[near]] + np.pad(shift[near], ((0, 0), (0, 1))), self.frames[f[near]],
                                 self.major[f[near]]) % 2 == 1
        one = {p for p, is_linked in zip(found, linked) if is_linked}
        one |= {(f, e, -i, -j) for e, f, i, j in one}
        two = {(e, g, i + k, j + l) for e, f, i, j in one for f2, g, k, l in one if f == f2}
        joined = np.array([p in one or p in two for p in found])
        return {"e": e, "f": f, "u": shift[:, 0], "w": shift[:, 1], "along": np.abs(between[:, 0]), "joined": joined,
                "linked": linked}


def crossings(ca, fa, ra, cb, fb, rb):
    """How often the circles b go through the discs of the circles a."""
    n = fa[:, :, 2]
    p, q = rb * np.einsum("ij,ij->i", n, fb[:, :, 0]), rb * np.einsum("ij,ij->i", n, fb[:, :, 1])
    height = np.einsum("ij,ij->i", n, cb - ca)
    amplitude, phase = np.hypot(p, q), np.arctan2(q, p)
    ratio = np.where(amplitude > 0, -height / np.maximum(amplitude, 1e-300), 2.0)
    count = np.zeros(len(ra), int)
    for sign in (-1, 1):
        s = phase + sign * np.arccos(np.clip(ratio, -1, 1))
        point = cb + rb[:, None] * (np.cos(s)[:, None] * fb[:, :, 0] + np.sin(s)[:, None] * fb[:, :, 1])
        count += (abs(ratio) < 1) & (np.linalg.norm(point - ca, axis=1) < ra)
    return count


def to_circle(x, c, f, r):
    """The nearest points of circles to points x of shape (pairs, samples, 3)."""
    d = x - c[:, None]
    flat = d - np.einsum("psi,pi->ps", d, f[:, :, 2])[..., None] * f[:, None, :, 2]
    length = np.linalg.norm(flat, axis=-1, keepdims=True)
    aside = np.where(length > 1e-12, flat / np.maximum(length, 1e-300), f[:, None, :, 0])
    return c[:, None] + r[:, None, None] * aside


def minima(ca, fa, ra, cb, fb, rb):
    """(pair, point of a, point of b) of all local minima of the distances of circles."""
    def point(s, k):
        return ca[k, None] + ra[k, None, None] * (np.cos(s)[..., None] * fa[k, None, :, 0] + np.sin(s)[..., None] * fa[k, None, :, 1])

    def distance(s, k):
        x = point(s, k)
        return np.linalg.norm(x - to_circle(x, cb[k], fb[k], rb[k]), axis=-1)

    step = 2 * np.pi / SAMPLES
    every = np.arange(len(ra))
    d = distance(np.tile(np.arange(SAMPLES) * step, (len(ra), 1)), every)
    pair, sample = np.nonzero((d <= np.roll(d, 1, 1)) & (d < np.roll(d, -1, 1)))
    low, high = ((sample + side) * step for side in (-1, 1))
    golden = (np.sqrt(5) - 1) / 2
    for _ in range(42):
        left, right = high - golden * (high - low), low + golden * (high - low)
        less = distance(left[:, None], pair)[:, 0] < distance(right[:, None], pair)[:, 0]
        low, high = np.where(less, low, left), np.where(less, right, high)
    x = point((low + high)[:, None] / 2, pair)
    return pair, x[:, 0], to_circle(x, cb[pair], fb[pair], rb[pair])[:, 0]


class State:
    """Centres and frames about the axis, the turn for each length, the strain and the shear along the axis."""

    def __init__(self, centers, frames, kappa, l2=0.0, gamma=0.0):
        self.centers, self.frames, self.kappa, self.l2, self.gamma = centers, frames, kappa, l2, gamma
        self.angles = np.arctan2(centers[:, 0], centers[:, 2])

    def moved(self, x):
        """The state after a step (curvature, l2, gamma, then shift and turn of each ring)."""
        steps = x[3:].reshape(-1, 6)
        kappa = self.kappa + x[0]
        # With the curvature the rings move on and towards the axis, as a sheet of one length does.
        further, out = self.angles * x[0] / self.kappa, 1 / kappa - 1 / self.kappa
        about = turn(further)
        centers = np.einsum("eij,ej->ei", about, self.centers + out * self.outward())
        frames = np.array([rotation(step[3:]) @ frame for step, frame in zip(steps, about @ self.frames)])
        after = State(centers + steps[:, :3], frames, kappa, self.l2 + x[1], self.gamma + x[2])
        change = after.angles - self.angles
        after.angles = self.angles + (change + np.pi) % (2 * np.pi) - np.pi  # without whole turns
        return after

    def outward(self):
        return self.centers * [1, 0, 1] / np.hypot(self.centers[:, 0], self.centers[:, 2])[:, None]

    def image(self, sheet, k):
        p = sheet.pairs
        about = turn(self.kappa * p["u"][k])
        shift = (1 + self.l2) * p["w"][k] + self.gamma * p["u"][k]
        f = p["f"][k]
        return about, np.einsum("pij,pj->pi", about, self.centers[f]) + shift[:, None] * W, about @ self.frames[f]

    def counted(self, sheet):
        return sheet.pairs["joined"] | (abs(self.kappa) * sheet.pairs["along"] <= np.pi)

    def rows(self, sheet, margin):
        """Gaps of all minima below `margin`, and their derivatives by a step."""
        p = sheet.pairs
        k = np.nonzero(self.counted(sheet))[0]
        about, centers, frames = self.image(sheet, k)
        e, f = p["e"][k], p["f"][k]
        wires = sheet.minor[e] + sheet.minor[f]
        near = np.linalg.norm(self.centers[e] - centers, axis=1) < sheet.major[e] + sheet.major[f] + wires + margin
        k, about, centers, frames, e, f, wires = (v[near] for v in (k, about, centers, frames, e, f, wires))
        pair, xa, xb = minima(self.centers[e], self.frames[e], sheet.major[e], centers, frames, sheet.major[f])
        between = xa - xb
        distance = np.linalg.norm(between, axis=1)
        gap = distance - wires[pair]
        keep = gap < margin
        pair, xa, xb, gap = pair[keep], xa[keep], xb[keep], gap[keep]
        normal = between[keep] / np.maximum(distance[keep], 1e-12)[:, None]
        jacobian = np.zeros((len(gap), 3 + 6 * len(self.centers)))
        at = np.arange(len(gap))
        u, w = p["u"][k][pair], p["w"][k][pair]
        jacobian[:, 0] = -u * np.einsum("ij,ij->i", normal, np.cross(W, xb))
        jacobian[:, 1], jacobian[:, 2] = -w * normal[:, 1], -u * normal[:, 1]
        back = np.einsum("pji,pj->pi", about[pair], normal)  # the normal as the ring in the cell sees it
        arm_b = np.einsum("pji,pj->pi", about[pair], xb - centers[pair])
        for i in range(3):
            np.add.at(jacobian, (at, 3 + 6 * e[pair] + i), normal[:, i])
            np.add.at(jacobian, (at, 6 + 6 * e[pair] + i), np.cross(xa - self.centers[e[pair]], normal)[:, i])
            np.add.at(jacobian, (at, 3 + 6 * f[pair] + i), -back[:, i])
            np.add.at(jacobian, (at, 6 + 6 * f[pair] + i), -np.cross(arm_b, back)[:, i])
        on = (self.angles / self.kappa)[:, None]
        carried = np.hstack([on * np.cross(W, self.centers) - self.outward() / self.kappa ** 2, on * W])
        jacobian[:, 0] += jacobian[:, 3:] @ carried.ravel()
        return gap, jacobian

    def valid(self, sheet):
        """The links are those of the flat sheet, and linked rings that the axis passes by are less than half a turn apart."""
        p = sheet.pairs
        k = np.nonzero(self.counted(sheet))[0]
        _, centers, frames = self.image(sheet, k)
        e, f = p["e"][k], p["f"][k]
        linked = crossings(self.centers[e], self.frames[e], sheet.major[e], centers, frames, sheet.major[f]) % 2 == 1
        apart = abs(self.angles[f] + self.kappa * p["u"][k] - self.angles[e])
        passed = np.hypot(self.centers[:, 0], self.centers[:, 2]) > sheet.major + sheet.minor
        asked = p["linked"][k] & passed[e] & passed[f]
        return np.array_equal(linked, p["linked"][k]) and bool(np.all(apart[asked] < np.pi))


def solve(sheet, state, objective, free, steps, weight=10.0, trust=0.1, sizes=1.0, least=0.01, margin=2.5, enough=1e-12):
    """Maximises the step along `objective` less `weight` times the deepest overlap, by linear programs.

    Steps are within `trust` times `sizes`, the curvature stays above `least`, gaps below `margin` times `trust` are rows, and a step that promises
    less than `enough` is the last.
    """
    size = len(objective)
    widths = np.ones(size) * sizes
    widths[1:3] *= free

    def merit(value, gaps):
        return value - weight * np.maximum(-gaps, 0).max(initial=0)

    gap, jacobian = state.rows(sheet, margin * trust)
    for _ in range(steps):
        bounds = [(-trust * width, trust * width) for width in widths] + [(0, None)]
        bounds[0] = (max(bounds[0][0], least - state.kappa), bounds[0][1])
        found = linprog(np.append(-objective, weight), A_ub=np.hstack([-jacobian, -np.ones((len(gap), 1))]), b_ub=gap,
                        bounds=bounds, method="highs")
        if found.x is None:
            return None
        promise = objective @ found.x[:-1] - merit(0.0, gap) - weight * found.x[-1]
        after = state.moved(found.x[:-1])
        after_rows = after.rows(sheet, margin * trust)
        gained = merit(objective @ found.x[:-1], after_rows[0]) - merit(0.0, gap)
        if gained > 0.1 * promise:
            state, (gap, jacobian) = after, after_rows
            trust = min(trust * (1.5 if gained > 0.7 * promise else 1.0), 0.15)
        else:
            trust *= 0.4
        if trust < 1e-9 or promise < enough:
            break
    return state


def random_start(sheet, rng, free):
    """The flat sheet on a cylinder, or a state pushed along a random direction from there."""
    kappa = 0.02 * np.exp(rng.uniform(0, 2))
    angle = kappa * sheet.centers[:, 0]
    about = turn(angle)
    radius = sheet.centers[:, 2] + 1 / kappa
    centers = np.stack([radius * np.sin(angle), sheet.centers[:, 1], radius * np.cos(angle)], 1)
    state = State(centers, about @ sheet.frames, kappa)
    push = rng.normal(size=3 + 6 * len(sheet.major)) * rng.choice([0.0, 0.3, 1.0])
    push[0] = 0.0
    return solve(sheet, state, push, free, int(rng.integers(2, 12)), trust=0.05)


def of_record(sheet, line, unit, direction_deg, normals):
    """The state of a line of rolls.jsonl, in coordinates about the axis."""
    t = np.radians(direction_deg)
    into = np.array([[np.cos(t), np.sin(t), 0], [-np.sin(t), np.cos(t), 0], [0, 0, 1]])
    lattice = np.array([into @ line[key] for key in ("a1", "a2")]) / unit
    turns = np.array(line["roll"]["turn_rad"])
    basis = [[1, 0], [0, 1]] if line["cell"] == "1x1" else [row.split(",") for row in line["cell"].split(";")]
    written = np.array(basis, int) @ sheet.cell  # an image by a symmetry may have another basis
    kappa = turns @ written[:, 0] / (written[:, 0] @ written[:, 0])
    axis = lattice[:, 0] @ turns / (turns @ turns)  # so far below the origin
    across = np.linalg.solve(written[:, ::-1], lattice[:, 1])
    poses = {pose["element"]: pose for pose in line["poses"]}
    centers, frames = [], []
    for name, normal in zip(sheet.names, normals):
        w, *v = poses[name]["rotation"]
        angle = 2 * np.arctan2(np.linalg.norm(v), w)
        turned = rotation(np.array(v) / max(np.linalg.norm(v), 1e-300) * angle) @ normal
        centers.append(into @ poses[name]["position"] / unit + [0, 0, axis])
        frames.append(frame_of(into @ turned))
    state = State(np.array(centers), np.array(frames), kappa, across[0] - 1, across[1])
    state.angles += 2 * np.pi * np.round((kappa * sheet.centers[:, 0] - state.angles) / (2 * np.pi))
    return state


def climbed(sheet, state, free):
    """The state of the largest curvature from there, and none if it is not one that counts."""
    objective = np.zeros(3 + 6 * len(sheet.major))
    objective[0] = 1.0
    for weight in (10.0, 100.0, 1000.0):
        state = state and solve(sheet, state, objective, free, 200, weight)
    if state and state.valid(sheet) and state.rows(sheet, 0.01)[0].min() > -1e-6:
        return state
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("design")
    parser.add_argument("--directions", default="0,30,60,90")
    parser.add_argument("--free", action="store_true", help="leave width and shear free, too")
    parser.add_argument("--starts", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--maille", default="maille")
    arguments = parser.parse_args()
    design = tomllib.loads(Path(arguments.design).read_text())
    normals = [element["rings"][0]["normal"] for element in design["elements"]]
    with tempfile.TemporaryDirectory() as folder:
        command = [arguments.maille, "roll", arguments.design, "--directions", "0:180:7.5", "--axis", "below",
                   "--cell", "1x1", "--out", folder, "--overwrite", "-q"]
        subprocess.run(command + ["--free", "width,shear"] * arguments.free, check=True)
        lines = [json.loads(line) for line in (Path(folder) / "rolls.jsonl").read_text().splitlines()]
    lines = {line["direction_deg"]: line for line in lines if "direction_deg" in line}
    print("direction     maille  of starts   alike  from the state of maille")
    for direction in map(float, arguments.directions.split(",")):
        sheet = Sheet(arguments.design, direction)
        record = of_record(sheet, lines[direction], design["reference_radius"], direction, normals)
        again = climbed(sheet, record, arguments.free)
        rng = np.random.default_rng(arguments.seed)
        starts = [random_start(sheet, rng, arguments.free) for _ in range(arguments.starts)]
        ends = [end.kappa for end in (start and climbed(sheet, start, arguments.free) for start in starts) if end]
        best = max(ends, default=float("nan"))
        alike = sum(end > best * (1 - 1e-4) for end in ends)
        print(f"{direction:9g} {record.kappa:10.7f} {best:10.7f} {alike:3} / {arguments.starts:2}  "
              f"{again.kappa if again else float('nan'):10.7f}", flush=True)


if __name__ == "__main__":
    main()
