//! Descent from one start: steps of the model within a box that grows and shrinks with how well it foretells.

use super::{
    search::{Point, Refused, Search, Solved},
    step::{Piece, Pieces, best_step, misses},
};
use nalgebra::DVector;
use std::sync::atomic::Ordering;

/// Half the width of the box at first, as a share of each range.
const REACH: f64 = 0.3;
/// A start is given up where the box is smaller than this.
const SMALLEST: f64 = 1e-9;
/// A step is taken where the misses fall by this share of what the model promises; the box grows where they fall by `GOOD`.
const TAKEN: f64 = 1e-3;
const GOOD: f64 = 0.75;
/// A start is given up where so many designs in a row lower the misses by less than this share, all together.
const STALLED: usize = 10;
const STALLED_GAIN: f64 = 0.01;
/// Tangents count of designs within so many boxes.
const NEAR: f64 = 8.0;

/// The best point of a descent from `begin`. A point without derivatives ends it. `tell` sees every point that is better than those before.
pub(super) fn descend(search: &Search<'_>, begin: Point, tell: &mut dyn FnMut(&Point)) -> Point {
    let Ok(mut at) = search.with_slopes(begin.clone()) else { return begin };
    // Designs that the model led to from the current one in vain.
    let mut rejected: Vec<Solved> = Vec::new();
    let mut reach = REACH;
    let mut costs = vec![at.point.cost];
    for _ in 1..search.options.designs {
        tell(&at.point);
        let earlier = costs.len().checked_sub(STALLED).map(|k| costs[k]);
        if earlier.is_some_and(|cost| at.point.cost > (1.0 - STALLED_GAIN) * cost) {
            break;
        }
        costs.push(at.point.cost);
        if search.reached(&at.point) || search.cancel.load(Ordering::Relaxed) || reach < SMALLEST {
            break;
        }
        let model = model(search, &at, &rejected, reach);
        let shares = &at.point.shares;
        let lower: Vec<f64> = shares.iter().map(|x| -x).collect();
        let upper: Vec<f64> = shares.iter().map(|x| 1.0 - x).collect();
        let step = best_step(&model, search.options.norm, &lower, &upper, reach);
        let promised = at.point.cost - search.options.norm.of(&misses(&model, &step));
        if step.amax() < SMALLEST || promised <= 1e-13 * at.point.cost {
            // Nothing is left to gain in this box; a smaller one has fewer tangents of others.
            reach *= 0.1;
            continue;
        }
        let next = shares.iter().zip(step.iter()).map(|(x, d)| (x + d).clamp(0.0, 1.0)).collect();
        let solved =
            search.near(&at.point).solve(next).and_then(|point| search.with_slopes(point).map_err(Refused::Design));
        match solved {
            Ok(next) => {
                let gain = at.point.cost - next.point.cost;
                reach = match gain > GOOD * promised {
                    true if step.amax() > 0.9 * reach => (2.0 * reach).min(1.0),
                    true => reach,
                    false if gain > TAKEN * promised => reach,
                    false => 0.5 * step.amax(),
                };
                if gain > TAKEN * promised {
                    rejected.clear();
                    at = next;
                } else {
                    rejected.push(next);
                }
            }
            Err(Refused::Interrupted) => break,
            Err(_) => reach = 0.25 * step.amax(),
        }
    }
    at.point
}

/// The model of all targets around a point, with the tangents of the rejected designs near it.
fn model(search: &Search<'_>, at: &Solved, rejected: &[Solved], reach: f64) -> Vec<Pieces> {
    let away = |other: &Solved| {
        let shares = other.point.shares.iter().zip(&at.point.shares).map(|(there, here)| there - here);
        DVector::from_iterator(at.point.shares.len(), shares)
    };
    let neighbours: Vec<_> = rejected.iter().map(|other| (away(other), other)).collect();
    let near = |d: &DVector<f64>| d.amax() <= NEAR * reach;
    let pieces = |(k, target): (usize, &super::Target)| {
        let of = |solved: &Solved| {
            (target.weight * solved.point.deviations[k], solved.slopes.row(k).transpose() * target.weight)
        };
        let (offset, slope) = of(at);
        let mut pieces = Pieces::new(target.wanted, Piece { offset, slope });
        for (d, other) in neighbours.iter().filter(|(d, _)| near(d)) {
            let (value, slope) = of(other);
            pieces.add_neighbour(d, value, &slope);
        }
        pieces
    };
    search.targets.iter().enumerate().map(pieces).collect()
}
