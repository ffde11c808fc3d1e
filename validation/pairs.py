"""The hardest of the adversarial pairs of circles, and of segments and arcs, solved with 50 digits.

    MAILLE_PAIRS=1000000 MAILLE_HARDEST=/tmp/hardest.csv cargo test --release -p maille-geometry --test it adversarial::
    MAILLE_HARDEST=/tmp/pieces.csv cargo test --release -p maille-geometry --test it pieces:: -- --ignored
    python validation/pairs.py /tmp/hardest.csv
    python validation/pairs.py /tmp/pieces.csv

A line of circles: centre, normal and radius of A and of B, and the distances that were found. The distance of a point of B from A is
d^2 = z^2 + (rho - R)^2; its local minima along B are bracketed by 4,096 samples and around each distance that was found,
and refined by golden section with mpmath. Compared are the least distance, and every minimum with a barrier of 1e-9 of the
pair's size. A line of pieces has both, and the distances. A is then gone along by t = (1 - cos angle) / 2, so that its
ends are minima of the angle where they are minima; B is exact. Needs numpy and mpmath.
"""

import sys

import mpmath as mp
import numpy as np

mp.mp.dps = 50
SAMPLES = 4096
SIGNIFICANT = 1e-9


def vector(values):
    return [mp.mpf(x) for x in values]


def dot(p, q):
    return sum(x * y for x, y in zip(p, q))


def cross(p, q):
    return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]


def unit(p):
    size = mp.sqrt(dot(p, p))
    return [x / size for x in p]


class Pair:
    def __init__(self, numbers):
        ca, na, self.ra = vector(numbers[0:3]), unit(vector(numbers[3:6])), mp.mpf(numbers[6])
        cb, nb, self.rb = vector(numbers[7:10]), unit(vector(numbers[10:13])), mp.mpf(numbers[13])
        self.n, self.w = na, [b - a for a, b in zip(ca, cb)]
        least = min(range(3), key=lambda k: abs(nb[k]))
        self.u = unit(cross(nb, [mp.mpf(k == least) for k in range(3)]))
        self.v = cross(nb, self.u)
        self.size = max(mp.sqrt(dot(self.w, self.w)), self.ra, self.rb)
        # What rounding of the pair's own numbers does.
        coordinates = max(abs(float(x)) for x in (*ca, *cb)) + float(self.ra + self.rb)
        self.rounding = 8 * 2.3e-16 * coordinates

    def distance(self, angle):
        c, s = self.rb * mp.cos(angle), self.rb * mp.sin(angle)
        p = [w + c * u + s * v for w, u, v in zip(self.w, self.u, self.v)]
        z = dot(p, self.n)
        flat = [x - z * n for x, n in zip(p, self.n)]
        return mp.sqrt(z * z + (mp.sqrt(dot(flat, flat)) - self.ra) ** 2)

    def samples(self):
        """In double precision: angles, and distances there."""
        angle = np.arange(SAMPLES) * (2 * np.pi / SAMPLES)
        w, u, v, n = (np.array([float(x) for x in p]) for p in (self.w, self.u, self.v, self.n))
        p = w + float(self.rb) * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)
        z = p @ n
        return angle, np.hypot(z, np.linalg.norm(p - z[:, None] * n, axis=1) - float(self.ra))

    def refine(self, low, high):
        """Golden section to 1e-25 of the circle."""
        low, high, ratio = mp.mpf(low), mp.mpf(high), (mp.sqrt(5) - 1) / 2
        p, q = high - ratio * (high - low), low + ratio * (high - low)
        fp, fq = self.distance(p), self.distance(q)
        while high - low > mp.mpf(10) ** -20:
            if fp < fq:
                high, q, fq = q, p, fp
                p = high - ratio * (high - low)
                fp = self.distance(p)
            else:
                low, p, fp = p, q, fq
                q = low + ratio * (high - low)
                fq = self.distance(q)
        return (low + high) / 2


def read_piece(text):
    kind, *numbers = text.split()
    return kind, vector(numbers)


