//! Whether l1 can grow for ever from a state: what `unbounded` claims.
//!
//! Where l1 grows by δ and nothing else moves, ring b of the image s moves against ring a by δ (D·t) D, with t = s₁ a₁ + s₂ a₂ of the start. With
//! o = p + (o·D) D the way between their centres and ϱ the sum of their radii and wires, they never touch if |p| > ϱ, or if
//! sign(D·t) (o·D) > ϱ; and they do not move if D·t = 0.

use crate::{
    sheet::{Pair, Sheet, Vec3},
    strain::{self, ACROSS},
};
use nalgebra::Vector2;

/// The first pair of rings that a larger l1 could bring together, if there is one. Overlap of the state itself is not looked at.
pub(crate) fn could_meet(here: &Sheet, start: &Sheet, along: Vector2<f64>) -> Result<Option<Pair>, String> {
    let centers: Vec<Vec3> = (0..here.rings.len()).map(|ring| here.circle(ring, [0, 0]).center).collect();
    let d = Vec3::new(along.x, along.y, 0.0);
    let widest = centers.iter().map(|c| (c - centers[0]).norm()).fold(0.0, f64::max);
    // An image that is not safe is less than ϱ beside, less than ϱ ahead, and behind by no more than the rings of one cell are apart and
    // the shear carries it.
    let across = Vector2::new(-along.y, along.x);
    let f = strain::gradient(here.lattice, start.lattice).ok_or("the design's lattice vectors are parallel")?;
    let lean = (along.dot(&(f * across)) / across.dot(&(f * across))).abs();
    let pairs = here.pairs(|a, b| {
        let radii = here.rings[a].radius + here.rings[b].radius;
        radii + 2.0 * here.touching(a, b) + 4.0 * widest + lean * (radii + here.touching(a, b) + 2.0 * widest)
    })?;
    Ok(pairs.into_iter().find(|&(a, b, shift)| {
        let reference = start.translation(shift);
        let rate = d.dot(&reference);
        let way = centers[b] - centers[a] + here.translation(shift);
        let (ahead, beside) = (d.dot(&way), (way - d * d.dot(&way)).norm());
        let radii = here.rings[a].radius + here.rings[b].radius + here.touching(a, b) + here.slack((a, b, shift));
        let stays = rate.abs() <= ACROSS * reference.norm();
        !(stays || beside > radii || rate.signum() * ahead > radii)
    }))
}
