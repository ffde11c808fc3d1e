//! The link bound of a row, from the forces of ties that its state names.
//!
//! Let forces y_k, one for each tie |g_k| ≤ L_k, balance on every element: Σ w y = 0. In Σ y_k·g_k the centres then cancel. With
//! F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ + γ D D⊥ᵀ, S_k = Σ w s, P = Σ (y_k·D)(S_k·D), T = Σ (y_k·D⊥)(S_k·D⊥), U = Σ (y_k·D)(S_k·D⊥), M_i = Σ w y_k oᵀ
//! over the rings of element i,
//!
//! (1 + l1) P + (1 + l2) T + γ U + Σ ⟨Q_i, M_i⟩ = Σ y_k·g_k ≤ Σ |y_k| L_k.
//!
//! ⟨Q, M⟩ ≥ −σ(−M), where σ(M), the largest ⟨Q, M⟩ over rotations, is s₁ + s₂ + sign(det M) s₃ by the singular values of M. So
//!
//! (1 + l1) P ≤ Σ |y_k| L_k + Σ σ(−M_i) − (1 + l2) T − γ U.
//!
//! The links together do no more than Σ |y_k| L_k, and no more than [`crate::width`] says, where each ring has one normal.
//!
//! **Rounding.** The forces balance to rounding; what they leave on an element, |Σ w y|, counts times the largest distance of its centre from
//! another one that it is joined with: the sum over all links of L + |F s| + |o_a| + |o_b|, as a path uses each link at most once. (Over the elements
//! that are joined the rests sum to 0, so only distances matter.) |F s| ≤ (1 + l1) |s·D| + (1 + l2) |s·D⊥| where l2 is held and γ is 0; the part
//! with 1 + l1 is subtracted from P. Where something is free, |F s| ≤ Λ |s| with a stretch Λ that two chains of different
//! directions prove, and T or U of what is free must be 0; the rest of them is charged with Λ. To the sum comes
//! [`ROUNDING`] · (100 + n) times the sum of its n absolute terms, so that the value is rounded outwards.

use crate::{
    record::Dual,
    sheet::{ROUNDING, Sheet, Vec3},
    strain::axes,
    tie::{Linked, Place, Tie},
    width::most_width,
};
use nalgebra::{Matrix3, Vector2};

/// Two chains of different directions: the sine of their angle.
const DIFFERENT: f64 = 1e-6;

/// What is held or free across the pull.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    pub l2: Option<f64>,
    pub shear_free: bool,
}

/// Where the rings of ties are counted: links, strand pairs and crossing pairs in the one start, chains in the other.
#[derive(Clone, Copy)]
pub(crate) struct Starts<'a> {
    pub own: Linked<'a>,
    pub first: Option<Linked<'a>>,
}

/// What forces prove: 1 + l1 is no larger than either number. Below 0 no state with l1 > −1 has this l2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Proven {
    /// With the length of each link.
    pub by_lengths: f64,
    /// With one normal for each ring.
    pub by_normals: f64,
}

impl Proven {
    /// The lower one.
    pub fn least(&self) -> f64 {
        self.by_lengths.min(self.by_normals)
    }
}

