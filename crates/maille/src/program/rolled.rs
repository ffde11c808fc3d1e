//! Pairs of a rolled sheet: how their elements move with the unknowns, to second order.
//!
//! The element e in the image s stands at G_{s+c}(q) with c its anchor in the cell (see [`crate::state::Carried`]). A step first
//! moves it by δ and turns it by ω in the main cell; then the lattice and its turns change and carry it along. With the change ψ
//! of the turn of s + c and the turn R of s, the image's rotation vector is log(e^{ψw} e^{Rω}), so
//!
//!   β = ψ w + R ω + ½ ψ w × R ω + …,  ∂²x/∂ψ∂δ = w × R δ,
//!
//! beside the derivatives of G. In the kernel's motion y = (x, α, β) of a pair, x is the way from A's reference point to B's.

use super::{
    Posed, SheetProgram,
    pair::{PairMap, in_block},
};
use crate::{
    state::{Roll, State},
    topology::{RingPair, motion::Motion},
};
use maille_geometry::Vec3;

impl SheetProgram<'_> {
    /// The unknowns that move the pair, with their motions and all second derivatives of these.
    pub(super) fn rolled_map(&self, state: &State, roll: &Roll, pair: &RingPair, turns: &[Vec<Vec3>]) -> PairMap {
        let (i, j) = (self.model.rings[pair.ring_a].element, self.model.rings[pair.ring_b].element);
        let mut map = PairMap::new();
        let parameters: Vec<usize> =
            (0..self.pull.parameters.len()).map(|m| map.place(self.first_parameter + m)).collect();
        map.parameters = parameters.iter().copied().enumerate().collect();
        for (e, shift, block, sign) in [(i, [0, 0], 1, -1.0), (j, pair.shift, 2, 1.0)] {
            let anchor = self.model.elements[e].anchor;
            let carried = state.carried(roll, e, anchor, shift);
            let at: [f64; 2] = std::array::from_fn(|k| f64::from(shift[k]) + anchor[k]);
            let rates: Vec<(Vec3, f64)> = self.pull.parameters.iter().map(|p| p.at(at)).collect();
            for (m, (lattice, turn_rad)) in rates.iter().enumerate() {
                map.add(self.first_parameter + m, 0, &carried.rate(lattice, *turn_rad), sign);
                map.add(self.first_parameter + m, block, &roll.axis(), *turn_rad);
                let bend = |(n, (other, turn)): (usize, &(Vec3, f64))| {
                    let bend = carried.bend((lattice, *turn_rad), (other, *turn));
                    (parameters[m], parameters[n], in_block(0, &(bend * sign)))
                };
                map.bends.extend(rates.iter().enumerate().map(bend));
            }
            let mut own = |column: usize, axis: &Vec3, block: usize, weight: f64, bend: f64| {
                let moved = carried.turned(axis);
                map.add(column, block, &moved, weight);
                let (place, about) = (map.place(column), carried.about_axis(&moved));
                for (&m, (_, turn_rad)) in parameters.iter().zip(&rates).filter(|(_, (_, turn_rad))| *turn_rad != 0.0) {
                    let bend = in_block(block, &(about * (weight * bend * turn_rad)));
                    map.bends.extend([(m, place, bend), (place, m, bend)]);
                }
            };
            if let Some(t) = self.columns[e].0 {
                [Vec3::x(), Vec3::y(), Vec3::z()]
                    .iter()
                    .enumerate()
                    .for_each(|(k, axis)| own(t + k, axis, 0, sign, 1.0));
            }
            let first = self.columns[e].1;
            turns[e].iter().enumerate().for_each(|(k, axis)| own(first + k, axis, block, 1.0, 0.5));
        }
        map
    }

    /// The point that a motion leads to, where the parameters are then `p`.
    pub(super) fn moved_rolled(&self, x: &Posed, motion: &Motion, p: Vec<f64>) -> Posed {
        let to = self.posed(x.state.clone(), p);
        let moved = x.state.poses.iter().zip(&motion.elements).enumerate().map(|(e, (pose, (shift, turn)))| {
            let (anchor, pose) = (self.model.elements[e].anchor, pose.moved(shift, turn));
            let carry = || to.state.motion_to(anchor).after_back(&x.state.motion_to(anchor));
            if anchor == [0.0; 2] { pose } else { carry().pose(&pose) }
        });
        let poses = moved.collect();
        Posed { state: State { poses, ..to.state.clone() }, ..to }
    }
}
