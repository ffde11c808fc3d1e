//! Cells of a plane lattice: supercells, the images within reach, directions, and what of a stretch is held or free.

use maille_design::InvalidInput;
use maille_geometry::Vec3;
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};
use std::{f64::consts::TAU, fmt, str::FromStr};

/// Shift of an image: the number of lattice vectors a1 and a2 from the main cell.
pub type Shift = [i32; 2];

/// A cell of the design's lattice: rows of integers (m11, m12; m21, m22) with
/// a1' = m11 a1 + m12 a2 and a2' = m21 a1 + m22 a2. Its elements are |det| copies of the primitive cell's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Cell {
    rows: [[i32; 2]; 2],
}

impl Default for Cell {
    fn default() -> Self {
        Cell::PRIMITIVE
    }
}

impl Cell {
    /// The design's own cell.
    pub const PRIMITIVE: Cell = Cell { rows: [[1, 0], [0, 1]] };

    /// A cell from its rows; refused where they are dependent or of more than 10,000 copies.
    pub fn new(rows: [[i32; 2]; 2]) -> Result<Self, InvalidInput> {
        let wide = rows.map(|row| row.map(i64::from));
        let det = wide[0][0].saturating_mul(wide[1][1]).saturating_sub(wide[0][1].saturating_mul(wide[1][0]));
        match det.unsigned_abs() {
            0 => Err(InvalidInput::new(
                "cell",
                format!("{rows:?} has determinant 0"),
                "give two independent rows, as \"1,0;-1,2\"",
            )),
            1..=10_000 => Ok(Cell { rows }),
            n => Err(InvalidInput::new(
                "cell",
                format!("{rows:?} has {n} copies of the cell"),
                "at most 10,000 are possible",
            )),
        }
    }

    /// Its rows.
    pub(crate) fn rows(&self) -> [[i32; 2]; 2] {
        self.rows
    }

    /// Number of primitive cells in this one: |det|.
    pub fn copies(&self) -> usize {
        self.det().unsigned_abs() as usize
    }

    fn det(&self) -> i64 {
        let m = self.rows.map(|row| row.map(i64::from));
        m[0][0] * m[1][1] - m[0][1] * m[1][0]
    }

    /// The lattice vectors of this cell for those of the primitive one.
    pub(crate) fn vectors(&self, a1: Vec3, a2: Vec3) -> [Vec3; 2] {
        self.rows.map(|[m, n]| f64::from(m) * a1 + f64::from(n) * a2)
    }

    /// The primitive lattice vectors for those of this cell: the inverse of [`vectors`](Self::vectors).
    pub(crate) fn primitive(&self, a1: Vec3, a2: Vec3) -> [Vec3; 2] {
        let ([[m11, m12], [m21, m22]], det) = (self.rows.map(|row| row.map(f64::from)), self.det() as f64);
        [(m22 * a1 - m12 * a2) / det, (m11 * a2 - m21 * a1) / det]
    }

    /// Whether both have the same translations.
    pub(crate) fn same_lattice(&self, other: &Cell) -> bool {
        let ([[m11, m12], [m21, m22]], det) = (self.rows.map(|row| row.map(i64::from)), self.det());
        // Coordinates in this cell: adjugate · row / det.
        let inside = |[p, q]: [i32; 2]| {
            let (p, q) = (i64::from(p), i64::from(q));
            (p * m22 - q * m21) % det == 0 && (q * m11 - p * m12) % det == 0
        };
        self.copies() == other.copies() && other.rows.into_iter().all(inside)
    }

