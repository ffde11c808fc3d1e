//! The cell of a claim: two rings, a direction, a width, and the boxes that hold all its states.

use super::{
    direction::cos_sin,
    form::{Form, Forms, UNKNOWNS, cross, dot},
    piece::{Piece, Rings, Side},
};
use crate::record::Design;

/// Copies of the cell in which links of the design are sought.
const REACH: i32 = 8;
/// Copies of the cell in which rings that could touch are listed.
const NEAR: i32 = 4;

/// Two rings, the second in the cell `shift`.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Which rings, 0 or 1; the first is not after the second.
    pub rings: [usize; 2],
    /// Which copy the second is.
    pub shift: [i32; 2],
    /// That translation along D and D⊥ in the undeformed cell.
    pub(crate) step: [Form; 2],
    /// Of linked rings, the sign of (c_b − c_a)·(n_a × n_b) in the design.
    pub sign: Option<f64>,
    /// Sum of the minor radii, rounded down.
    pub touching: f64,
}

/// A cell of two rings with a direction and a width, in a unit in which radii are near 1.
#[derive(Clone, Debug)]
pub struct Cell {
    pub(crate) radii: [f64; 2],
    wires: [f64; 2],
    /// 1 + l2.
    pub(crate) across: Form,
    /// The linked pairs, then all others that might touch.
    pub pairs: Vec<Pair>,
    /// The rings are alike, so that they can be exchanged.
    alike: bool,
    /// Boxes that hold, up to symmetries of the cell, all its states with 1 + l1 above the least.
    pub roots: Vec<Piece>,
}

/// The same for both orders of signs.
fn flipped(sign: f64, by: f64) -> bool {
    sign * by > 0.0
}

impl Cell {
    /// The cell of a design, and all its states with l1 of at least `l1_from`. What is wrong with the question otherwise.
    pub(crate) fn new(design: &Design, direction_deg: f64, l2: f64, l1_from: f64) -> Result<Cell, String> {
        if !design.is_round() {
            return Err("the cell has curves; proofs are of rings alone".into());
        }
        let rings: Vec<_> = design.elements.iter().flat_map(|e| e.rings.iter().map(move |ring| (e, ring))).collect();
        let ([(e0, r0), (e1, r1)], 2) = (&rings[..], design.elements.len()) else {
            let (elements, rings) = (design.elements.len(), rings.len());
            return Err(format!(
                "the cell has {elements} elements and {rings} rings, not two elements of one ring each"
            ));
        };
        if !(direction_deg.is_finite() && l2 > -1.0 && l1_from > -1.0 && l2.is_finite() && l1_from.is_finite()) {
            return Err("direction, l2 and l1 are finite numbers, l2 and l1 above -1".into());
        }
        // A power of two: exact.
        let unit = power_of_two(r0.major_radius).ok_or("a major radius that is no positive number")?;
        let wire = |ring: &crate::record::Ring| ring.minor_radius.or(design.minor_radius).ok_or("no minor radius");
        let wires = [wire(r0)? * unit, wire(r1)? * unit];
        let radii = [r0.major_radius * unit, r1.major_radius * unit];
        if !(radii.iter().all(|r| (0.01..100.0).contains(r))
            && wires.iter().zip(radii).all(|(w, r)| *w >= 0.0 && *w < r))
        {
            return Err("the radii of the rings are not of one size, or no rings".into());
        }
        let (cos, sin) = cos_sin(direction_deg);
        let turned = |x: [f64; 2]| [cos.times(x[0]).add(&sin.times(x[1])), cos.times(x[1]).sub(&sin.times(x[0]))];
        let lattice = [design.lattice.a1, design.lattice.a2].map(|a| a.map(|x| x * unit));
        if lattice.iter().any(|a| a[2] != 0.0 || a.iter().any(|x| x.abs() > 1e6)) {
            return Err("the lattice is not in the plane".into());
        }
        let basis = lattice.map(|a| turned([a[0], a[1]]));
        let alike = radii[0] == radii[1] && wires[0] == wires[1];
        let across = Form::number(1.0).plus(l2);
        let mut cell = Cell { radii, wires, across, pairs: Vec::new(), alike, roots: Vec::new() };
        // The rings of the design, in its own axes.
        let centre = |k: usize| {
            Form::number(e1.center[k] * unit)
                .plus(r1.offset[k] * unit)
                .add(&Form::number(e0.center[k] * unit).plus(r0.offset[k] * unit).neg())
        };
        let normals = [r0, r1].map(|r| r.normal.map(Form::number));
        for m in -REACH..=REACH {
            for n in -REACH..=REACH {
                let way = |k: usize| {
                    Form::number(lattice[0][k])
                        .times(f64::from(m))
                        .add(&Form::number(lattice[1][k]).times(f64::from(n)))
                };
                let w = [centre(0).add(&way(0)), centre(1).add(&way(1)), centre(2)];
                let linked = cell.interlocked(&normals, &w);
                if linked == Interlocked::Unclear {
                    return Err(format!(
                        "ring 0 and ring 1 at {m},{n} meet in the design: whether they are linked is not clear"
                    ));
                }
                if linked == Interlocked::Yes {
                    let turn = dot(&w, &cross(&normals[0], &normals[1]));
                    let sign = if turn.inf() > 0.0 {
                        1.0
                    } else if turn.sup() < 0.0 {
                        -1.0
                    } else {
                        return Err(format!("the sign of the link of ring 0 and ring 1 at {m},{n} is not clear"));
                    };
                    let pair = cell.pair([0, 1], [m, n], &basis, Some(sign));
                    cell.pairs.push(pair);
                }
            }
        }
        if cell.pairs.is_empty() {
            return Err("no rings of this cell are linked".into());
        }
        cell.set_roots(&basis, l1_from)?;
        cell.add_near(&basis);
        Ok(cell)
    }

