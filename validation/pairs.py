"""The hardest of the adversarial pairs of circles, solved with 50 digits.

    MAILLE_PAIRS=1000000 MAILLE_HARDEST=/tmp/hardest.csv cargo test --release -p maille-geometry --test adversarial
    python validation/pairs.py /tmp/hardest.csv

A line: centre, normal and radius of A and of B, and the distances that were found. The distance of a point of B from A is
d^2 = z^2 + (rho - R)^2; its local minima along B are bracketed by 4,096 samples and around each distance that was found,
and refined by golden section with mpmath. Compared are the least distance, and every minimum with a barrier of 1e-9 of the
pair's size. Needs numpy and mpmath.
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


def significant(distance, k, size):
    """Whether barriers stand on both sides of sample k before anything lower."""
    for step in (1, -1):
        rise = np.roll(distance, -k)[::step][1:] - distance[k] if step == 1 else np.roll(distance[::-1], k + 1)[1:] - distance[k]
        first = np.flatnonzero(np.abs(rise) > SIGNIFICANT * size)
        if first.size == 0 or rise[first[0]] < 0:
            return False
    return True


def check(line):
    numbers = line.strip().split(",")
    pair, found = Pair(numbers[:14]), [float(x) for x in numbers[14].split()]
    angle, distance = pair.samples()
    size, width = float(pair.size), 2 * np.pi / SAMPLES
    places = np.flatnonzero((distance <= np.roll(distance, 1)) & (distance < np.roll(distance, -1)))
    lowest = int(np.argmin(distance))
    places = [k for k in places.tolist() if k == lowest or significant(distance, k, size)] or [lowest]
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
