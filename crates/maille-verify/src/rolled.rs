//! Images of a rolled sheet: rotations about one axis, and shifts along it.
//!
//! With u the direction that is rolled, w = e_z × u, and α = a·u, β = a·w, θ of a lattice vector a, the axis lies along w through −h e_z,
//! h = α/θ, which is one number for all of them. The image of a point is turned by θ about it and shifted by β w.
//!
//! An endless sheet lies on itself after a turn. Two elements count for each other where their places in the written sheet are at most
//! half a turn apart, and where one link or two join them.
//!
//! A turn is known from a state up to whole turns. Along links, each gone by the lesser way about the axis, one comes from an element to its
//! image by the turn of that image, or the axis has passed through the sheet. While it passes through an element, nearer to its reference
//! point than its rings reach, this is left open.

use nalgebra::{Isometry3, Matrix2, Point3, Translation3, Unit, UnitQuaternion, Vector2, Vector3};
use std::{collections::BTreeSet, f64::consts::PI};

type Vec3 = Vector3<f64>;

/// How far h of one lattice vector may be from that of the other, by its size.
const ONE_AXIS: f64 = 1e-9;
/// Half a turn, with what rounding may add.
const HALF_RAD: f64 = PI * (1.0 + 1e-12);

/// The motions of the images of a sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motions {
    /// u.
    pub along: Vec3,
    /// θ of both lattice vectors.
    pub turn_rad: [f64; 2],
}

/// How the images of a sheet are turned, and which of them count.
#[derive(Clone, Debug)]
pub(crate) struct Rolled {
    /// The motions.
    pub motions: Motions,
    /// The places of the elements in the written sheet, in lattice vectors.
    pub places: Vec<[f64; 2]>,
    /// Pairs of elements that a link joins, seen from both.
    pub linked: BTreeSet<Elements>,
    /// Those that one link or two join.
    pub joined: BTreeSet<Elements>,
}

/// Two elements, the second in the cell with this shift.
pub(crate) type Elements = ([usize; 2], [i32; 2]);

/// Motions that differ by less are one.
const SAME_RAD: f64 = 1e-6;

/// The pairs of elements that links join, and those that one link or two join, both ways.
pub(crate) fn joined(links: impl IntoIterator<Item = Elements>) -> (BTreeSet<Elements>, BTreeSet<Elements>) {
    let mut linked: BTreeSet<Elements> = BTreeSet::new();
    for ([i, j], [m, n]) in links {
        linked.extend([([i, j], [m, n]), ([j, i], [-m, -n])]);
    }
    let mut all = linked.clone();
    for &([i, j], [m, n]) in &linked {
        let from_second = linked.range(([j, 0], [i32::MIN; 2])..=([j, usize::MAX], [i32::MAX; 2]));
        all.extend(from_second.map(|&([_, k], [p, q])| ([i, k], [m + p, n + q])));
    }
    all.retain(|(elements, shift)| elements[0] != elements[1] || *shift != [0, 0]);
    (linked, all)
}

impl Motions {
    /// w.
    pub fn axis(&self) -> Vec3 {
        Vec3::z().cross(&self.along)
    }

    fn turn(&self, at: [f64; 2]) -> f64 {
        self.turn_rad[0] * at[0] + self.turn_rad[1] * at[1]
    }

    /// h, of the lattice vector that is turned most.
    pub fn axis_distance(&self, lattice: [Vec3; 2]) -> f64 {
        let k = usize::from(self.turn_rad[1].abs() > self.turn_rad[0].abs());
        lattice[k].dot(&self.along) / self.turn_rad[k]
    }

    /// What makes these no motions about one axis, if something does.
    pub fn contradiction(&self, lattice: [Vec3; 2]) -> Option<String> {
        let h = self.axis_distance(lattice);
        if !h.is_finite() {
            return Some("no lattice vector is turned".into());
        }
        let off = |k: usize| (lattice[k].dot(&self.along) - h * self.turn_rad[k]).abs();
        let worst = off(0).max(off(1)) / (lattice[0].norm() + lattice[1].norm());
        (worst > ONE_AXIS).then(|| format!("the turns of the lattice vectors are about two axes, {worst:.1e} apart"))
    }