class Pieces(Pair):
    """Two segments or arcs with the functions of a pair of circles."""

    def __init__(self, a, b):
        self.a, self.b = read_piece(a), read_piece(b)
        coordinates = max(abs(float(x)) for _, numbers in (self.a, self.b) for x in numbers)
        self.size = max(self.length(piece) for piece in (self.a, self.b))
        self.rounding = 8 * 2.3e-16 * coordinates

    @staticmethod
    def length(piece):
        kind, v = piece
        return mp.sqrt(sum((y - x) ** 2 for x, y in zip(v[:3], v[3:]))) if kind == "segment" else v[6] * v[10]

    @staticmethod
    def frame(v):
        """Centre, unit vector to the start and one a quarter turn on, normal."""
        start = unit([s - c for s, c in zip(v[7:10], v[:3])])
        normal = unit(v[3:6])
        return v[:3], start, cross(normal, start), normal

    def point(self, t):
        kind, v = self.a
        if kind == "segment":
            return [x + (y - x) * t for x, y in zip(v[:3], v[3:])]
        center, start, aside, _ = self.frame(v)
        c, s = v[6] * mp.cos(v[10] * t), v[6] * mp.sin(v[10] * t)
        return [x + c * u + s * w for x, u, w in zip(center, start, aside)]

    def from_b(self, p):
        kind, v = self.b
        far = lambda q: mp.sqrt(sum((x - y) ** 2 for x, y in zip(p, q)))
        if kind == "segment":
            along = [y - x for x, y in zip(v[:3], v[3:])]
            t = min(max(dot([x - y for x, y in zip(p, v[:3])], along) / dot(along, along), mp.mpf(0)), mp.mpf(1))
            return far([x + t * u for x, u in zip(v[:3], along)])
        center, start, aside, normal = self.frame(v)
        d = [x - c for x, c in zip(p, center)]
        z, x, y = dot(d, normal), dot(d, start), dot(d, aside)
        if mp.atan2(y, x) % (2 * mp.pi) <= v[10]:
            return mp.sqrt(z * z + (mp.sqrt(x * x + y * y) - v[6]) ** 2)
        ends = [(mp.mpf(1), mp.mpf(0)), (mp.cos(v[10]), mp.sin(v[10]))]
        return min(mp.sqrt((x - v[6] * c) ** 2 + (y - v[6] * s) ** 2 + z * z) for c, s in ends)

    def distance(self, angle):
        return self.from_b(self.point((1 - mp.cos(angle)) / 2))

    def samples(self):
        angle = np.arange(SAMPLES) * (2 * np.pi / SAMPLES)
        half = [float(self.coarse((1 - np.cos(x)) / 2)) for x in angle[: SAMPLES // 2 + 1]]
        return angle, np.array(half + half[-2:0:-1])

    def coarse(self, t):
        """The distance in double precision."""
        if not hasattr(self, "double"):
            self.double = [(kind, [float(x) for x in v]) for kind, v in (self.a, self.b)]
            self.frames = [None if k == "segment" else [np.array([float(x) for x in w]) for w in self.frame(v)] for k, v in (self.a, self.b)]
        (kind, v), frame = self.double[0], self.frames[0]
        if kind == "segment":
            p = np.array(v[:3]) + t * (np.array(v[3:]) - np.array(v[:3]))
        else:
            p = frame[0] + v[6] * (np.cos(v[10] * t) * frame[1] + np.sin(v[10] * t) * frame[2])
        (kind, v), frame = self.double[1], self.frames[1]
        if kind == "segment":
            start, along = np.array(v[:3]), np.array(v[3:]) - np.array(v[:3])
            return np.linalg.norm(p - start - along * np.clip((p - start) @ along / (along @ along), 0, 1))
        d = p - frame[0]
        z, x, y = d @ frame[3], d @ frame[1], d @ frame[2]
        if np.arctan2(y, x) % (2 * np.pi) <= v[10]:
            return np.hypot(z, np.hypot(x, y) - v[6])
        return min(np.sqrt((x - v[6] * c) ** 2 + (y - v[6] * s) ** 2 + z * z) for c, s in [(1, 0), (np.cos(v[10]), np.sin(v[10]))])


def significant(distance, k, size):
    """Whether barriers stand on both sides of sample k before anything lower."""
    for step in (1, -1):
        rise = np.roll(distance, -k)[::step][1:] - distance[k] if step == 1 else np.roll(distance[::-1], k + 1)[1:] - distance[k]
        first = np.flatnonzero(np.abs(rise) > SIGNIFICANT * size)
        if first.size == 0 or rise[first[0]] < 0:
            return False
    return True


def valleys(places, distance, size):
    """Of the places in one valley without a barrier between them, the lowest."""
    out = []
    for k in sorted(places, key=lambda k: distance[k]):
        low = np.roll(distance, -k) <= distance[k] + SIGNIFICANT * size
        ahead, behind = (len(way) if way.all() else int(np.argmin(way)) for way in (low, np.roll(low[::-1], 1)))
        if not any((j - k) % len(distance) < ahead or (k - j) % len(distance) < behind for j in out):
            out.append(k)
    return out


def check(line):
    numbers = line.strip().split(",")
    pair = Pieces(*numbers[:2]) if len(numbers) == 3 else Pair(numbers[:14])
    found = [float(x) for x in numbers[-1].split()]
    angle, distance = pair.samples()
    size, width = float(pair.size), 2 * np.pi / SAMPLES
    places = np.flatnonzero((distance <= np.roll(distance, 1)) & (distance < np.roll(distance, -1)))
    lowest = int(np.argmin(distance))
    places = [k for k in places.tolist() if k == lowest or significant(distance, k, size)] or [lowest]
    places = valleys(places, distance, size)
    missed, least = 0, mp.inf
    for k in places:
        exact = pair.distance(pair.refine(angle[k] - width, angle[k] + width))
        least = min(least, exact)
        allowed = SIGNIFICANT * size + pair.rounding
        if significant(distance, k, size) and min(abs(float(exact - d)) for d in found) > allowed:
            missed += 1
    # Lower than the samples saw is right, too, if it is a distance of the pair: that is checked where the pairs are made.
    return missed, abs(float(found[0] - least)), size, pair.rounding, len(places)


def main():
    with open(sys.argv[1]) as file:
        lines = file.readlines()
    missed, worst, beyond, minima = 0, 0.0, 0.0, 0
    for k, line in enumerate(lines):
        one_missed, error, size, rounding, count = check(line)
        missed, minima = missed + one_missed, minima + count
        worst, beyond = max(worst, error / rounding), max(beyond, (error - rounding) / size)
        if one_missed or error > 1e-9 * size + rounding:
            print(f"line {k + 1}: {one_missed} missed, off by {error:.1e}")
        if (k + 1) % 500 == 0:
            print(f"{k + 1} of {len(lines)}", file=sys.stderr)
    print(f"{len(lines)} pairs, {minima} minima: {missed} significant ones missed")
    print(f"least distance: off by at most {worst:.2f} times the rounding 8 eps of the pair's coordinates, and by {max(beyond, 0):.1e} of its size beyond that")
    sys.exit(missed > 0 or beyond > 1e-9)


main()
