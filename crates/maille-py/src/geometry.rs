//! Kernels on NumPy arrays: many pairs of circles at once, written straight into arrays that Python has made.
//!
//! Arrays are contiguous; a circle's array has one row a pair, or one row for all pairs. Each pair has the same bits whatever
//! its neighbours are, so that results do not depend on blocks or threads.

use crate::error;
use maille_geometry::{
    Approaches, Circle, MAX_MINIMA, PairKind, Vec3, circle_distance_approaches, point_circle_distance,
};
use nalgebra::UnitVector3;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1, PyReadwriteArray2, PyReadwriteArray3};
use pyo3::prelude::*;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pairs that a thread takes at once.
const CHUNK: usize = 512;
/// Pairs between two looks for Ctrl-C.
const BLOCK: usize = 1 << 20;
/// A normal may miss the length 1 by this.
const UNIT: f64 = 1e-9;

/// Circles side by side.
#[derive(Clone, Copy)]
struct Circles<'a> {
    names: [&'static str; 3],
    center: &'a [f64],
    normal: &'a [f64],
    radius: &'a [f64],
}

/// Row `k` of an array of rows of `N`; the one row, if there is no other.
#[inline(always)]
fn row<const N: usize>(values: &[f64], k: usize) -> [f64; N] {
    let k = if values.len() == N { 0 } else { k };
    std::array::from_fn(|axis| values[N * k + axis])
}

impl Circles<'_> {
    /// Circle `k`, if it is one.
    #[inline(always)]
    fn get(&self, k: usize) -> Option<Circle> {
        let (center, normal): (Vec3, Vec3) = (row(self.center, k).into(), row(self.normal, k).into());
        let [radius] = row(self.radius, k);
        let sum = center.x + center.y + center.z;
        let good = (normal.norm_squared() - 1.0).abs() <= 2.0 * UNIT && radius > 0.0 && (sum + radius).is_finite();
        good.then(|| Circle::new(center, UnitVector3::new_unchecked(normal), radius))
    }

    /// Why circle `k` is none.
    fn wrong(&self, k: usize) -> Option<PyErr> {
        let (center, normal): ([f64; 3], [f64; 3]) = (row(self.center, k), row(self.normal, k));
        let [radius] = row(self.radius, k);
        let [of_center, of_normal, of_radius] = self.names;
        let length = Vec3::from(normal).norm();
        Some(match () {
            () if !center.iter().all(|x| x.is_finite()) => {
                error::element(of_center, k, &center, "is not finite", "give three finite numbers")
            }
            () if !normal.iter().all(|x| x.is_finite()) => {
                error::element(of_normal, k, &normal, "is not finite", "give three finite numbers of length 1")
            }
            () if self.get(k).is_some() => return None,
            () if (length - 1.0).abs() > UNIT => {
                let problem = format!("has length {length}, not 1");
                let remedy = format!("{of_normal} / numpy.linalg.norm({of_normal}, axis=-1, keepdims=True)");
                error::element(of_normal, k, &normal, &problem, &format!("give unit normals: {remedy}"))
            }
            () => error::element(of_radius, k, &[radius], "is no radius", "give positive finite radii"),
        })
    }
}

/// Two arrays of circles.
#[derive(Clone, Copy)]
struct Pairs<'a> {
    a: Circles<'a>,
    b: Circles<'a>,
}

impl Pairs<'_> {
    #[inline(always)]
    fn get(&self, k: usize) -> Option<(Circle, Circle)> {
        Some((self.a.get(k)?, self.b.get(k)?))
    }

    /// Does blocks of pairs with Python free to run, and raises the first pair that is none.
    fn each_block(
        &self,
        py: Python<'_>,
        count: usize,
        mut work: impl FnMut(usize, usize, &Wrong) + Send,
    ) -> PyResult<()> {
        let wrong = Wrong(AtomicUsize::new(usize::MAX));
        for first in (0..count).step_by(BLOCK) {
            py.detach(|| work(first, (first + BLOCK).min(count), &wrong));
            if let Some(k) = wrong.first() {
                let error = self.a.wrong(k).or_else(|| self.b.wrong(k));
                return Err(
                    error.unwrap_or_else(|| error::other("a pair was refused that is right; please report this"))
                );
            }
            py.check_signals()?;
        }
        Ok(())
    }
}