    /// The motion to the image `shift`.
    pub fn image(&self, lattice: [Vec3; 2], shift: [i32; 2]) -> Isometry3<f64> {
        let at = shift.map(f64::from);
        let beside = (lattice[0] * at[0] + lattice[1] * at[1]).dot(&self.axis());
        let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(self.axis()), self.turn(at));
        let center = Point3::from(-Vec3::z() * self.axis_distance(lattice));
        let about = Isometry3::rotation_wrt_point(turn, center);
        Translation3::from(self.axis() * beside) * about
    }
}

impl Rolled {
    /// Shifts of the images of element j that count for element i and may be within `reach` of it, and of all that links join to it, `beside` being the way along the axis from the
    /// one ring's centre to the other's: with x = θ and y = β of the way to an image, |x| is at most half a turn and |y| at most the reach.
    pub fn shifts(
        &self,
        lattice: [Vec3; 2],
        [i, j]: [usize; 2],
        beside: f64,
        reach: f64,
    ) -> Result<Vec<[i32; 2]>, String> {
        let [b1, b2] = lattice.map(|a| a.dot(&self.motions.axis()));
        let [t1, t2] = self.motions.turn_rad;
        let inverse = Matrix2::new(t1, t2, b1, b2).try_inverse().ok_or("the lattice vectors are parallel")?;
        let between = self.between([i, j]);
        let mid = inverse * Vector2::new(-self.motions.turn(between), -beside);
        let range = |k: usize| {
            let half = inverse[(k, 0)].abs() * HALF_RAD + inverse[(k, 1)].abs() * reach;
            (mid[k] - half * 1.001 - 1e-6).ceil()..=(mid[k] + half * 1.001 + 1e-6).floor()
        };
        let (m, n) = (range(0), range(1));
        if (m.end() - m.start() + 1.0) * (n.end() - n.start() + 1.0) > 1e7 {
            return Err("more than ten million images are in range".into());
        }
        let rows = *m.start() as i32..=*m.end() as i32;
        let all = rows.flat_map(|p| (*n.start() as i32..=*n.end() as i32).map(move |q| [p, q]));
        let near = all.filter(|shift| self.within_half([i, j], *shift));
        let joined = self.joined.range(([i, j], [i32::MIN; 2])..=([i, j], [i32::MAX; 2])).map(|(_, shift)| *shift);
        Ok(near.chain(joined).collect::<BTreeSet<_>>().into_iter().collect())
    }

    fn between(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.places[j][k] - self.places[i][k])
    }

    /// Whether the image of element j counts for element i.
    pub fn counts(&self, elements: [usize; 2], shift: [i32; 2]) -> bool {
        self.within_half(elements, shift) || self.joined.contains(&(elements, shift))
    }

    /// Whether the axis has passed through the sheet, whose elements lie at `positions` and reach so far.
    pub fn has_axis_inside(&self, lattice: [Vec3; 2], positions: &[Vec3], reaches: &[f64]) -> bool {
        let axis = self.motions.axis();
        let from_axis = |position: &Vec3| {
            let way = position + Vec3::z() * self.motions.axis_distance(lattice);
            way - axis * way.dot(&axis)
        };
        let places: Vec<Vec3> = positions.iter().map(from_axis).collect();
        if places.iter().zip(reaches).any(|(place, reach)| place.norm() <= *reach) {
            return false;
        }
        // The turn at which each element is reached along links, its own turn about the axis taken out.
        let mut reached: Vec<Option<f64>> = vec![None; places.len()];
        for root in 0..places.len() {
            let mut queue = if reached[root].is_none() { vec![root] } else { Vec::new() };
            reached[root] = reached[root].or(Some(0.0));
            while let Some(i) = queue.pop() {
                let from_i = self.linked.range(([i, 0], [i32::MIN; 2])..=([i, usize::MAX], [i32::MAX; 2]));
                for &([_, j], shift) in from_i {
                    let turn = self.motions.turn(shift.map(f64::from));
                    let there = UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), turn) * places[j];
                    let lesser = axis.dot(&places[i].cross(&there)).atan2(places[i].dot(&there));
                    let at = reached[i].unwrap_or_default() + lesser - turn;
                    match reached[j] {
                        None => {
                            reached[j] = Some(at);
                            queue.push(j);
                        }
                        Some(known) if (known - at).abs() > SAME_RAD => return true,
                        Some(_) => {}
                    }
                }
            }
        }
        false
    }

    fn within_half(&self, elements: [usize; 2], shift: [i32; 2]) -> bool {
        let between = self.between(elements);
        self.motions.turn([0, 1].map(|k| f64::from(shift[k]) + between[k])).abs() <= HALF_RAD
    }
}