/// What `forces` prove, or what is wrong with them.
pub(crate) fn bound(starts: Starts<'_>, forces: &[Dual], direction_deg: f64, held: Held) -> Result<Proven, String> {
    let ties: Vec<(Tie, Vec3)> = forces
        .iter()
        .map(|dual| {
            let of = if dual.tie == "chain" {
                starts.first.ok_or("no state of the cell whose rings a chain counts")?
            } else {
                starts.own
            };
            Ok((of.tie(&dual.tie, &dual.rings)?, Vec3::from(dual.force)))
        })
        .collect::<Result<_, String>>()?;
    // Smaller ones vanish when they are squared, larger ones overflow.
    let sizes = ties.iter().map(|(_, y)| y.amax()).filter(|size| *size != 0.0);
    if let Some(size) = sizes.into_iter().find(|size| !(1e-100..=1e100).contains(size)) {
        return Err(format!("a force of the bound is {size:e}, for a unit pull"));
    }
    let own = starts.own.sheet;
    let (d, side) = axes(direction_deg);
    let (d, side) = (Vec3::new(d.x, d.y, 0.0), Vec3::new(side.x, side.y, 0.0));
    let mut rest = vec![Vec3::zeros(); own.bodies.len()];
    let mut moments = vec![Matrix3::zeros(); own.bodies.len()];
    // Sums, and those of their absolute terms.
    let (mut pull, mut lateral, mut shear, mut total) =
        (Sum::default(), Sum::default(), Sum::default(), Sum::default());
    for (tie, y) in &ties {
        pull.add(y.dot(&d) * tie.span.dot(&d), y.norm() * tie.span.norm());
        lateral.add(y.dot(&side) * tie.span.dot(&side), y.norm() * tie.span.norm());
        shear.add(y.dot(&d) * tie.span.dot(&side), y.norm() * tie.span.norm());
        if !tie.is_link {
            total.add(y.norm() * tie.length, y.norm() * tie.length);
        }
        for (ring, weight) in &tie.terms {
            let ring = &own.rings[*ring];
            rest[ring.element] += y * *weight;
            moments[ring.element] -= y * ring.arm.transpose() * *weight;
            total.size += 4.0 * y.norm() * ring.arm.norm();
        }
    }
    moments.iter().for_each(|moment| total.add(support(moment), 4.0 * moment.norm()));
    let left: f64 = rest.iter().map(|r| r.norm() + ROUNDING * y_sum(&ties)).sum();
    // The farthest that joined centres can be: `fixed` + (1 + l1) · `growing`.
    let (mut fixed, mut growing) = (0.0, 0.0);
    let stretch = if held.l2.is_some() && !held.shear_free { None } else { Some(stretch(starts.own)) };
    for ((a, b, shift), _) in starts.own.links {
        let (one, other, s) = (&own.rings[*a], &own.rings[*b], own.translation(*shift));
        fixed += one.radius + other.radius - one.wire - other.wire + one.arm.norm() + other.arm.norm();
        match (stretch, held.l2) {
            (None, Some(l2)) => {
                growing += s.dot(&d).abs();
                fixed += (1.0 + l2) * s.dot(&side).abs();
            }
            (stretch, _) => fixed += stretch.unwrap_or(f64::INFINITY) * s.norm(),
        }
    }
    let charged = |of: f64, by: f64| if of > 0.0 { of * by } else { 0.0 };
    match held.l2 {
        Some(l2) => total.add(-(1.0 + l2) * lateral.value, (1.0 + l2) * lateral.size),
        None => total.value += charged(lateral.value.abs() + lateral.error(), stretch.unwrap_or(f64::INFINITY)),
    }
    if held.shear_free {
        total.value += charged(shear.value.abs() + shear.error(), stretch.unwrap_or(f64::INFINITY));
    }
    let least_pull = pull.value - pull.error() - charged(left, growing);
    let proven = |links: Sum| {
        let most = total.value + links.value + total.error() + links.error() + charged(left, fixed);
        // For a negative sum the largest P gives the largest quotient.
        if most > 0.0 { most / least_pull } else { most / (pull.value + pull.error()) }
    };
    let by_lengths = proven(lengths(&ties));
    let round = own.rings.iter().all(|ring| ring.curve.is_none());
    let by_normals = if round { proven(normals(own, &ties)) } else { by_lengths };
    let proven = Proven { by_lengths, by_normals };
    if least_pull.is_nan() || least_pull <= 0.0 || !proven.by_lengths.is_finite() {
        return Err("the forces of the bound do not pull".into());
    }
    Ok(proven)
}

/// Σ |y| L of the links.
fn lengths(ties: &[(Tie, Vec3)]) -> Sum {
    let mut sum = Sum::default();
    ties.iter()
        .filter(|(tie, _)| tie.is_link)
        .for_each(|(tie, y)| sum.add(y.norm() * tie.length, y.norm() * tie.length));
    sum
}

/// The most of the links with one normal for each ring.
fn normals(own: &Sheet, ties: &[(Tie, Vec3)]) -> Sum {
    let mut at = vec![Vec::new(); own.rings.len()];
    let mut sum = Sum::default();
    for (tie, y) in ties.iter().filter(|(tie, _)| tie.is_link) {
        for (ring, _) in &tie.terms {
            at[*ring].push(*y);
            sum.add(-own.rings[*ring].wire * y.norm(), own.rings[*ring].wire * y.norm());
        }
    }
    for (ring, forces) in own.rings.iter().zip(&at).filter(|(_, forces)| !forces.is_empty()) {
        let width = ring.radius * most_width(forces);
        sum.add(width, width);
    }
    sum
}

