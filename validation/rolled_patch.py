"""Builds a patch of each rolled sheet of a record of `maille roll` and measures all its pairs of rings by brute force.

    python3 validation/rolled_patch.py maille-out/european-4-in-1-roll

Nothing is shared with the program: each ring of the patch is a list of points in space, made from rolls.jsonl and the design in
rolls.json by a rotation about an axis and a shift along it. The patch goes round half a turn, or over five cells where that is less. Printed for each limit:
the smallest gap of all pairs of rings of different elements, the recorded one, and the number of links of an inner cell, now and in
the written sheet. Only the standard library is used.
"""

import json
import math
import sys


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a, b, t=1.0):
    return (a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    n = math.sqrt(dot(a, a))
    return (a[0] / n, a[1] / n, a[2] / n)


def turned(q, v):
    """v turned by the quaternion (w, x, y, z)."""
    w, r = q[0], tuple(q[1:])
    t = cross(r, v)
    t = (2 * t[0], 2 * t[1], 2 * t[2])
    return add(add(v, t, w), cross(r, t))


def about(axis, angle, v):
    """v turned about a unit vector (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)
    out = (v[0] * c, v[1] * c, v[2] * c)
    return add(add(out, cross(axis, v), s), axis, dot(axis, v) * (1 - c))


class Ring:
    def __init__(self, center, normal, radius, wire, element, name):
        self.center, self.normal, self.radius, self.wire = center, unit(normal), radius, wire
        self.element, self.name = element, name
        e = (1.0, 0.0, 0.0) if abs(self.normal[0]) < 0.7 else (0.0, 1.0, 0.0)
        self.u = unit(cross(self.normal, e))
        self.v = cross(self.normal, self.u)

    def point(self, t):
        return add(add(self.center, self.u, self.radius * math.cos(t)), self.v, self.radius * math.sin(t))

    def distance(self, p):
        x = add(p, self.center, -1.0)
        z = dot(x, self.normal)
        across = math.sqrt(max(dot(x, x) - z * z, 0.0))
        return math.hypot(z, across - self.radius)


def least_distance(a, b, pieces=96):
    """Least distance of the core circles: sampled, then by golden section around each sampled minimum."""
    f = lambda t: a.distance(b.point(t))
    step = 2 * math.pi / pieces
    values = [f(k * step) for k in range(pieces)]
    least = min(values)
    golden = (math.sqrt(5) - 1) / 2
    for k, value in enumerate(values):
        if value > values[k - 1] or value > values[(k + 1) % pieces] or value > least + 2 * step * b.radius:
            continue
        lo, hi = (k - 1) * step, (k + 1) * step
        x, y = hi - golden * (hi - lo), lo + golden * (hi - lo)
        fx, fy = f(x), f(y)
        for _ in range(60):
            if fx < fy:
                hi, y, fy = y, x, fx
                x = hi - golden * (hi - lo)
                fx = f(x)
            else:
                lo, x, fx = x, y, fy
                y = lo + golden * (hi - lo)
                fy = f(y)
        least = min(least, fx, fy)
    return least


def linked(a, b, pieces=720):
    """How often b passes through the disc of a, with sign."""
    count = 0
    last = None
    for k in range(pieces + 1):
        p = b.point(2 * math.pi * k / pieces)
        x = add(p, a.center, -1.0)
        z = dot(x, a.normal)
        if last is not None and (z > 0) != (last[0] > 0):
            t = last[0] / (last[0] - z)
            m = add(last[1], add(x, last[1], -1.0), t)
            if dot(m, m) < a.radius**2:
                count += 1 if z > 0 else -1
        last = (z, x)
    return count


def rings_of(design, poses, names):
    """(element, centre, normal, major, minor) of each ring in the poses of a cell."""
    specs = {e["name"]: e for e in design["elements"]}
    out = []
    for element, (position, q) in enumerate(poses):
        spec = specs[names[element].split("@")[0]]
        for ring in spec["rings"]:
            offset = turned(q, tuple(ring.get("offset") or (0.0, 0.0, 0.0)))
            wire = ring.get("minor_radius") or design["minor_radius"]
            out.append((element, add(position, offset), turned(q, tuple(ring["normal"])), ring["major_radius"], wire))
    return out


def check(design, limit):
    state = limit["state"]
    a = [tuple(state["a1"]), tuple(state["a2"])]
    along = tuple(state["roll"]["along"]) + (0.0,)
    turns = state["roll"]["turn_rad"]
    axis = cross((0.0, 0.0, 1.0), along)
    k = 0 if abs(turns[0]) > abs(turns[1]) else 1
    height = dot(a[k], along) / turns[k]
    place = (0.0, 0.0, -height)
    names = [p["element"] for p in state["poses"]]
    poses = [(tuple(p["position"]), p["rotation"]) for p in state["poses"]]
    cell = rings_of(design, poses, names)
    reach = 5
    turn_of = lambda m, n: m * turns[0] + n * turns[1]
    shift_of = lambda m, n: m * dot(a[0], axis) + n * dot(a[1], axis)
    # Half a turn in all, and a band along the axis.
    band = 2.5 * max(abs(dot(v, axis)) for v in a)
    cells = [
        (m, n)
        for m in range(-4 * reach, 4 * reach + 1)
        for n in range(-4 * reach, 4 * reach + 1)
        if abs(turn_of(m, n)) <= 0.4 * math.pi and abs(shift_of(m, n)) <= band
    ]
    patch = []
    for m, n in cells:
        angle, along_axis = turn_of(m, n), shift_of(m, n)
        for index, (element, center, normal, major, minor) in enumerate(cell):
            moved = add(place, about(axis, angle, add(center, place, -1.0)))
            moved = add(moved, axis, along_axis)
            patch.append(Ring(moved, about(axis, angle, normal), major, minor, (m, n, element), (m, n, index)))
    smallest, where, links, pairs = math.inf, None, 0, 0
    for i, one in enumerate(patch):
        for other in patch[i + 1 :]:
            if one.element == other.element:
                continue
            x = add(other.center, one.center, -1.0)
            near = one.radius + other.radius + 2 * (one.wire + other.wire)
            if dot(x, x) > near * near:
                continue
            pairs += 1
            gap = least_distance(one, other) - one.wire - other.wire
            if gap < smallest:
                smallest, where = gap, (one.name, other.name)
            inner = [ring.name[:2] == (0, 0) for ring in (one, other)]
            if any(inner) and linked(one, other):
                links += 2 if all(inner) else 1
    return smallest, where, links, pairs, len(patch)


def written_links(design):
    """Links of a cell of the design as it is written, each counted from both its rings."""
    a = [tuple(design["lattice"]["a1"]), tuple(design["lattice"]["a2"])]
    poses = [(tuple(e["center"]), (1.0, 0.0, 0.0, 0.0)) for e in design["elements"]]
    cell = rings_of(design, poses, [e["name"] for e in design["elements"]])
    ring = lambda r, m, n: Ring(add(add(r[1], a[0], m), a[1], n), r[2], r[3], r[4], (m, n, r[0]), None)
    count = 0
    for one in cell:
        here = ring(one, 0, 0)
        for m in range(-4, 5):
            for n in range(-4, 5):
                for other in cell:
                    there = ring(other, m, n)
                    if there.element != here.element and linked(here, there):
                        count += 1
    return count


def main():
    for folder in sys.argv[1:]:
        with open(f"{folder}/rolls.json") as file:
            design = json.load(file)["design"]
        known = written_links(design)
        with open(f"{folder}/rolls.jsonl") as file:
            limits = [json.loads(line) for line in file]
        for limit in limits:
            if limit.get("curvature") is None or limit["cell"] != "1x1":
                continue
            gap, where, links, pairs, rings = check(design, limit)
            unit = design["reference_radius"]
            print(
                f"{design['name']} {limit['direction_deg']:6.1f} {limit['sense']:7} "
                f"{'free' if limit['free']['lateral_free'] else 'held'}  kappa R {limit['curvature'] * unit:+.6f}  "
                f"{rings} rings, {pairs} near pairs: smallest gap {gap / unit:+.2e} R at {where}, "
                f"recorded {limit['min_gap'] / unit:+.2e} R; links {links} of {known}"
            )


if __name__ == "__main__":
    main()
