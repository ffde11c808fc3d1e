//! The broad phase: which elements may be near each other, at a cost that grows with their number.

use super::window;
use crate::{
    lattice::{Shift, shifts_within},
    model::Model,
    state::State,
};
use maille_geometry::Vec3;
use rayon::prelude::*;

/// Up to this many elements each is compared with each.
const FEW: usize = 24;
/// The work that a thread takes at a time.
pub(crate) const CHUNK: usize = 256;

/// `of` applied to pieces of `items`, the results in the order of the pieces, whatever the number of threads.
pub(crate) fn in_chunks<T: Sync, R: Send>(items: &[T], of: impl Fn(&[T]) -> Vec<R> + Sync) -> Vec<R> {
    match items.len() <= CHUNK {
        true => of(items),
        false => {
            let parts: Vec<Vec<R>> = items.par_chunks(CHUNK).map(&of).collect();
            let mut out = Vec::with_capacity(parts.iter().map(Vec::len).sum());
            parts.into_iter().for_each(|part| out.extend(part));
            out
        }
    }
}

/// Elements sorted into the cubes of a grid.
struct Grid {
    least: Vec3,
    edge: f64,
    size: [usize; 3],
    /// Elements cube by cube, ascending in each.
    first: Vec<u32>,
    elements: Vec<u32>,
}

impl Grid {
    /// With cubes not smaller than `reach`, and not many more of them than elements.
    fn new(positions: &[Vec3], reach: f64) -> Self {
        let least = positions.iter().fold(positions[0], |m, p| m.inf(p));
        let extent = positions.iter().fold(least, |m, p| m.sup(p)) - least;
        let mut edge = reach;
        let sizes = |edge: f64| [extent.x, extent.y, extent.z].map(|x| (x / edge) as usize + 1);
        while sizes(edge).iter().map(|s| *s as f64).product::<f64>() > 4.0 * positions.len() as f64 {
            edge *= 1.5;
        }
        let size = sizes(edge);
        let mut grid = Grid { least, edge, size, first: Vec::new(), elements: vec![0; positions.len()] };
        let cubes: Vec<usize> = positions.iter().map(|p| grid.index(grid.cube(p))).collect();
        let mut first = vec![0u32; size.iter().product::<usize>() + 1];
        cubes.iter().for_each(|c| first[c + 1] += 1);
        (1..first.len()).for_each(|c| first[c] += first[c - 1]);
        let mut next = first.clone();
        for (element, &cube) in cubes.iter().enumerate() {
            grid.elements[next[cube] as usize] = element as u32;
            next[cube] += 1;
        }
        grid.first = first;
        grid
    }

    fn cube(&self, p: &Vec3) -> [isize; 3] {
        let at = (p - self.least) / self.edge;
        [at.x.floor() as isize, at.y.floor() as isize, at.z.floor() as isize]
    }

    fn index(&self, [x, y, z]: [isize; 3]) -> usize {
        (z as usize * self.size[1] + y as usize) * self.size[0] + x as usize
    }

    /// Calls `each` with the elements of the cubes around `p`: all those within the cubes' edge, and others.
    fn around(&self, p: &Vec3, mut each: impl FnMut(usize)) {
        let [x, y, z] = self.cube(p);
        let range = |k: isize, axis: usize| (k - 1).max(0)..(k + 2).min(self.size[axis] as isize);
        for z in range(z, 2) {
            for y in range(y, 1) {
                for x in range(x, 0) {
                    let cube = self.index([x, y, z]);
                    let (from, to) = (self.first[cube] as usize, self.first[cube + 1] as usize);
                    self.elements[from..to].iter().for_each(|e| each(*e as usize));
                }
            }
        }
    }
}

/// For every element i the elements j ≥ i with the shifts s, sorted, whose core circles may come within `margin` plus
/// both minor radii of each other: |x_j + s − x_i| ≤ reach_i + reach_j + 2 `thickest` + `margin`. Of an element's own images
/// the lexicographically positive ones.
pub(super) fn neighbours(model: &Model, state: &State, thickest: f64, margin: f64) -> Vec<Vec<(usize, Shift)>> {
    if let Some(roll) = &state.roll {
        return window::neighbours(model, state, roll, thickest, margin);
    }
    let n = model.elements.len();
    let reach = |i: usize, j: usize| model.elements[i].reach + model.elements[j].reach + 2.0 * thickest + margin;
    let counts = |i: usize, j: usize, shift: Shift| i < j || (i == j && shift > [0, 0]);
    if n <= FEW {
        let of = |i: usize| {
            let mut out = Vec::new();
            for j in i..n {
                let offset = state.poses[j].position - state.poses[i].position;
                let shifts = match model.periodic {
                    true => shifts_within(&offset, &state.a1, &state.a2, reach(i, j)),
                    false if offset.norm_squared() <= reach(i, j).powi(2) => vec![[0, 0]],
                    false => continue,
                };
                out.extend(shifts.into_iter().filter(|s| counts(i, j, *s)).map(|s| (j, s)));
            }
            out
        };
        return (0..n).map(of).collect();
    }
    let positions: Vec<Vec3> = state.poses.iter().map(|p| p.position).collect();
    let widest = model.elements.iter().map(|e| e.reach).fold(0.0, f64::max);
    let farthest = 2.0 * (widest + thickest) + margin;
    let grid = Grid::new(&positions, farthest);
    let center = positions.iter().sum::<Vec3>() / n as f64;
    let spread = positions.iter().map(|p| (p - center).norm()).fold(0.0, f64::max);
    let of = |i: usize| {
        let mut out = Vec::new();
        // The element stays and its neighbours' images come, or they stay and it goes the other way.
        let shifts = match model.periodic {
            true => shifts_within(&(center - positions[i]), &state.a1, &state.a2, spread + farthest),
            false => vec![[0, 0]],
        };
        for shift in shifts {
            let there = positions[i] - state.translation(shift);
            grid.around(&there, |j| {
                let near = || (positions[j] - there).norm_squared() <= reach(i, j).powi(2);
                if counts(i, j, shift) && near() {
                    out.push((j, shift));
                }
            });
        }
        out.sort_unstable();
        out
    };
    let all: Vec<usize> = (0..n).collect();
    in_chunks(&all, |some| some.iter().map(|&i| of(i)).collect())
}