fn y_sum(ties: &[(Tie, Vec3)]) -> f64 {
    ties.iter().map(|(_, y)| y.norm()).sum()
}

/// A sum with what its rounding can be.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    size: f64,
    count: f64,
}

impl Sum {
    fn add(&mut self, value: f64, size: f64) {
        self.value += value;
        self.size += size;
        self.count += 1.0;
    }

    fn error(&self) -> f64 {
        ROUNDING * (100.0 + self.count) * self.size
    }
}

/// σ(M) = max ⟨Q, M⟩ over rotations.
fn support(m: &Matrix3<f64>) -> f64 {
    let mut s = m.singular_values();
    s.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    s[0] + s[1] + s[2].copysign(m.determinant())
}

/// A stretch that no direction of the sheet exceeds, from two closed walks of links: |F v| ≤ d, |F v′| ≤ d′, and a unit vector is α v + β v′ with
/// |α| ≤ |v′|/|v × v′|, |β| ≤ |v|/|v × v′|. Infinite where the walks that are tried are parallel.
fn stretch(start: Linked<'_>) -> f64 {
    let walks = walks(start);
    let mut least = f64::INFINITY;
    for (k, (v, d)) in walks.iter().enumerate() {
        for (w, e) in &walks[..k] {
            let area = (v.x * w.y - v.y * w.x).abs();
            if area > DIFFERENT * v.norm() * w.norm() {
                least = least.min((w.norm() * d + v.norm() * e) / area);
            }
        }
    }
    least
}

/// Closed walks: along a tree of shortest ways from a ring to both ends of each link that closes one.
pub(crate) fn walks(start: Linked<'_>) -> Vec<(Vector2<f64>, f64)> {
    let rings = &start.sheet.rings;
    let edges = edges(start);
    let mut out = Vec::new();
    for root in 0..rings.len() {
        // Bellman–Ford; place and length of the shortest way found.
        let mut ways: Vec<Option<([i32; 2], f64)>> = vec![None; rings.len()];
        ways[root] = Some(([0, 0], 0.0));
        for _ in 0..rings.len() {
            let mut settled = true;
            for &((a, _), (b, s), length) in &edges {
                let Some((at, so_far)) = ways[a] else { continue };
                if ways[b].is_none_or(|(_, known)| so_far + length < known) {
                    ways[b] = Some(([at[0] + s[0], at[1] + s[1]], so_far + length));
                    settled = false;
                }
            }
            if settled {
                break;
            }
        }
        for &((a, _), (b, s), length) in &edges {
            if let (Some((p, one)), Some((q, other))) = (ways[a], ways[b]) {
                let v = [p[0] + s[0] - q[0], p[1] + s[1] - q[1]];
                if v != [0, 0] {
                    out.push((start.sheet.translation(v).xy(), one + length + other));
                }
            }
        }
        // One connected part is enough for two directions, if it has them.
        if out.len() > 1 && root == 0 && ways.iter().all(Option::is_some) {
            break;
        }
    }
    out
}

pub(crate) fn edges(start: Linked<'_>) -> Vec<(Place, Place, f64)> {
    let rings = &start.sheet.rings;
    let mut out = Vec::new();
    for ((a, b, s), _) in start.links {
        let length = rings[*a].radius + rings[*b].radius - rings[*a].wire - rings[*b].wire;
        out.push(((*a, [0, 0]), (*b, *s), length));
        out.push(((*b, [0, 0]), (*a, s.map(|x| -x)), length));
    }
    for (a, one) in rings.iter().enumerate() {
        for (b, other) in rings.iter().enumerate().filter(|(b, other)| *b != a && other.element == one.element) {
            out.push(((a, [0, 0]), (b, [0, 0]), (one.arm - other.arm).norm()));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    /// σ against many rotations: never passed, and nearly reached.
    #[test]
    fn support_is_the_largest_over_rotations() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..20 {
            let m = Matrix3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            let most = support(&m);
            let mut seen = f64::NEG_INFINITY;
            for _ in 0..20_000 {
                let axis = Vector3::from_fn(|_, _| rng.random_range(-3.2..3.2));
                seen = seen.max(Rotation3::new(axis).matrix().dot(&m));
            }
            assert!(seen <= most + 1e-12 && seen > most - 0.15 * m.norm(), "{seen} {most}");
        }
    }
}
