//! Motions that repeat over the sheet as a wave: in the cell s each element moves by Re(u e^{i q·s}), with one complex u for
//! every element and a wave vector q, the phases from a cell to the next along a1 and a2 (Bloch's theorem).
//!
//! The periodic motions of a larger cell are sums of such waves, those of the q that fit into it. The Lagrangian of a
//! limit is a sum over cells, so its second derivative falls into a block for each q, and so do the rows. With the motion
//! y = A u_i + e^{i q·s} B u_j of a pair of elements in the kernel's unknowns, A and B real, it is
//!
//! u* H(q) u = −Σ μ y* ∇²g y,  on the waves with ∇g·y = 0 for each loaded row.
//!
//! The lattice takes no part where q ≠ 0. A unit wave, repeated over the larger cell, has the curvature u* H(q) u for a unit vector
//! of the larger cell's unknowns, with the multipliers of one cell.
//!
//! Unknowns: of each element that carries a translation, none of them held still, and its turns.

use super::{
    Posed, SheetProgram,
    gap_kernel::{Grad, Hess},
    key::pair_key,
    pair::{PairMap, height_angles_rad},
};
use crate::{
    lattice::Shift,
    solver::{
        certificate::{BAND, CARRIED, LOADED},
        constraints::{Derivatives, Loads, Multiplier},
        hermitian::{Modes, kept_modes},
        reduced_hessian::ZERO_MODE,
    },
    topology::motion::Motion,
};
use faer::{Mat, c64};
use maille_geometry::Vec3;

/// The waves at one locked state.
pub struct Waves {
    /// Axes of each element's turns.
    turns: Vec<Vec<Vec3>>,
    /// First unknown of each element that carries.
    first: Vec<Option<usize>>,
    /// Number of unknowns.
    n: usize,
    /// The parts of H(q).
    blocks: Vec<Block>,
    /// The loaded rows.
    rows: Vec<WaveRow>,
}

/// A part u_i* M u_i, or with a shift s the part 2 Re(u_i* e^{i q·s} M u_j).
struct Block {
    shift: Option<Shift>,
    /// First unknown of u_i and of u_j.
    first: [usize; 2],
    columns: usize,
    /// M, row by row.
    entries: Vec<f64>,
}

/// ∇g in the unknowns of the two elements, the second with the phase of a shift.
struct WaveRow {
    shift: Shift,
    parts: [(usize, Vec<f64>); 2],
}

/// The wave of least curvature with one q.
#[derive(Clone, Debug)]
pub struct WaveMode {
    /// Phases from a cell to the next along a1 and a2.
    pub phases_rad: [f64; 2],
    /// Curvature of the Lagrangian for a unit u.
    pub curvature: f64,
    /// Re and Im of each element's translation and turn.
    elements: Vec<[(Vec3, Vec3); 2]>,
}

fn phase_rad(phases_rad: [f64; 2], shift: Shift) -> f64 {
    phases_rad[0] * f64::from(shift[0]) + phases_rad[1] * f64::from(shift[1])
}

/// Motion of the kernel for each unknown of an element, as ring A's or as ring B's.
fn motions(turns: &[Vec3], as_b: bool) -> Vec<Grad> {
    let at = |block: usize, v: &Vec3| Grad::from_fn(|k, _| if k / 3 == block { v[k % 3] } else { 0.0 });
    let (sign, block) = if as_b { (1.0, 2) } else { (-1.0, 1) };
    let shifts = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| at(0, &(axis * sign)));
    shifts.into_iter().chain(turns.iter().map(|axis| at(block, axis))).collect()
}

/// The force of a flat pair spread over its heights, with the same sum and moment.
fn spread(multipliers: &[Multiplier], key: u64) -> Vec<Multiplier> {
    let of_pair = || multipliers.iter().filter(|m| m.key == key && m.value > 0.0);
    let sum = |f: fn(f64) -> f64| of_pair().map(|m| m.value * f(m.angle)).sum::<f64>();
    let (total, cos, sin) = (sum(|_| 1.0), sum(f64::cos), sum(f64::sin));
    let angles: Vec<f64> = height_angles_rad().collect();
    let share = |angle: f64| (total + 2.0 * (cos * angle.cos() + sin * angle.sin())) / angles.len() as f64;
    angles.iter().map(|&angle| Multiplier { key, angle, angle_a: 0.0, minimum: false, value: share(angle) }).collect()
}

impl SheetProgram<'_> {
    /// The waves at `x` with these multipliers, which must balance there.
    pub fn waves(&self, x: &Posed, multipliers: &[Multiplier]) -> Waves {
        let mut waves = Waves::new(self.all_turns(&x.state));
        let loads = Loads::new(multipliers);
        let local = PairMap::local();
        for near in self.near(x).iter().filter(|near| loads.carries(pair_key(&near.pair))) {
            let key = pair_key(&near.pair);
            // A flat pair's force may be written beside the heights: what counts is its sum and its moment.
            let spread = self.flat.contains(&key).then(|| Loads::new(&spread(multipliers, key)));
            let loads = spread.as_ref().unwrap_or(&loads);
            let mut rows = Vec::new();
            self.pair_rows(x, near, BAND, &local, Derivatives::Second(loads), &mut rows);
            let (mut hessian, mut gradients) = (Hess::zeros(), Vec::new());
            let carried = rows.iter().zip(loads.of(&rows)).filter(|(_, mu)| mu.abs() > CARRIED);
            for (row, mu) in carried {
                hessian -= Hess::from_row_slice(&row.hessian) * mu;
                if mu > LOADED || spread.is_some() {
                    gradients.push(Grad::from_column_slice(&row.gradient));
                }
            }
            if self.flat.contains(&key)
                && let Some(v) = self.flat_curvature(x, multipliers, key)
            {
                hessian -= v * v.transpose();
            }
            let elements = [near.pair.ring_a, near.pair.ring_b].map(|ring| self.model.rings[ring].element);
            waves.add(elements, near.pair.shift, &hessian, &gradients);
        }
        waves
    }
}