/// The first pair that is none.
struct Wrong(AtomicUsize);

impl Wrong {
    fn at(&self, k: usize) {
        self.0.fetch_min(k, Ordering::Relaxed);
    }

    fn first(&self) -> Option<usize> {
        Some(self.0.load(Ordering::Relaxed)).filter(|k| *k != usize::MAX)
    }
}

/// Pairs and their minima.
type Solved<'a> = (&'a [(Circle, Circle)], &'a [Approaches]);

/// What a thread needs for a chunk.
struct Chunk {
    pairs: Vec<(Circle, Circle)>,
    found: Vec<Approaches>,
}

/// No circle is out of reach.
const REACH: [f64; CHUNK] = [f64::INFINITY; CHUNK];

impl Chunk {
    fn new() -> Self {
        Self { pairs: Vec::with_capacity(CHUNK), found: vec![Approaches::NONE; CHUNK] }
    }

    /// The minima of the pairs from `first` on; none after one that is wrong.
    fn solve(&mut self, all: &Pairs<'_>, first: usize, count: usize, wrong: &Wrong) -> Option<Solved<'_>> {
        self.pairs.clear();
        for k in first..first + count {
            let Some(pair) = all.get(k) else {
                wrong.at(k);
                return None;
            };
            self.pairs.push(pair);
        }
        let found = &mut self.found[..count];
        circle_distance_approaches(&self.pairs, &REACH[..count], found);
        Some((&self.pairs, found))
    }
}

fn code(kind: PairKind) -> u8 {
    match kind {
        PairKind::Generic => 0,
        PairKind::Coaxial => 1,
        PairKind::Coplanar => 2,
        PairKind::Concentric => 3,
        PairKind::Equidistant => 4,
    }
}

type In1<'py> = PyReadonlyArray1<'py, f64>;
type In2<'py> = PyReadonlyArray2<'py, f64>;

/// The six arrays of a function as pairs.
macro_rules! pairs {
    ($center_a:ident, $normal_a:ident, $radius_a:ident, $center_b:ident, $normal_b:ident, $radius_b:ident) => {
        Pairs {
            a: Circles {
                names: ["center_a", "normal_a", "radius_a"],
                center: $center_a.as_slice()?,
                normal: $normal_a.as_slice()?,
                radius: $radius_a.as_slice()?,
            },
            b: Circles {
                names: ["center_b", "normal_b", "radius_b"],
                center: $center_b.as_slice()?,
                normal: $normal_b.as_slice()?,
                radius: $radius_b.as_slice()?,
            },
        }
    };
}

/// Minima of the distance of each pair, into the arrays.
#[pyfunction]
pub fn circle_distance_minima<'py>(
    py: Python<'py>,
    center_a: In2<'py>,
    normal_a: In2<'py>,
    radius_a: In1<'py>,
    center_b: In2<'py>,
    normal_b: In2<'py>,
    radius_b: In1<'py>,
    mut count: PyReadwriteArray1<'py, i64>,
    mut distance: PyReadwriteArray2<'py, f64>,
    mut point_a: PyReadwriteArray3<'py, f64>,
    mut point_b: PyReadwriteArray3<'py, f64>,
    mut kind: PyReadwriteArray1<'py, u8>,
) -> PyResult<()> {
    let pairs = pairs!(center_a, normal_a, radius_a, center_b, normal_b, radius_b);
    let (count, distance, kind) = (count.as_slice_mut()?, distance.as_slice_mut()?, kind.as_slice_mut()?);
    let (point_a, point_b) = (point_a.as_slice_mut()?, point_b.as_slice_mut()?);
    const POINTS: usize = 3 * MAX_MINIMA;
    pairs.each_block(py, count.len(), |first, last, wrong| {
        let outputs = (
            count[first..last].par_chunks_mut(CHUNK),
            distance[MAX_MINIMA * first..MAX_MINIMA * last].par_chunks_mut(MAX_MINIMA * CHUNK),
            point_a[POINTS * first..POINTS * last].par_chunks_mut(POINTS * CHUNK),
            point_b[POINTS * first..POINTS * last].par_chunks_mut(POINTS * CHUNK),
            kind[first..last].par_chunks_mut(CHUNK),
        );
        outputs.into_par_iter().enumerate().for_each_init(Chunk::new, |chunk, (k, (count, distance, pa, pb, kind))| {
            let Some((pairs, found)) = chunk.solve(&pairs, first + k * CHUNK, count.len(), wrong) else { return };
            for (i, ((a, b), found)) in pairs.iter().zip(found).enumerate() {
                let minima = found.as_slice();
                count[i] = minima.len() as i64;
                kind[i] = code(found.kind(a, b));
                for j in 0..MAX_MINIMA {
                    let to = POINTS * i + 3 * j..POINTS * i + 3 * j + 3;
                    let (d, p, q) = match minima.get(j) {
                        Some(minimum) => {
                            let on_b = b.center + minimum.direction_b * b.radius;
                            (minimum.distance, point_circle_distance(&on_b, a).point.into(), on_b.into())
                        }
                        None => (f64::NAN, [f64::NAN; 3], [f64::NAN; 3]),
                    };
                    distance[MAX_MINIMA * i + j] = d;
                    pa[to.clone()].copy_from_slice(&p);
                    pb[to].copy_from_slice(&q);
                }
            }
        });
    })
}

