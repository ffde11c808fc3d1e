//! Inequalities that every state of the cell satisfies, evaluated over a box: g ≥ 0. Proofs: `docs/theory/prove.md`.

use super::{
    cell::{Cell, Interlocked, Pair},
    form::{Form, Forms, Numbers, UNKNOWNS, add, cross, cross_numbers, dot, dot_numbers, plain, scaled, sub, up},
    piece::Rings,
};

/// A vector that a proof chooses: three whole numbers. Any choice is sound.
pub type Chosen = [i32; 3];

/// One inequality. `pair` counts in [`Cell::pairs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The link keeps its sign: sign w·(n_a × n_b) ≥ (r_a + r_b) |n_a × n_b|.
    Turn {
        /// A link.
        pair: usize,
    },
    /// Linked rings are not apart along n: n·w ≤ R_a √(|n|² − (n·n_a)²) + R_b √(|n|² − (n·n_b)²) − (r_a + r_b) |n|.
    Apart {
        /// A link.
        pair: usize,
        /// n.
        along: Chosen,
    },
    /// Linked rings reach through each other's planes: ± w·n_a ≤ R_b |n_a × n_b| − (r_a + r_b), and the same with a and b exchanged.
    Plane {
        /// A link.
        pair: usize,
        /// Whose plane: 0 or 1, of the pair.
        of: usize,
        /// Whether the sign is −.
        below: bool,
    },
    /// On the line of both planes, the chord of the one ring does not end within that of the other: sign w·c ≥ (r_a + r_b) |c| ± (ℓ_a − ℓ_b) |c|
    /// with c = n_a × n_b and the half-lengths ℓ of the chords.
    Chord {
        /// A link.
        pair: usize,
        /// Whose chord is to end outside that of the other: 0 or 1, of the pair.
        of: usize,
    },
    /// A point of the one circle and a point of the other are r_a + r_b apart or more.
    Touch {
        /// Any pair.
        pair: usize,
        /// From the centre of the first ring to about where the point is at the centre of the box.
        first: Chosen,
        /// The same of the second ring.
        second: Chosen,
    },
    /// Rings that are not linked in the design are not linked here.
    Through {
        /// A pair that is no link.
        pair: usize,
    },
}

/// Slack for the rounding of a few operations on numbers below 100.
const ROUNDING: f64 = 1e-12;
/// The largest cosine at which a root is replaced by its tangent.
const STEEPEST: f64 = 0.995;
/// Tangents whose planes meet at a smaller sine give no direction of their own.
const CROSSING: f64 = 0.3;
/// Regularises where the points go for tangents that are nearly parallel.
const PARALLEL: f64 = 0.02;
/// Points go this far at most over the box, as part of the radius.
const FARTHEST: f64 = 0.6;

impl Cell {
    /// A form that is not negative wherever in the box there is a state; none where this reason says nothing.
    pub fn inequality(&self, rings: &Rings, reason: &Reason) -> Option<Form> {
        match *reason {
            Reason::Turn { pair } => self.turn(rings, self.pairs.get(pair)?),
            Reason::Apart { pair, along } => self.apart(rings, self.pairs.get(pair)?, &along.map(f64::from)),
            Reason::Plane { pair, of, below } => self.plane(rings, self.pairs.get(pair)?, of, below),
            Reason::Chord { pair, of } => self.chord(rings, self.pairs.get(pair)?, of),
            Reason::Touch { pair, first, second } => {
                self.touch(rings, self.pairs.get(pair)?, [first, second].map(|x| x.map(f64::from)))
            }
            Reason::Through { pair } => self.through(rings, self.pairs.get(pair)?),
        }
    }

    fn turn(&self, rings: &Rings, pair: &Pair) -> Option<Form> {
        let sign = pair.sign?;
        let w = self.between(rings, pair);
        let c = cross(&rings.along[0], &rings.along[1]);
        let centre = c.map(|x| x.c);
        let length = plain::length(&centre);
        // |c| ≥ u·c for each |u| ≤ 1.
        let u = if length > 1e-9 { centre.map(|x| x / length * (1.0 - 1e-15)) } else { [0.0; 3] };
        let reduced: Forms = [0, 1, 2].map(|k| w[k].times(sign).plus(-pair.touching * u[k]));
        Some(dot(&reduced, &c))
    }