    /// One primitive shift for each copy, (0, 0) first, in lexicographic order after it.
    ///
    /// Two primitive shifts are the same copy when they differ by a vector of this cell's lattice: their
    /// coordinates in it (adjugate · shift mod det) agree.
    pub(crate) fn cosets(&self) -> Vec<Shift> {
        let [[m11, m12], [m21, m22]] = self.rows.map(|row| row.map(i64::from));
        let det = self.det();
        let key =
            |p: i64, q: i64| ((p * m22 - q * m21).rem_euclid(det.abs()), (q * m11 - p * m12).rem_euclid(det.abs()));
        let (mut seen, mut out) = (std::collections::BTreeSet::new(), Vec::new());
        let copies = self.copies() as i64;
        'shells: for shell in 0..=copies {
            for p in 0..=shell {
                for q in 0..=shell {
                    if (p == shell || q == shell) && seen.insert(key(p, q)) {
                        out.push([p as i32, q as i32]);
                        if out.len() as i64 == copies {
                            break 'shells;
                        }
                    }
                }
            }
        }
        out.sort_unstable();
        out
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.rows {
            [[m, 0], [0, n]] if m > 0 && n > 0 => write!(f, "{m}x{n}"),
            [[a, b], [c, d]] => write!(f, "{a},{b};{c},{d}"),
        }
    }
}

impl From<Cell> for String {
    fn from(cell: Cell) -> Self {
        cell.to_string()
    }
}

impl Cell {
    /// The cells of `n` copies, one for each lattice: (a, 0; b, d) with a d = n and 0 ≤ b < a, those without b first.
    pub(crate) fn of_copies(n: i32) -> impl Iterator<Item = Cell> {
        let factors = (1..=n).filter(move |a| n % a == 0);
        factors.flat_map(move |a| (0..a).map(move |b| Cell { rows: [[a, 0], [b, n / a]] }))
    }

    /// The cell whose lattice vectors have the rows of `by` in those of this one; `None` where it would have too many copies.
    pub(crate) fn repeated(&self, by: &Cell) -> Option<Cell> {
        let row = |[m, n]: [i32; 2]| [0, 1].map(|k| m * self.rows[0][k] + n * self.rows[1][k]);
        Cell::new(by.rows.map(row)).ok()
    }

    /// Which of this cell's copies `place` is, in the order of [`cosets`](Self::cosets), and in which image of the cell.
    pub(crate) fn copy_at(&self, place: Shift) -> (usize, Shift) {
        let ([[m11, m12], [m21, m22]], det) = (self.rows.map(|row| row.map(i64::from)), self.det());
        let image = |coset: Shift| {
            let [p, q] = [0, 1].map(|k| i64::from(place[k]) - i64::from(coset[k]));
            let [s, t] = [p * m22 - q * m21, q * m11 - p * m12];
            (s % det == 0 && t % det == 0).then(|| [(s / det) as i32, (t / det) as i32])
        };
        let found = self.cosets().into_iter().enumerate().find_map(|(k, coset)| Some((k, image(coset)?)));
        found.unwrap_or_else(|| unreachable!("each place is one of the copies"))
    }

    /// Whether a wave with these phases fits into this cell.
    pub fn holds_wave(&self, phases_rad: [f64; 2]) -> bool {
        self.rows.iter().all(|[k, l]| {
            let turns = (phases_rad[0] * f64::from(*k) + phases_rad[1] * f64::from(*l)) / TAU;
            (turns - turns.round()).abs() < 1e-9
        })
    }
}

impl TryFrom<String> for Cell {
    type Error = InvalidInput;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

impl FromStr for Cell {
    type Err = InvalidInput;

    fn from_str(text: &str) -> Result<Self, InvalidInput> {
        let wrong = || {
            InvalidInput::new(
                "cell",
                format!("\"{text}\" is not a cell"),
                "give 2x1, or an integer matrix as \"1,0;-1,2\"",
            )
        };
        let integer = |t: &str| t.trim().parse::<i32>().map_err(|_| wrong());
        if let Some((m, n)) = text.split_once('x') {
            let (m, n) = (integer(m)?, integer(n)?);
            if m < 1 || n < 1 {
                return Err(wrong());
            }
            return Cell::new([[m, 0], [0, n]]);
        }
        let (first, second) = text.split_once(';').ok_or_else(wrong)?;
        let row = |t: &str| -> Result<[i32; 2], InvalidInput> {
            let (a, b) = t.split_once(',').ok_or_else(wrong)?;
            Ok([integer(a)?, integer(b)?])
        };
        Cell::new([row(first)?, row(second)?])
    }
}

/// What of a pull is left to the sheet. With D⊥ to the left of D,
///
/// F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ + γ D D⊥ᵀ:
///
/// lines along D stay along D and are stretched by 1 + l1; 1 + l2 is the width across them, γ how far a line across the pull
/// comes to lean along it, for each unit of its length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Across {
    /// Whether l2 is free.
    pub lateral_free: bool,
    /// Whether γ is free; otherwise it is 0.
    pub shear_free: bool,
}