    fn pair(&self, rings: [usize; 2], shift: [i32; 2], basis: &[[Form; 2]; 2], sign: Option<f64>) -> Pair {
        let [m, n] = shift.map(f64::from);
        let step = [0, 1].map(|k| basis[0][k].times(m).add(&basis[1][k].times(n)));
        Pair { rings, shift, step, sign, touching: (self.wires[rings[0]] + self.wires[rings[1]]).next_down().max(0.0) }
    }

    /// All pairs that are linked in the design.
    pub fn links(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(|pair| pair.sign.is_some())
    }

    /// R_a + R_b − r_a − r_b of the linked rings, rounded up.
    fn longest(&self) -> f64 {
        let wires = Form::number(self.wires[0]).plus(self.wires[1]);
        Form::number(self.radii[0]).plus(self.radii[1]).sub(&wires).sup()
    }

    /// The boxes of the whole cell.
    fn set_roots(&mut self, basis: &[[Form; 2]; 2], l1_from: f64) -> Result<(), String> {
        let longest = self.longest();
        let least = (1.0 + l1_from).next_down();
        let most = self.most_stretch(longest)?;
        if least <= 0.0 {
            return Err("l1 is too near to -1".into());
        }
        let (mut lo, mut hi) =
            ([least, f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0], [most, f64::INFINITY, f64::INFINITY, longest]);
        for link in self.links() {
            for (k, by) in [(1, least), (2, self.across.inf())] {
                let reach = (longest / by).next_up();
                lo[k] = lo[k].max((-reach - link.step[k - 1].sup()).next_down());
                hi[k] = hi[k].min((reach - link.step[k - 1].inf()).next_up());
            }
        }
        // The half turn about the normal of the sheet.
        if let Some(shift) = self.half_turn() {
            let step = self.pair([0, 1], shift, basis, None).step[0];
            lo[1] = lo[1].max(step.times(-0.5).inf());
        }
        if (0..4).any(|k| lo[k] > hi[k]) {
            return Ok(());
        }
        let (mut low, mut high) = ([-1.0; UNKNOWNS], [1.0; UNKNOWNS]);
        low[..4].copy_from_slice(&lo);
        high[..4].copy_from_slice(&hi);
        for first in 0..3 {
            for second in if self.alike { first } else { 0 }..3 {
                for negative in [false, true] {
                    let sides = [Side { axis: first, negative: false }, Side { axis: second, negative }];
                    self.roots.push(Piece { lo: low, hi: high, sides });
                }
            }
        }
        Ok(())
    }

    /// 1 + l1 is at most this: two links a → b → a′ bridge F (s − s′), and no link is longer than R_a + R_b − r_a − r_b.
    fn most_stretch(&self, longest: f64) -> Result<f64, String> {
        let mut most = f64::INFINITY;
        let links: Vec<&Pair> = self.links().collect();
        for (k, one) in links.iter().enumerate() {
            for other in &links[..k] {
                let [x, y] = [0, 1].map(|k| one.step[k].sub(&other.step[k]));
                let side = y.mul(&self.across);
                let (long, least) = (Form::number(2.0 * longest), x.inf().max(-x.sup()));
                let left = long.mul(&long).sub(&side.mul(&side)).sup();
                if left < 0.0 {
                    return Ok(0.0);
                }
                // Nearer to 0 it is the rounding of the direction.
                if least > 1e-9 {
                    most = most.min((left.sqrt().next_up() / least).next_up());
                }
            }
        }
        if most.is_finite() { Ok(most) } else { Err("no chain of two links bounds l1 along this direction".into()) }
    }

    /// t with sign(t − s) = ± sign(s) for every link s, if there is one: the half turn about the normal of the sheet then maps the
    /// cell to itself, and a place x to −x − t.
    fn half_turn(&self) -> Option<[i32; 2]> {
        let links: Vec<&Pair> = self.links().collect();
        let ends = |k: usize| links.iter().map(move |link| link.shift[k]);
        let t = [0, 1].map(|k| ends(k).min().unwrap_or(0) + ends(k).max().unwrap_or(0));
        let opposite = |link: &&Pair| {
            let shift = [0, 1].map(|k| t[k] - link.shift[k]);
            links
                .iter()
                .find(|other| other.shift == shift)
                .map(|other| other.sign.unwrap_or(0.0) * link.sign.unwrap_or(0.0))
        };
        let by = opposite(links.first()?)?;
        links.iter().all(|link| opposite(link).is_some_and(|sign| flipped(sign, by))).then_some(t)
    }