    fn apart(&self, rings: &Rings, pair: &Pair, n: &Numbers) -> Option<Form> {
        pair.sign?;
        let n2 = plain::dot(n, n);
        let length = n2.sqrt() * (1.0 - 1e-15);
        let mut out = dot_numbers(&self.between(rings, pair), n).neg().plus(-pair.touching * length);
        for ring in pair.rings {
            // u u₀ + √(n² − u²) √(n² − u₀²) ≤ n² for u = n·n_ring and each u₀.
            let near = plain::dot(n, &rings.middle[ring]).clamp(-STEEPEST * length, STEEPEST * length);
            let root = (n2 - near * near).sqrt();
            let above = dot_numbers(&rings.normals[ring], n).times(-near).plus(n2);
            // The form is of what is never negative: a factor that is too large is an upper bound.
            out = out.add(&above.times(self.radii[ring] / root * (1.0 + ROUNDING)));
        }
        Some(out)
    }

    fn plane(&self, rings: &Rings, pair: &Pair, of: usize, below: bool) -> Option<Form> {
        pair.sign?;
        let (own, other) = (rings.normals.get(of)?, rings.normals.get(1 - of)?);
        // |n_a × n_b| = √(1 − t²) with t = n_a·n_b, and t t₀ + √(1 − t²) √(1 − t₀²) ≤ 1 for each t₀. In nearly parallel planes t₀ is
        // chosen so that the reach stays below r_a + r_b.
        let least = (0.5 * pair.touching / self.radii[1 - of]).clamp(0.02, 0.1);
        let most = (1.0 - least * least).sqrt();
        let near = plain::dot(&rings.middle[0], &rings.middle[1]).clamp(-most, most);
        let root = (1.0 - near * near).sqrt();
        let reach = dot(own, other).times(-near).plus(1.0).times(self.radii[1 - of] / root * (1.0 + ROUNDING));
        let height = dot(&self.between(rings, pair), own);
        let height = if below { height.neg() } else { height };
        Some(reach.plus(-pair.touching).sub(&height))
    }

    fn chord(&self, rings: &Rings, pair: &Pair, of: usize) -> Option<Form> {
        let turn = self.turn(rings, pair)?;
        let halves = self.chords(&rings.along, &self.between(rings, pair));
        let root = |square: &Form| Some(square.mul(&square.inverse_root()?));
        let (a, b) = (root(&halves[0])?, root(&halves[1])?);
        match of {
            0 => Some(turn.sub(&b).add(&a)),
            1 => Some(turn.sub(&a).add(&b)),
            _ => None,
        }
    }

    fn through(&self, rings: &Rings, pair: &Pair) -> Option<Form> {
        let two = pair.rings[0] != pair.rings[1] && pair.sign.is_none();
        let linked = two && self.interlocked(&rings.along, &self.between(rings, pair)) == Interlocked::Yes;
        linked.then(|| Form::number(-1.0))
    }

    /// With points x of circle a and y of circle b that move with the box, v = y − x, and any unit vector u: let ν = u·v and V an
    /// upper bound of |v − ν u|. Then ν² ≥ s² − V², s = r_a + r_b.
    fn touch(&self, rings: &Rings, pair: &Pair, towards: [Numbers; 2]) -> Option<Form> {
        let [a, b] = pair.rings;
        let w = self.between(rings, pair);
        let points = [0, 1].map(|k| plain::unit(&plain::across(&towards[k], &rings.middle[pair.rings[k]])));
        let tangents = [0, 1].map(|k| plain::cross(&rings.middle[pair.rings[k]], &points[k]));
        let apart = plain::add(&plain::add(&w.map(|x| x.c), self.radii[b], &points[1]), -self.radii[a], &points[0]);
        let u = direction(&tangents, &apart)?;
        let moves = self.moves(rings, pair, &w, &points, &tangents, &u);
        let [x, y] = [0, 1].map(|k| point(rings, pair.rings[k], &points[k], &tangents[k], &moves[k]));
        let v = sub(&add(&w, &scale(&y?, self.radii[b])), &scale(&x?, self.radii[a]));
        not_nearer(&v, &u, pair.touching)
    }