impl Across {
    /// Width and shear held.
    pub const HELD: Across = Across { lateral_free: false, shear_free: false };

    /// Whether something is free.
    pub(crate) fn any(self) -> bool {
        self != Self::HELD
    }
}

/// All shifts s with |offset + s1 a1 + s2 a2| ≤ reach, in lexicographic order.
///
/// Listed by distance, not by layers of cells: in a strongly sheared cell a linked image can be many layers away.
/// With the dual vectors b_k of the plane lattice (b_k · a_l = δ_kl), |s_k + b_k · offset| ≤ reach |b_k|.
#[doc(hidden)]
pub fn shifts_within(offset: &Vec3, a1: &Vec3, a2: &Vec3, reach: f64) -> Vec<Shift> {
    let (g11, g12, g22) = (a1.norm_squared(), a1.dot(a2), a2.norm_squared());
    let det = g11 * g22 - g12 * g12;
    let b1 = (a1 * g22 - a2 * g12) / det;
    let b2 = (a2 * g11 - a1 * g12) / det;
    let range = |b: &Vec3| {
        let (mid, half) = (-b.dot(offset), reach * b.norm());
        (mid - half).ceil() as i32..=(mid + half).floor() as i32
    };
    let mut out = Vec::new();
    for m in range(&b1) {
        for n in range(&b2) {
            if (offset + a1 * f64::from(m) + a2 * f64::from(n)).norm_squared() <= reach * reach {
                out.push([m, n]);
            }
        }
    }
    out
}

/// The shortest basis of the plane lattice of a1 and a2 (Gauss's reduction), as a cell of one copy. A basis that is short
/// already is kept as it is.
pub(crate) fn short_basis(a1: Vec3, a2: Vec3) -> Cell {
    let (mut rows, mut basis) = ([[1, 0], [0, 1]], [a1, a2]);
    // Each round shortens a vector; a nearly flat cell may run out of digits or of integers first, which does no harm.
    for _ in 0..100 {
        let k = usize::from(basis[0].norm_squared() < basis[1].norm_squared());
        let times = (basis[0].dot(&basis[1]) / basis[1 - k].norm_squared()).round();
        // Ties are kept: a hexagonal basis is short with either sign.
        let shorter = basis[k] - times * basis[1 - k];
        if times == 0.0 || times.abs() > 1e6 || shorter.norm_squared() >= basis[k].norm_squared() * (1.0 - 1e-9) {
            break;
        }
        let entry = |j: usize| i32::checked_sub(rows[k][j], i32::checked_mul(times as i32, rows[1 - k][j])?);
        let Some(row) = entry(0).zip(entry(1)) else { break };
        (basis[k], rows[k]) = (shorter, [row.0, row.1]);
    }
    Cell { rows }
}

/// A vector lies across a direction if its part along it is at most this share of it: as much as rounding leaves there of a
/// direction in degrees (up to 360°, turned into radians: 1.4e-15) and of two products.
pub(crate) const ACROSS: f64 = 16.0 * f64::EPSILON;

/// A direction in the plane of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    degrees: f64,
    along: Vector2<f64>,
}

/// See [`Direction::shortest_vector`].
const FARTHEST_VECTOR: i32 = 32;

impl Direction {
    /// At an angle counter-clockwise from x, exact at multiples of 90°.
    pub fn of_degrees(degrees: f64) -> Self {
        let turn = degrees.rem_euclid(360.0);
        let along = match turn {
            0.0 => Vector2::new(1.0, 0.0),
            90.0 => Vector2::new(0.0, 1.0),
            180.0 => Vector2::new(-1.0, 0.0),
            270.0 => Vector2::new(0.0, -1.0),
            _ => Vector2::new(turn.to_radians().cos(), turn.to_radians().sin()),
        };
        Direction { degrees, along }
    }

