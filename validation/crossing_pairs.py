"""The constants in the proof of "Crossing pairs", docs/theory/bounds.md, recomputed; and its last inequality on random pairs.

    python validation/crossing_pairs.py [PAIRS]

Prints each constant at its worst over r = 1e-4 ... 1/7, with what the text claims; then the least E over PAIRS random pairs
that obey the hypotheses (default 200,000). Fails if a claim does not hold. Needs Python alone.
"""

import math
import random
import sys

THICKEST = 1 / 7
RADII = [10 ** (-4 + k * (math.log10(THICKEST) + 4) / 400) for k in range(400)] + [THICKEST]


def of_radius(r):
    """alpha, rho, gamma, L, eta."""
    alpha = r
    for _ in range(200):
        alpha = math.sin(math.atan(r * (1 + 2 * alpha)))
    rho, gamma = math.sqrt(1 - alpha**2), math.sqrt(1 - 2 * alpha**2)
    length = (2 * rho - 2 * r - 2 * r * alpha) / gamma
    return alpha, rho, gamma, length, 2 - 2 * r - length


def constants(r):
    """(name, value, claimed, sign): value <= claimed for sign +, value >= claimed for sign -."""
    alpha, rho, gamma, _, eta = of_radius(r)
    tilt = 4 * eta  # B
    beta = math.sqrt(tilt)
    up = 2 * eta  # |delta_z|
    mu = 2 * up
    cos_beta = math.sqrt(1 - tilt)
    sum_beta = math.sqrt(2 * tilt)  # |S|, |d|, |S'|
    far = 2 * r + alpha / rho + 13 * r * alpha**3
    twist = (far + beta * up) / (2 * math.sqrt(r * (1 - r)))
    cos_2w = math.sqrt(1 - twist**2) - tilt / 2
    cos_w, sin_w = math.sqrt((1 + cos_2w) / 2), math.sqrt((1 - cos_2w) / 2)
    tan_w = sin_w / cos_w
    sigma = (far + sin_w * sum_beta) / (2 * cos_w)
    cos_theta = math.sqrt(1 - sigma**2)
    yield "alpha", alpha, 0.195, +1
    yield "alpha/r", alpha / r, 1.37, +1
    yield "rho", rho, 0.98, -1
    yield "gamma", gamma, 0.961, -1
    yield "eta", eta, 0.029, +1
    yield "B", tilt, 0.115, +1
    yield "|sin beta|", beta, 0.34, +1
    yield "|delta_z|", up, 0.058, +1
    # The last term of E, for mu = nu at their largest.
    of_mu = 6 * ((2 + mu) ** 2 / (1 + mu) ** 3 + (2 - mu) ** 2 / (1 - mu) ** 3)
    yield "mu^2 of the last term / r alpha^4", of_mu, 51, +1
    yield "(u.v)^2 of the last term / r alpha^4", 0.5 * 3 * 16 / (1 - mu**2) ** 2, 25, +1
    yield "51 r alpha^4", 51 * r * alpha**4, 0.011, +1
    yield "25 r alpha^2", 25 * r * alpha**2, 0.14, +1
    yield "far", far, 0.499, +1
    yield "|delta| of pairs that are not far", math.hypot(far, up), 0.51, +1
    yield "sin 2w'", twist, 0.75, +1
    yield "cos 2w", cos_2w, 0.6, -1
    yield "2w", math.acos(cos_2w), 0.93, +1
    yield "cos w", cos_w, 0.894, -1
    yield "sigma", sigma, 0.4, +1
    yield "|epsilon|/2r", 4 * eta / (2 * r), 0.41, +1
    # E >= 0, step by step.
    leaning = 2 * alpha * gamma / rho * beta / (1 + cos_beta)
    yield "1: leaning / B", leaning, 0.07, +1
    squares = gamma**2 * (1 - mu) / rho
    yield "2: squares / B", squares, 0.83, -1
    yield "2: part with sin^2 / alpha^2 B", 1 / (1 - mu) + 1 + mu, 2.3, +1
    yield "2: the same / B", (1 / (1 - mu) + 1 + mu) * alpha**2 / rho, 0.09, +1
    of_mu_sq = 0.0
    for k in range(1001):
        q = cos_2w + (1 - cos_2w) * k / 1000
        of_mu_sq = max(of_mu_sq, (1 - q * q) * (1 / (2 * q - 0.3) + 1 / (2.7 - 2 * q)))
    yield "2: mu^2 / alpha^2", of_mu_sq, 1.2, +1
    yield "3: 2 cos w", 2 * cos_w, 1.78, -1
    yield "3: 2r (1 - cos xi) / sigma^2", 2 * r / (1 + cos_theta), 0.15, +1
    aside = 2 * (1.78 - 0.15) - 2.7 * alpha / rho - 0.28 * alpha
    yield "3: left of alpha sigma^2", aside, 2.6, -1
    yield "4: (cos beta_1 - cos beta_2)^2 / B", tilt / (1 + cos_beta) ** 2, 0.031, +1
    yield "4: delta_z^2 in (alpha/r) eps^2", 2 * alpha / r, 2.73, +1
    yield "4: B in (alpha/r) eps^2", 0.062 * alpha / r, 0.09, +1
    yield "4: 2 gamma |mu delta_z| / delta_z^2", 4 * gamma, 3.84, -1
    third = 4 * (1 / rho - r) / (1 - mu**2) * rho
    yield "4: (1/rho - r) 4 m / (mu^2/rho)", third, 4.1, +1
    yield "4: terms with mu^2 / delta_z^2", 4 * ((1.2 + 4.1) * alpha**2 / rho + 0.011), 0.9, +1
    yield "4: left of B", squares - leaning - 0.09 - 0.09, 0.58, -1
    yield "5: (1 - cos theta) / sigma^2", 1 / (1 + cos_theta), 0.53, +1
    yield "5: |S'|", sum_beta, 0.48, +1
    yield "5: cost / alpha sigma^2", 2 * 0.53 * 0.48, 2.6, +1
    yield "5: (1 - gamma/rho) / alpha^2", (1 - gamma / rho) / alpha**2, 0.53, +1
    yield "5: |S'| from which B covers it / alpha^3", 1.06 / (0.58 / 2), 3.7, +1
    # cos theta >= gamma/rho, so sigma <= alpha/rho.
    near = math.sqrt(1 - (gamma / rho) ** 2)
    yield "5: sigma where cos theta >= gamma/rho, rho/alpha", near * rho / alpha, 1 + 1e-6, +1
    small = (3.7 * alpha**3 + sin_w * near * sum_beta) / (cos_w * gamma / rho)
    yield "5: |S| / r^2", small / r**2, 5.4, +1
    least_width = 2 * r - (4 * eta) ** 2 / (2 * r)
    yield "5: 2|S| / least Delta", 2 * 5.4 * r**2 / least_width, 1, +1
    ratio = math.tan(math.asin(sigma))
    yield "5: (sigma + sigma')/(cos xi + cos xi')", ratio, 0.44, +1
    differ = 2 * sin_w * tan_w + 0.44 * sin_w
    yield "5: what S' differs / B", differ, 0.65, +1
    yield "5: its cost / B", 4 * alpha * 0.65, 0.51, +1