    /// How the points go along their circles to first order in the unknowns, so that v stays along u: plain numbers, any are sound.
    fn moves(
        &self,
        rings: &Rings,
        pair: &Pair,
        w: &Forms,
        points: &[Numbers; 2],
        tangents: &[Numbers; 2],
        u: &Numbers,
    ) -> [[f64; UNKNOWNS]; 2] {
        let radii = pair.rings.map(|ring| self.radii[ring]);
        let mut rates: [Numbers; UNKNOWNS] = [[0.0; 3]; UNKNOWNS];
        for (i, rate) in rates.iter_mut().enumerate() {
            *rate = [w[0].b[i], w[1].b[i], w[2].b[i]];
        }
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            let ring = pair.rings[k];
            for i in 4 + 2 * ring..6 + 2 * ring {
                let turning = [0, 1, 2].map(|c| rings.along[ring][c].b[i]);
                let rise = -plain::dot(&turning, &points[k]) / rings.lengths[ring] * sign * radii[k];
                rates[i] = plain::add(&rates[i], rise, &rings.middle[ring]);
            }
        }
        let [s, t] = [0, 1].map(|k| plain::across(&tangents[k], u).map(|x| x * radii[k]));
        let (ss, tt, st) = (plain::dot(&s, &s) + PARALLEL, plain::dot(&t, &t) + PARALLEL, plain::dot(&s, &t));
        let det = ss * tt - st * st;
        let mut out = [[0.0; UNKNOWNS]; 2];
        for i in 0..UNKNOWNS {
            // The least |rate − α s + β t|².
            let (p, q) = (plain::dot(&rates[i], &s), -plain::dot(&rates[i], &t));
            out[0][i] = (p * tt + st * q) / det;
            out[1][i] = (ss * q + st * p) / det;
        }
        out.map(|way| {
            let far: f64 = way.iter().map(|x| x.abs()).sum();
            way.map(|x| if far > FARTHEST { x * FARTHEST / far } else { x })
        })
    }

    /// Whether the inequalities, each times a weight, sum to what is negative all over the box: then it holds no state.
    pub fn refutes(&self, rings: &Rings, terms: &[(Reason, u32)]) -> bool {
        let mut sum = Form::number(0.0);
        for (reason, weight) in terms {
            match self.inequality(rings, reason) {
                Some(form) => sum = sum.add(&form.times(f64::from(*weight))),
                None => return false,
            }
        }
        sum.sup() < 0.0
    }
}

fn scale(x: &Forms, k: f64) -> Forms {
    x.map(|x| x.times(k))
}

/// Across both tangents where they cross, else along v.
fn direction(tangents: &[Numbers; 2], v: &Numbers) -> Option<Numbers> {
    let across = plain::cross(&tangents[0], &tangents[1]);
    let (size, far) = (plain::length(&across), plain::length(v));
    let u = if size > CROSSING {
        across.map(|x| x / size)
    } else if far > 1e-9 {
        v.map(|x| x / far)
    } else {
        return None;
    };
    Some(if plain::dot(&u, v) < 0.0 { u.map(|x| -x) } else { u })
}

/// A unit vector of the plane of a ring: m × g over its length is one for each g. Here g turns with the unknowns.
fn point(rings: &Rings, ring: usize, at: &Numbers, tangent: &Numbers, moves: &[f64; UNKNOWNS]) -> Option<Forms> {
    let (m, middle) = (&rings.along[ring], &rings.middle[ring]);
    let angle = Form { c: 0.0, b: *moves, r: 0.0 };
    let still = cross_numbers(m, &plain::cross(at, middle));
    let along = add(&still, &scaled(&cross_numbers(m, &plain::cross(tangent, middle)), &angle));
    Some(scaled(&along, &dot(&along, &along).inverse_root()?))
}

/// |v| ≥ s as a form that is not negative.
///
/// v = ν u + x with ν = u·v has |v|² = ν² (2 − |u|²) + |x|² for any u.
fn not_nearer(v: &Forms, u: &Numbers, s: f64) -> Option<Form> {
    let along = dot_numbers(v, u);
    let mut rest = 0.0;
    for k in 0..3 {
        let x = v[k].sub(&along.times(u[k])).size();
        rest += x * x;
    }
    let (square, rest) = (s * s * (1.0 - ROUNDING), up(rest));
    if !(rest < square && (plain::dot(u, u) - 1.0).abs() < 0.01 * ROUNDING) {
        return None;
    }
    // ν² (1 + ROUNDING) ≥ s² − V².
    let least = ((square - rest) * (1.0 - ROUNDING)).sqrt() * (1.0 - ROUNDING);
    let (lo, hi) = (along.inf(), along.sup());
    if lo > -least {
        Some(along.plus(-least))
    } else if hi < least {
        Some(along.neg().plus(-least))
    } else if lo.is_finite() && hi.is_finite() {
        // Between lo and hi, ν² is below its chord (lo + hi) ν − lo hi.
        let product = up(-(lo * hi));
        let chord = along.times(lo + hi).plus(product).plus(-least * least * (1.0 - ROUNDING));
        Some(chord.plus(ROUNDING * (lo * lo + hi * hi)))
    } else {
        None
    }
}