    /// The angle, as it was given.
    pub fn degrees(self) -> f64 {
        self.degrees
    }

    /// D, its unit vector.
    pub fn along(self) -> Vector2<f64> {
        self.along
    }

    /// The shortest vector of a lattice along it, in its lattice vectors; `None` where none of up to [`FARTHEST_VECTOR`] steps along each is.
    pub(crate) fn shortest_vector(self, [a1, a2]: [Vec3; 2]) -> Option<Shift> {
        let along = |[m, n]: Shift| {
            let v = (a1 * f64::from(m) + a2 * f64::from(n)).xy();
            let forward = v.dot(&self.along);
            (forward > 0.0 && (v - self.along * forward).norm() < 1e-9 * forward).then_some(forward)
        };
        let steps = -FARTHEST_VECTOR..=FARTHEST_VECTOR;
        let all = steps.clone().flat_map(|m| steps.clone().map(move |n| [m, n]));
        let found = all.filter_map(|shift| Some((along(shift)?, shift)));
        found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, shift)| shift)
    }

    /// D⊥, the unit vector to its left.
    pub fn across(self) -> Vector2<f64> {
        Vector2::new(-self.along.y, self.along.x)
    }

    /// l1 and l2 of a deformation gradient, given by rows: D·F D − 1 and D⊥·F D⊥ − 1.
    pub fn stretches(self, [[a, b], [c, d]]: &[[f64; 2]; 2]) -> [f64; 2] {
        let f = Matrix2::new(*a, *b, *c, *d);
        [self.along(), self.across()].map(|v| v.dot(&(f * v)) - 1.0)
    }

    /// The direction of D⊥.
    pub(crate) fn left(self) -> Direction {
        Direction::of_degrees(self.degrees + 90.0)
    }

    /// F of a stretch, see [`Across`].
    #[doc(hidden)]
    pub fn gradient(self, l1: f64, l2: f64, shear: f64) -> Matrix2<f64> {
        let (d, across) = (self.along(), self.across());
        let held = d * d.transpose() * (1.0 + l1) + across * across.transpose() * (1.0 + l2);
        if shear == 0.0 { held } else { held + d * across.transpose() * shear }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_read_as_they_are_written() {
        for text in ["1x1", "2x1", "3x3", "1,0;-1,2", "0,1;1,0"] {
            assert_eq!(text.parse::<Cell>().unwrap().to_string(), text);
        }
        for text in ["", "2", "0x1", "x", "1,2;2,4", "1,0", "a,b;c,d", "-1x2", "200x200"] {
            assert!(text.parse::<Cell>().is_err(), "{text}");
        }
    }

    #[test]
    fn cosets_are_all_the_copies() {
        for (text, n) in [("1x1", 1), ("2x3", 6), ("1,0;-1,2", 2), ("2,1;-1,2", 5), ("-2,0;0,2", 4)] {
            let cell: Cell = text.parse().unwrap();
            let cosets = cell.cosets();
            assert_eq!(cosets.len(), n, "{text}: {cosets:?}");
            assert_eq!(cosets[0], [0, 0]);
        }
    }

    #[test]
    fn cells_of_cells() {
        let cell = |text: &str| text.parse::<Cell>().unwrap();
        assert_eq!(cell("2x1").repeated(&cell("2x1")), Some(cell("4x1")));
        assert_eq!(cell("1,1;-1,1").repeated(&cell("1,1;-1,1")), Some(cell("0,2;-2,0")));
        for text in ["1x1", "2x1", "1,1;-1,1", "3,0;1,2"] {
            let cell = cell(text);
            let cosets = cell.cosets();
            for (p, q) in (-3..4).flat_map(|p| (-3..4).map(move |q| (p, q))) {
                let (copy, [s, t]) = cell.copy_at([p, q]);
                let back = [0, 1].map(|k| cosets[copy][k] + s * cell.rows[0][k] + t * cell.rows[1][k]);
                assert_eq!(back, [p, q], "{text}");
            }
        }
    }

    #[test]
    fn waves_that_fit() {
        let cell = |text: &str| text.parse::<Cell>().unwrap();
        for (text, turns, fits) in [
            ("2x1", [0.5, 0.0], true),
            ("2x1", [0.0, 0.5], false),
            ("3x3", [1.0 / 3.0, -1.0 / 3.0], true),
            ("2x2", [1.0 / 3.0, 0.0], false),
            ("1,1;-1,1", [0.5, 0.5], true),
            ("1,1;-1,1", [0.5, 0.0], false),
        ] {
            assert_eq!(cell(text).holds_wave(turns.map(|t| TAU * t)), fits, "{text} {turns:?}");
        }
        // The number of sublattices is the sum of the divisors.
        for (n, count) in [(1, 1), (2, 3), (3, 4), (4, 7), (5, 6), (6, 12)] {
            let cells: Vec<Cell> = Cell::of_copies(n).collect();
            assert!(cells.len() == count && cells.iter().all(|cell| cell.copies() == n as usize));
            let twice = |k: usize| cells[..k].iter().any(|other| other.same_lattice(&cells[k]));
            assert!(!(0..count).any(twice));
        }
    }

    #[test]
    fn bases_of_one_lattice_are_the_same() {
        let cell = |text: &str| text.parse::<Cell>().unwrap();
        for (a, b, same) in [
            ("2x1", "2,0;0,-1", true),
            ("2x1", "2,1;0,1", true),
            ("2x1", "1x2", false),
            ("2x1", "1,1;-1,1", false),
            ("2x2", "0,2;2,0", true),
            ("2x2", "4x1", false),
            ("1x1", "1,57;0,1", true),
        ] {
            assert_eq!((cell(a).same_lattice(&cell(b)), cell(b).same_lattice(&cell(a))), (same, same), "{a} {b}");
        }
    }

    #[test]
    fn short_basis_of_a_sheared_lattice() {
        let (a1, a2) = (Vec3::new(2.5, 0.0, 0.0), Vec3::new(0.3, 2.6, 0.0));
        assert_eq!(short_basis(a1, a2), Cell::PRIMITIVE);
        for cell in ["1,0;57,1", "1,0;-3,1", "5,2;7,3", "21,-13;34,-21"] {
            let cell: Cell = cell.parse().unwrap();
            let [b1, b2] = cell.vectors(a1, a2);
            let short = short_basis(b1, b2);
            assert_eq!(short.copies(), 1);
            let mut lengths = short.vectors(b1, b2).map(|b| b.norm());
            lengths.sort_by(f64::total_cmp);
            assert!(
                (lengths[0] - a1.norm()).abs() < 1e-12 && (lengths[1] - a2.norm()).abs() < 1e-12,
                "{cell}: {short}"
            );
        }
        // A hexagonal basis, and its other one.
        let half = 0.75_f64.sqrt();
        for x in [0.5, -0.5] {
            assert_eq!(short_basis(Vec3::x(), Vec3::new(x, half, 0.0)), Cell::PRIMITIVE);
        }
    }

    #[test]
    fn sheared_basis_lists_the_same_images() {
        let (a1, a2) = (Vec3::new(2.5, 0.0, 0.0), Vec3::new(0.0, 2.5, 0.0));
        let sheared = a2 + 7.0 * a1;
        let offset = Vec3::new(0.3, -0.4, 0.2);
        let points = |b2: &Vec3| {
            let mut p: Vec<_> = shifts_within(&offset, &a1, b2, 6.0)
                .iter()
                .map(|s| a1 * f64::from(s[0]) + b2 * f64::from(s[1]))
                .map(|v| ((v.x * 1e6).round() as i64, (v.y * 1e6).round() as i64))
                .collect();
            p.sort_unstable();
            p
        };
        assert_eq!(points(&a2), points(&sheared));
        assert!(points(&a2).len() > 15);
    }
}