    /// Pairs that are not linked and might touch somewhere in the roots. To leave one out would prove less and nothing false.
    fn add_near(&mut self, basis: &[[Form; 2]; 2]) {
        let Some(root) = self.roots.first() else { return };
        let rings = Rings::of(root);
        for [a, b] in [[0, 1], [0, 0], [1, 1]] {
            for m in -NEAR..=NEAR {
                for n in -NEAR..=NEAR {
                    if a == b && [m, n] <= [0, 0] || a != b && self.links().any(|link| link.shift == [m, n]) {
                        continue;
                    }
                    let pair = self.pair([a, b], [m, n], basis, None);
                    let w = self.between(&rings, &pair);
                    let reach = self.radii[a] + self.radii[b] + pair.touching;
                    let parts = w.map(|x| x.inf().max(-x.sup()).max(0.0));
                    let far: f64 = parts.iter().map(|x| x * x).sum();
                    if far < reach * reach {
                        self.pairs.push(pair);
                    }
                }
            }
        }
    }

    /// From the centre of the first ring of a pair to that of the second.
    pub(crate) fn between(&self, rings: &Rings, pair: &Pair) -> Forms {
        let [stretch, x, y, height] = &rings.place;
        match pair.rings[0] == pair.rings[1] {
            true => [stretch.mul(&pair.step[0]), self.across.mul(&pair.step[1]), Form::number(0.0)],
            false => [stretch.mul(&x.add(&pair.step[0])), self.across.mul(&y.add(&pair.step[1])), *height],
        }
    }

    /// The same at the centre of the box, to choose inequalities by.
    pub fn middle_between(&self, rings: &Rings, pair: &Pair) -> [f64; 3] {
        self.between(rings, pair).map(|x| x.c)
    }

    /// Major radii.
    pub fn radii(&self) -> [f64; 2] {
        self.radii
    }

    /// Whether every state of the box has its rings in the other order: the inversion at the middle between the rings
    /// exchanges their normals, and the one of the two is enough.
    pub fn out_of_order(&self, piece: &Piece) -> bool {
        let [one, other] = piece.sides.map(|side| side.axis);
        self.alike && (one > other || one == other && piece.line(0)[0] > piece.line(1)[1])
    }

    /// A² and B² of [`Cell::interlocked`].
    pub(crate) fn chords(&self, along: &[Forms; 2], w: &Forms) -> [Form; 2] {
        let c = cross(&along[0], &along[1]);
        let cc = dot(&c, &c);
        [0, 1].map(|ring| {
            let radius = Form::number(self.radii[ring]);
            let (own, high) = (dot(&along[ring], &along[ring]), dot(w, &along[1 - ring]));
            radius.mul(&radius).mul(&cc).sub(&own.mul(&high.mul(&high)))
        })
    }

    /// Whether rings of the two normals (of any length) are linked, w apart.
    ///
    /// With c = m_a × m_b, the circles cut the line of their planes in chords of half-lengths A/|c| and B/|c|, with
    /// A² = R_a² |c|² − |m_a|² (w·m_b)² and B² = R_b² |c|² − |m_b|² (w·m_a)², whose middles are |w·c|/|c| apart. They are linked if and
    /// only if the chords overlap and none is in the other: |A − B| < |w·c| < A + B, which is 4 A² B² > ((w·c)² − A² − B²)².
    pub(crate) fn interlocked(&self, along: &[Forms; 2], w: &Forms) -> Interlocked {
        let [a, b] = self.chords(along, w);
        let wc = dot(w, &cross(&along[0], &along[1]));
        let middle = wc.mul(&wc).sub(&a).sub(&b);
        let test = a.mul(&b).times(4.0).sub(&middle.mul(&middle));
        if test.inf() > 0.0 && a.inf() > 0.0 && b.inf() > 0.0 {
            Interlocked::Yes
        } else if test.sup() < 0.0 || a.sup() < 0.0 || b.sup() < 0.0 {
            Interlocked::No
        } else {
            Interlocked::Unclear
        }
    }
}

/// The power of two that brings a positive normal number into [1, 2).
fn power_of_two(x: f64) -> Option<f64> {
    // 2^k has the exponent bits 1023 + k; the number has k, the factor is to have −k.
    let exponent = x.to_bits() >> 52;
    (x > 0.0 && (1..2045).contains(&exponent)).then(|| f64::from_bits((2046 - exponent) << 52))
}

/// Whether two rings are linked everywhere in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interlocked {
    Yes,
    No,
    Unclear,
}
