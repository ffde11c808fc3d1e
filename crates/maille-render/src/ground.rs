//! The shadow of the sheet on the ground below it.

use super::{bvh::Bounds, field::Field, shade::Lights};
use maille_geometry::Vec3;
use rayon::prelude::*;

/// How dark the ground is, on a grid of points.
#[derive(Debug)]
pub(super) struct Ground {
    /// Height of the ground.
    pub(super) height: f64,
    low: [f64; 2],
    step: f64,
    counts: [usize; 2],
    dark: Vec<f32>,
}

/// Darkness where the key light is hidden, and where the surroundings are.
const DARK: (f64, f64) = (0.15, 0.26);
/// As for the sheet's own shadows, but softer: the ground is to carry the sheet, not to draw its rings once more.
const SOFTNESS: f64 = 0.3;
/// Below the lowest ring, in reference radii.
const BELOW: f64 = 0.02;

impl Ground {
    /// The ground below `bounds`; `step` is the distance of the points.
    pub(super) fn new(field: &Field<'_>, lights: &Lights, bounds: Bounds, step: f64) -> Self {
        let height = bounds.low.z - BELOW;
        let far = 1.2 * (bounds.high.z - height) + 1.0;
        let low = [bounds.low.x - far, bounds.low.y - far];
        let counts =
            [bounds.high.x + far - low[0], bounds.high.y + far - low[1]].map(|x| (x / step).ceil() as usize + 1);
        let dark = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|k| {
                let x = low[0] + step * (k % counts[0]) as f64;
                let y = low[1] + step * (k / counts[0]) as f64;
                let p = Vec3::new(x, y, height);
                let light = DARK.0 * (1.0 - lights.shadow(field, &p, &Vec3::z(), 0.1, SOFTNESS));
                (light + DARK.1 * covered(field, &p)) as f32
            })
            .collect();
        Self { height, low, step, counts, dark }
    }

    /// Darkness at a point: 0 for none, 1 for black.
    pub(super) fn at(&self, p: &Vec3) -> f64 {
        let [x, y] = [(p.x - self.low[0]) / self.step, (p.y - self.low[1]) / self.step];
        let [nx, ny] = self.counts;
        let (i, j) = (x as usize, y as usize);
        if !(x >= 0.0 && y >= 0.0) || i + 1 >= nx || j + 1 >= ny {
            return 0.0;
        }
        let (u, v) = (x - i as f64, y - j as f64);
        let at = |i: usize, j: usize| f64::from(self.dark[j * nx + i]);
        let row = |j: usize| at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        row(j) * (1.0 - v) + row(j + 1) * v
    }
}

/// How much of the sky over a point of the ground is covered: at growing heights, by how much the ball that touches the
/// ground is entered. The same in all directions, so no ray leaves a streak.
fn covered(field: &Field<'_>, p: &Vec3) -> f64 {
    let heights = [0.06, 0.13, 0.25, 0.45, 0.7];
    let entered = heights.map(|h| ((h - field.at(&(p + Vec3::z() * h))) / h).clamp(0.0, 1.0));
    entered.iter().sum::<f64>() / heights.len() as f64
}