def check_constants():
    worst = {}
    for r in RADII:
        for name, value, claimed, sign in constants(r):
            before = worst.get(name)
            if before is None or sign * (value - before[0]) > 0:
                worst[name] = (value, claimed, sign, r)
    failed = 0
    for name, (value, claimed, sign, r) in worst.items():
        holds = sign * (value - claimed) <= 0
        failed += not holds
        mark = "" if holds else "  FAILS"
        print(f"{name:<48} {value:10.5f} {'<=' if sign > 0 else '>='} {claimed:8.5g}   at r = {r:.4g}{mark}")
    return failed


def solve_theta(omega, d, shift_v, lower):
    """sin w cos t d - 2 cos w sin t = shift_v, with cos t > 0 or < 0."""
    p, q = 2 * math.cos(omega), math.sin(omega) * d
    size, turn = math.hypot(p, q), math.atan2(q, p)
    t = math.asin(-shift_v / size)
    return (math.pi - t if lower else t) + turn


def least_e(r, rng):
    """E of the proof for a random pair A, with the worst of some unit vectors v; None where the pair breaks a hypothesis."""
    alpha, rho, gamma, _, eta = of_radius(r)
    scale = 10 ** rng.uniform(-3, 0)
    beta = [rng.uniform(-1, 1) * 2 * math.sqrt(eta) * scale for _ in range(2)]
    tilt = sum(math.sin(b) ** 2 for b in beta)
    if tilt > 4 * eta:
        return None
    omega = rng.uniform(0, 0.465) * scale
    up = rng.uniform(-1, 1) * 2 * eta * scale
    shift_v = rng.uniform(-1, 1) * (2 * r + alpha) * scale
    sines = [math.sin(b) for b in beta]
    s_sum, d = sum(sines), sines[0] - sines[1]
    # As near as the tori allow at both matched points.
    widths = []
    thetas = [solve_theta(omega, d, shift_v, lower) for lower in (False, True)]
    for theta in thetas:
        eps = up + math.cos(theta) * (math.cos(beta[0]) - math.cos(beta[1]))
        least = math.sqrt(max(0.0, 4 * r * r - eps * eps))
        widths.append(least + math.cos(omega) * math.cos(theta) * s_sum)
    width = max(widths) + (rng.uniform(0, 1) * scale * r if rng.random() < 0.5 else 0.0)
    if math.hypot(width, shift_v) >= 2 * r + alpha / rho + 13 * r * alpha**3:
        return None
    mu = -2 * up
    weight = [1 + mu, 1 - mu]
    side = [1, -1]

    def leaning(xi):
        return sum(sines[i] * math.cos(xi - side[i] * omega) for i in range(2))

    xi = -math.asin(math.sin(thetas[0]))
    if -3.7 * alpha**3 < leaning(xi) < 0 and math.cos(thetas[0]) >= gamma / rho:
        xi = -math.asin(math.sin(thetas[1]))
    along = width * math.cos(xi) + shift_v * math.sin(xi)
    flat = [math.cos(xi - side[i] * omega) for i in range(2)]
    t = [gamma * sines[i] - alpha / weight[i] * math.cos(beta[i]) * flat[i] for i in range(2)]
    fixed = sum(weight[i] * t[i] ** 2 for i in range(2)) - 2 * alpha**2
    fixed = fixed / rho + 2 * alpha * (along - 2 * r) + 2 * gamma * abs(mu * up)
    fixed -= (1 / rho - r) * 4 * alpha**2 * mu**2 / (1 - mu**2)
    worst = math.inf
    for k in range(24):
        psi = rng.uniform(0, 2 * math.pi) if k else math.pi / 2
        y = [alpha * math.cos(beta[i]) * math.cos(psi - side[i] * omega) for i in range(2)]
        e = fixed + sum(weight[i] * y[i] ** 2 for i in range(2)) / rho
        e -= 51 * r * alpha**4 * mu**2 + 25 * r * alpha**4 * math.cos(psi - xi) ** 2
        worst = min(worst, e)
    return worst


def main():
    failed = check_constants()
    pairs = int(sys.argv[1]) if sys.argv[1:] else 200_000
    rng = random.Random(1)
    least, used = math.inf, 0
    for k in range(pairs):
        r = [THICKEST, 0.125, 0.1, 0.05, 0.01, 0.001][k % 6]
        e = least_e(r, rng)
        if e is not None:
            used += 1
            least = min(least, e / r**2)
    print(f"least E / r^2 of {used} pairs that are not far: {least:.3e}")
    sys.exit(failed > 0 or least < -1e-12)


main()
