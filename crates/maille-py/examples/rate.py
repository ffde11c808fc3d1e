"""The rate of minima of 1,000,000 pairs of circles from NumPy; `cargo run -p maille --example pair_arrays` is the same loop in Rust."""

import time

import numpy as np
from numpy.typing import NDArray

from maille.geometry import circle_distance_minima

N = 1_000_000
rng = np.random.default_rng(1)


def circles() -> tuple[NDArray[np.float64], ...]:
    normal = rng.normal(size=(N, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return rng.uniform(-1.5, 1.5, (N, 3)), normal, rng.uniform(0.3, 1.5, N)


(ca, na, ra), (cb, nb, rb) = circles(), circles()
for _ in range(7):
    begun = time.perf_counter()
    circle_distance_minima(ca, na, ra, cb, nb, rb)
    print(f"{N / (time.perf_counter() - begun) / 1e6:.2f} million pairs a second")
