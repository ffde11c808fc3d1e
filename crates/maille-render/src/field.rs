//! The distance from the nearest torus, at any point.

use super::{bvh::Bounds, tube::Tube};
use maille_geometry::Vec3;
use rayon::prelude::*;

/// A grid of boxes, each with the tori that can be nearest to a point in it.
///
/// The distance changes by no more than one moves. So with `h` half of a box's diagonal, a torus whose distance from the
/// box's centre exceeds the smallest by more than `2 h` is nearest nowhere in the box: most boxes keep two or three.
#[derive(Debug)]
pub(super) struct Field<'a> {
    tori: &'a [Tube],
    low: Vec3,
    inverse_step: f64,
    counts: [usize; 3],
    starts: Vec<u32>,
    nearest: Vec<u32>,
    /// Beyond this distance the field only says "at least so far".
    pub(super) reach: f64,
}

/// Boxes of the grid, about, and their least side in reference radii.
const MOST_BOXES: f64 = 4e5;
const LEAST_BOX: f64 = 0.18;

impl<'a> Field<'a> {
    /// The field of `tori` within `bounds`, exact where it is less than `reach`.
    pub(super) fn new(tori: &'a [Tube], bounds: Bounds, reach: f64) -> Self {
        let volume: f64 = (bounds.high - bounds.low).add_scalar(2.0 * reach).product();
        let step = (volume / MOST_BOXES).cbrt().max(LEAST_BOX);
        let low = bounds.low.add_scalar(-reach);
        let size = bounds.high - bounds.low;
        let counts = [0, 1, 2].map(|k| (((size[k] + 2.0 * reach) / step).ceil() as usize).max(1));
        let layer = counts[0] * counts[1];
        let half = 0.5 * step * 3.0_f64.sqrt();
        let center =
            |i: usize, j: usize, k: usize| low + Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * step;
        // Tori that can matter in a column of boxes, so that a box looks at few.
        let columns: Vec<Vec<u32>> = {
            let mut columns = vec![Vec::new(); layer];
            for (n, torus) in tori.iter().enumerate() {
                let (middle, radius) = torus.ball();
                let far = radius + reach + half;
                let at = (middle - low) / step;
                let range = |x: f64, count: usize| {
                    let first = (x - far / step).floor().max(0.0) as usize;
                    first..((x + far / step).ceil().max(0.0) as usize).min(count)
                };
                for j in range(at.y, counts[1]) {
                    for i in range(at.x, counts[0]) {
                        columns[j * counts[0] + i].push(n as u32);
                    }
                }
            }
            columns
        };
        let lists: Vec<Vec<u32>> = (0..layer * counts[2])
            .into_par_iter()
            .map(|cell| {
                let (column, k) = (cell % layer, cell / layer);
                let p = center(column % counts[0], column / counts[0], k);
                let near: Vec<(u32, f64)> =
                    columns[column].iter().map(|&n| (n, tori[n as usize].distance(&p))).collect();
                let least = near.iter().map(|x| x.1).fold(f64::INFINITY, f64::min);
                let most = (least + 2.0 * half).min(reach + half);
                near.into_iter().filter(|x| x.1 <= most).map(|x| x.0).collect()
            })
            .collect();
        let mut starts = Vec::with_capacity(lists.len() + 1);
        let mut nearest = Vec::new();
        starts.push(0);
        for list in lists {
            nearest.extend(list);
            starts.push(nearest.len() as u32);
        }
        Self { tori, low, inverse_step: 1.0 / step, counts, starts, nearest, reach }
    }

    /// Distance of `p` from the nearest torus, negative inside, or the reach where it is more.
    pub(super) fn at(&self, p: &Vec3) -> f64 {
        let place = (p - self.low) * self.inverse_step;
        let [nx, ny, nz] = self.counts;
        let inside = place.x >= 0.0 && place.y >= 0.0 && place.z >= 0.0;
        let (i, j, k) = (place.x as usize, place.y as usize, place.z as usize);
        if !inside || i >= nx || j >= ny || k >= nz {
            return self.reach;
        }
        let cell = (k * ny + j) * nx + i;
        let list = &self.nearest[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        list.iter().map(|&n| self.tori[n as usize].distance(p)).fold(self.reach, f64::min)
    }
}
