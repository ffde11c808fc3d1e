"""Geometry on arrays, against NumPy by brute force, and closed forms."""

import numpy as np
import pytest

import maille
from maille.geometry import KINDS, circle_distance_minima, linking_number, torus_gap


def pairs(n, seed=1):
    rng = np.random.default_rng(seed)
    normal = rng.normal(size=(2, n, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    center = rng.uniform(-1.5, 1.5, size=(2, n, 3))
    radius = rng.uniform(0.3, 1.5, size=(2, n))
    return center[0], normal[0], radius[0], center[1], normal[1], radius[1]


def points(center, normal, radius, angles):
    """(N, K, 3): points of circles."""
    other = np.where(np.abs(normal[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]])
    u = np.cross(normal, other)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(normal, u)
    at = np.cos(angles)[:, None] * u[:, None] + np.sin(angles)[:, None] * v[:, None]
    return center[:, None] + radius[:, None, None] * at


def distances(circle, p):
    """(N, K): distance of points from circles, equation 3.1.2."""
    center, normal, radius = circle
    delta = p - center[:, None]
    z = np.einsum("nkx,nx->nk", delta, normal)
    rho = np.sqrt(np.maximum(np.einsum("nkx,nkx->nk", delta, delta) - z**2, 0))
    return np.hypot(z, rho - radius[:, None])


def test_minima_are_those_of_dense_sampling():
    a = pairs(3000)
    found = circle_distance_minima(*a)
    angles = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    sampled = distances(a[:3], points(*a[3:], angles))
    minima = (sampled < np.roll(sampled, 1, 1)) & (sampled <= np.roll(sampled, -1, 1))
    # Sampling can merge shallow minima, and no more than that.
    assert np.mean(minima.sum(1) == found.count) > 0.995
    best = sampled.min(1)
    assert np.all(found.distance[:, 0] <= best + 1e-12) and np.all(found.distance[:, 0] > best - 1e-2)
    assert np.all(np.abs(found.distance[:, 0] - best) < 2e-2)
    present = np.arange(4) < found.count[:, None]
    assert np.array_equal(np.isfinite(found.distance), present)
    assert np.array_equal(np.isfinite(found.point_a).all(2), present)
    assert np.all(np.diff(found.distance, axis=1)[present[:, 1:]] >= 0)
    # More than two minima were never seen; finding one would be news.
    assert found.count.min() == 1 and found.count.max() == 2


def test_points_lie_on_the_circles_at_that_distance():
    a = pairs(3000, seed=2)
    found = circle_distance_minima(*a)
    present = np.arange(4) < found.count[:, None]
    for point, circle in ((found.point_a, a[:3]), (found.point_b, a[3:])):
        assert np.max(distances(circle, point)[present]) < 1e-12
    between = np.linalg.norm(found.point_a - found.point_b, axis=2)
    # Where a point is near the other's axis its foot is ill-conditioned, and the distance is not.
    assert np.max(np.abs(between - found.distance)[present]) < 1e-9


def test_special_positions_are_named():
    n, up = 6, [0, 0, 1]
    tilted = [0, np.sin(0.3), np.cos(0.3)]
    rho = 1.0 * np.sin(0.3)
    center = [[0, 0, 2], [3, 0, 0], [0, 0, 0], [0.3, 0.4, 0.5], [rho, 0, 0], [0, 0, 0]]
    normal = [up, up, tilted, tilted, tilted, up]
    found = circle_distance_minima([0, 0, 0], up, 1.0, center, normal, 1.0)
    assert len(found) == n
    assert found.kind.tolist() == ["coaxial", "coplanar", "concentric", "generic", "equidistant", "coaxial"]
    assert set(found.kind) <= set(KINDS)
    assert np.allclose(found.distance[[0, 1, 4, 5], 0], [2, 1, rho, 0], atol=1e-14)
    assert np.allclose(found.distance[2, :2], [0, 0], atol=1e-14)


def test_linking_numbers_are_gauss_integrals():
    a = pairs(200, seed=3)
    linking = linking_number(*a)
    angles = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    p, q = points(*a[:3], angles), points(*a[3:], angles)
    dp, dq = (np.roll(x, -1, 1) - np.roll(x, 1, 1) for x in (p, q))
    gap = circle_distance_minima(*a).distance[:, 0]
    for k in range(200):
        if gap[k] < 0.1:
            continue
        r = p[k][:, None] - q[k][None]
        cross = np.cross(dp[k][:, None], dq[k][None])
        gauss = np.sum(np.einsum("ijx,ijx->ij", r, cross) / np.linalg.norm(r, axis=2) ** 3) / (16 * np.pi)
        # The frame of `points` runs counter-clockwise, too: u, v, normal is right-handed.
        assert abs(gauss - linking[k]) < 0.05, k
    assert set(linking.tolist()) == {-1, 0, 1}
    flipped = linking_number(a[0], -a[1], *a[2:])
    assert np.array_equal(flipped, -linking)


def test_gaps_are_distances_less_radii():
    a = pairs(1000, seed=4)
    rng = np.random.default_rng(5)
    minor_a, minor_b = rng.uniform(0.01, 0.2, (2, 1000))
    gap = torus_gap(*a[:3], minor_a, *a[3:], minor_b)
    assert np.array_equal(gap, circle_distance_minima(*a).distance[:, 0] - (minor_a + minor_b))


def test_results_depend_neither_on_neighbours_nor_on_the_way_arrays_lie():
    a = pairs(5000, seed=6)
    whole = circle_distance_minima(*a)
    some = slice(1234, 1301)
    part = circle_distance_minima(*(x[some] for x in a))
    # Sliced with steps, Fortran order, other types of numbers, and unaligned columns of a packed record are copied, to the same bits.
    packed = np.zeros(len(a[0]), dtype=[("first", "u1"), *((str(k), "f8", x.shape[1:]) for k, x in enumerate(a))])
    for k, x in enumerate(a):
        packed[str(k)] = x
    unaligned = circle_distance_minima(*(packed[str(k)] for k in range(len(a))))
    strided = circle_distance_minima(*(np.asfortranarray(np.repeat(x, 2, axis=0))[::2] for x in a))
    for name in ("count", "distance", "point_a", "point_b", "kind_code"):
        assert np.array_equal(getattr(part, name), getattr(whole, name)[some], equal_nan=True), name
        assert np.array_equal(getattr(strided, name), getattr(whole, name), equal_nan=True), name
        assert np.array_equal(getattr(unaligned, name), getattr(whole, name), equal_nan=True), name


def test_one_circle_is_paired_with_all():
    a = pairs(50, seed=7)
    one = circle_distance_minima(a[0][3], a[1][3], a[2][3], *a[3:])
    repeated = circle_distance_minima(*(np.repeat(x[3:4], 50, axis=0) for x in a[:3]), *a[3:])
    assert np.array_equal(one.distance, repeated.distance, equal_nan=True)
    empty = circle_distance_minima(np.empty((0, 3)), np.empty((0, 3)), np.empty(0), *(x[3] for x in a[3:]))
    assert len(empty) == 0 and empty.distance.shape == (0, 4)


def test_wrong_input_is_one_readable_error():
    a = pairs(2000, seed=8)

    def wrong(place, index, value):
        changed = [x.copy() for x in a]
        changed[place][index] = value
        with pytest.raises(maille.ArgumentError) as raised:
            circle_distance_minima(*changed)
        return raised.value

    error = wrong(2, 1700, -1.0)
    assert (error.argument, error.index, error.value) == ("radius_a", 1700, -1.0)
    assert str(error) == "radius_a[1700] = -1.0 is no radius; give positive finite radii"
    assert wrong(5, 3, np.inf).argument == "radius_b" and wrong(5, 3, 0.0).index == 3
    error = wrong(1, 5, [0, 0, 2.0])
    assert error.argument == "normal_a" and error.value == (0, 0, 2) and "numpy.linalg.norm" in error.remedy
    assert wrong(4, 7, np.nan).argument == "normal_b"
    assert wrong(3, 0, [0, np.nan, 0]).argument == "center_b"
    error = wrong(0, slice(900, None), np.inf)
    assert (error.argument, error.index) == ("center_a", 900)
    for place, shape in ((0, (2000, 2)), (1, (3, 2000)), (2, (2000, 1)), (5, (1999,)), (3, (2, 2000, 3)), (1, ())):
        changed = list(a)
        changed[place] = np.ones(shape)
        with pytest.raises(maille.ShapeError) as raised:
            circle_distance_minima(*changed)
        assert raised.value.argument.startswith(("center", "normal", "radius")[place % 3])
    with pytest.raises(maille.ShapeError, match="no array of numbers"):
        linking_number(["a"], *a[1:])
    with pytest.raises(maille.ArgumentError, match=r"minor_radius_b\[1\] = 0.0"):
        torus_gap(*a[:3], 0.1, *a[3:], [0.1, 0.0] + [0.1] * 1998)