/// Linking number of each pair, into the array.
#[pyfunction]
pub fn linking_number<'py>(
    py: Python<'py>,
    center_a: In2<'py>,
    normal_a: In2<'py>,
    radius_a: In1<'py>,
    center_b: In2<'py>,
    normal_b: In2<'py>,
    radius_b: In1<'py>,
    mut linking: PyReadwriteArray1<'py, i64>,
) -> PyResult<()> {
    let pairs = pairs!(center_a, normal_a, radius_a, center_b, normal_b, radius_b);
    let linking = linking.as_slice_mut()?;
    pairs.each_block(py, linking.len(), |first, last, wrong| {
        linking[first..last].par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(k, out)| {
            match pairs.get(first + k) {
                Some((a, b)) => *out = i64::from(maille_geometry::linking_number(&a, &b)),
                None => wrong.at(first + k),
            }
        });
    })
}

/// Gap of each pair of tori, into the array.
#[pyfunction]
pub fn torus_gap<'py>(
    py: Python<'py>,
    center_a: In2<'py>,
    normal_a: In2<'py>,
    radius_a: In1<'py>,
    minor_radius_a: In1<'py>,
    center_b: In2<'py>,
    normal_b: In2<'py>,
    radius_b: In1<'py>,
    minor_radius_b: In1<'py>,
    mut gap: PyReadwriteArray1<'py, f64>,
) -> PyResult<()> {
    let pairs = pairs!(center_a, normal_a, radius_a, center_b, normal_b, radius_b);
    let (minor_a, minor_b, gap) = (minor_radius_a.as_slice()?, minor_radius_b.as_slice()?, gap.as_slice_mut()?);
    for (name, minor) in [("minor_radius_a", minor_a), ("minor_radius_b", minor_b)] {
        if let Some(k) = minor.iter().position(|r| !(r.is_finite() && *r > 0.0)) {
            return Err(error::element(name, k, &minor[k..=k], "is no radius", "give positive finite radii"));
        }
    }
    pairs.each_block(py, gap.len(), |first, last, wrong| {
        gap[first..last].par_chunks_mut(CHUNK).enumerate().for_each_init(Chunk::new, |chunk, (k, out)| {
            let first = first + k * CHUNK;
            let Some((_, found)) = chunk.solve(&pairs, first, out.len(), wrong) else { return };
            for (i, (out, found)) in out.iter_mut().zip(found).enumerate() {
                let ([a], [b]) = (row(minor_a, first + i), row(minor_b, first + i));
                *out = found.as_slice()[0].distance - (a + b);
            }
        });
    })
}