impl Waves {
    fn new(turns: Vec<Vec<Vec3>>) -> Self {
        let first = vec![None; turns.len()];
        Waves { turns, first, n: 0, blocks: Vec::new(), rows: Vec::new() }
    }

    /// Adds a pair of elements, the second at `shift`.
    fn add(&mut self, elements: [usize; 2], shift: Shift, hessian: &Hess, gradients: &[Grad]) {
        let starts = elements.map(|element| self.first(element));
        let maps = [0, 1].map(|k| motions(&self.turns[elements[k]], k == 1));
        let block = |r: usize, c: usize| -> Vec<f64> {
            let images: Vec<Grad> = maps[c].iter().map(|motion| hessian * motion).collect();
            maps[r].iter().flat_map(|motion| images.iter().map(move |image| motion.dot(image))).collect()
        };
        for (shift, [r, c]) in [(None, [0, 0]), (None, [1, 1]), (Some(shift), [0, 1])] {
            let first = [starts[r], starts[c]];
            self.blocks.push(Block { shift, first, columns: maps[c].len(), entries: block(r, c) });
        }
        for gradient in gradients {
            let part = |k: usize| (starts[k], maps[k].iter().map(|motion| motion.dot(gradient)).collect());
            self.rows.push(WaveRow { shift, parts: [part(0), part(1)] });
        }
    }

    fn first(&mut self, element: usize) -> usize {
        let size = 3 + self.turns[element].len();
        *self.first[element].get_or_insert_with(|| {
            self.n += size;
            self.n - size
        })
    }

    /// H(q), and the loaded rows.
    fn at(&self, phases_rad: [f64; 2]) -> (Mat<c64>, Vec<Vec<c64>>) {
        let turn = |shift: Shift| c64::from_polar(1.0, phase_rad(phases_rad, shift));
        let mut h = Mat::<c64>::zeros(self.n, self.n);
        for Block { shift, first: [first_r, first_c], columns, entries } in &self.blocks {
            for (k, &entry) in entries.iter().enumerate() {
                let (r, c) = (first_r + k / columns, first_c + k % columns);
                match shift {
                    None => h[(r, c)] += entry,
                    Some(shift) => {
                        let entry = turn(*shift) * entry;
                        h[(r, c)] += entry;
                        h[(c, r)] += entry.conj();
                    }
                }
            }
        }
        let row = |WaveRow { shift, parts }: &WaveRow| {
            let mut out = vec![c64::new(0.0, 0.0); self.n];
            for ((first, part), turn) in parts.iter().zip([c64::new(1.0, 0.0), turn(*shift)]) {
                part.iter().enumerate().for_each(|(k, entry)| out[first + k] += turn * *entry);
            }
            out
        };
        (h, self.rows.iter().map(row).collect())
    }

    /// The curvatures with these phases, ascending, of the elements that carry; `None` where they could not be found.
    pub fn modes(&self, phases_rad: [f64; 2]) -> Option<Modes> {
        let (h, rows) = self.at(phases_rad);
        kept_modes(&h, &rows)
    }

    /// The wave with these phases of least curvature on those that keep the loaded contacts; `None` where all are zero modes.
    pub fn least(&self, phases_rad: [f64; 2]) -> Option<WaveMode> {
        let Modes { values, vectors } = self.modes(phases_rad)?;
        let zero = ZERO_MODE * values.iter().fold(1.0f64, |a, v| a.max(v.abs()));
        let k = values.iter().position(|v| v.abs() > zero)?;
        let of = |element: usize| {
            let part = |part: fn(&c64) -> f64| {
                let Some(first) = self.first[element] else { return (Vec3::zeros(), Vec3::zeros()) };
                let at = |i: usize| part(&vectors[(first + i, k)]);
                let turns = self.turns[element].iter().enumerate();
                (Vec3::new(at(0), at(1), at(2)), turns.map(|(i, axis)| axis * at(3 + i)).sum())
            };
            [part(|x| x.re), part(|x| x.im)]
        };
        let elements = (0..self.turns.len()).map(of).collect();
        Some(WaveMode { phases_rad, curvature: values[k], elements })
    }
}

impl WaveMode {
    /// The wave as a motion of a larger cell. `copies` are those of the design's cell in its order, each with its number in the solved cell
    /// and the image of that cell; the largest component is `size`.
    pub(crate) fn motion(&self, copies: &[(usize, Shift)], size: f64) -> Motion {
        let components = self.elements.iter().flatten().flat_map(|(shift, turn)| [shift.amax(), turn.amax()]);
        let scale = size / components.fold(f64::MIN_POSITIVE, f64::max);
        let own = 1 + copies.iter().map(|(copy, _)| *copy).max().unwrap_or(0);
        let each = self.elements.len() / own;
        let elements = copies.iter().flat_map(|&(copy, image)| {
            let (sin, cos) = phase_rad(self.phases_rad, image).sin_cos();
            let part = move |re: Vec3, im: Vec3| (re * cos - im * sin) * scale;
            let elements = &self.elements[copy * each..(copy + 1) * each];
            elements.iter().map(move |[re, im]| (part(re.0, im.0), part(re.1, im.1)))
        });
        Motion { elements: elements.collect(), ..Motion::default() }
    }
}
