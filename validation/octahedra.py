"""How wide apart the struts of linked octahedra on a square grid can be: copies of one octahedron of circumradius 1, in one position.

    python validation/octahedra.py

A random search over both steps of the grid in the octahedron's axes, from 12 starts. Prints the distance of the struts, the steps and their length.
"""

import itertools

import numpy as np

VERTICES = np.vstack([np.eye(3), -np.eye(3)])
EDGES = [(a, b) for a, b in itertools.combinations(range(6), 2) if b != a + 3]
FACES = list(itertools.product((0, 3), (1, 4), (2, 5)))
START, END = (VERTICES[list(of)] for of in zip(*EDGES))
# Copies that come near: sums of up to two steps.
SHIFTS = [(1, 0), (0, 1), (1, 1), (1, -1), (2, 0), (0, 2), (2, 1), (2, -1), (1, 2), (1, -2)]


def distances(p, u, q, v):
    """Of segments p + s u and q + t v, 0 ≤ s, t ≤ 1: the least of the inner point and of the four ends."""
    dot = lambda x, y: (x * y).sum(-1)
    way, uu, vv, uv = p - q, dot(u, u), dot(v, v), dot(u, v)
    out = []

    def take(s, t):
        out.append(np.linalg.norm(way + s[..., None] * u - t[..., None] * v, axis=-1))

    det = uu * vv - uv * uv
    safe = np.where(det > 1e-12, det, 1.0)
    s = (uv * dot(v, way) - vv * dot(u, way)) / safe
    t = (uu * dot(v, way) - uv * dot(u, way)) / safe
    inside = (det > 1e-12) & (s > 0) & (s < 1) & (t > 0) & (t < 1)
    take(np.where(inside, s, 0.0), np.where(inside, t, 0.0))
    for end in (0.0, 1.0):
        held = np.full(np.broadcast(uu, vv).shape, end)
        take(held, np.clip((dot(v, way) + held * uv) / vv, 0, 1))
        take(np.clip((held * uv - dot(u, way)) / uu, 0, 1), held)
    return np.min(out, axis=0)


def gap(steps):
    """Least distance of the struts of an octahedron and its copies."""
    steps = np.asarray(steps)[:, None, None, :]
    p, u = START[None, :, None, :], (END - START)[None, :, None, :]
    return distances(p, u, START[None, None] + steps, (END - START)[None, None]).min()


def linked(step):
    """Whether two faces, as triangles, have a linking number: the signed crossings of one's sides through the other."""
    for face, other in itertools.product(FACES, FACES):
        a, b, c = VERTICES[list(face)]
        normal = np.cross(b - a, c - a)
        corners = VERTICES[list(other)] + step
        crossings = 0
        for p, q in zip(corners, np.roll(corners, -1, axis=0)):
            below, above = (p - a) @ normal, (q - a) @ normal
            if below * above < 0:
                x = p + (q - p) * below / (below - above)
                sides = ((a, b), (b, c), (c, a))
                if all(np.cross(to - of, x - of) @ normal > 0 for of, to in sides):
                    crossings += 1 if above > below else -1
        if crossings:
            return True
    return False


def steps(x):
    """Two steps of equal length at a right angle."""
    a, b = x[:3], x[3:]
    b = b - a * (a @ b) / (a @ a)
    return a, b * np.linalg.norm(a) / np.linalg.norm(b)


def score(x):
    a, b = steps(x)
    return gap([m * a + n * b for m, n in SHIFTS])


def main():
    random = np.random.default_rng(1)
    ends = []
    while len(ends) < 12:
        one = np.array([1.0, 0.25, 0.25]) * random.choice([-1, 1], 3)
        other = random.permutation([1.0, 0.25, 0.25]) * random.choice([-1, 1], 3)
        x = np.concatenate([one, other]) + random.normal(0, 0.1, 6)
        if not all(linked(step) for step in steps(x)):
            continue
        best, width = score(x), 0.1
        for _ in range(1500):
            y = x + random.normal(0, width, 6)
            found = score(y)
            if found > best and all(linked(step) for step in steps(y)):
                x, best = y, found
            else:
                width = max(0.99 * width, 1e-6)
        ends.append((best, *steps(x)))
    for best, a, b in sorted(ends, key=lambda end: -end[0])[:3]:
        print(f"{best:.4f}  {a.round(4)} {b.round(4)}  {np.linalg.norm(a):.4f}")


main()
