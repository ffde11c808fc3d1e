//! States of a cell of two rings without overlap and with the links of the design, by a random walk. Distances and links are those of
//! `maille-geometry`: nothing here is shared with the proofs.

use maille::design::Design;
use maille_geometry::{Circle, Vec3, circle_distance_minima, linking_number};
use nalgebra::Unit;
use rand::{RngExt, rngs::ChaCha8Rng};

/// Copies of the cell to each side in which pairs are looked at.
const COPIES: i32 = 2;

/// Where two rings are.
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub l1: f64,
    /// From ring 0 to ring 1 in the undeformed cell, along D and D⊥, and the height.
    pub place: Vec3,
    /// Along D, D⊥ and out of the plane.
    pub normals: [Vec3; 2],
}

/// Two rings in a cell, with a direction and a width.
pub struct Weave {
    pub radii: [f64; 2],
    pub wires: [f64; 2],
    /// Lattice vectors along D and D⊥.
    pub lattice: [Vec3; 2],
    pub l2: f64,
    pub start: State,
    /// Linking numbers of ring 0 with ring 1 in the copies near by.
    links: Vec<([i32; 2], i32)>,
}

impl Weave {
    pub fn new(design: &Design, direction_deg: f64, l2: f64) -> Weave {
        let (sin, cos) = direction_deg.to_radians().sin_cos();
        let turned = |x: [f64; 3]| Vec3::new(cos * x[0] + sin * x[1], cos * x[1] - sin * x[0], x[2]);
        let rings: Vec<_> = design.elements.iter().map(|e| (Vec3::from(e.center), &e.rings[0])).collect();
        let start = State {
            l1: 0.0,
            place: turned((rings[1].0 - rings[0].0).into()),
            normals: [0, 1].map(|k| turned(rings[k].1.normal).normalize()),
        };
        let mut weave = Weave {
            radii: [0, 1].map(|k| rings[k].1.major_radius),
            wires: [0, 1].map(|k| rings[k].1.minor_radius.or(design.minor_radius).unwrap()),
            lattice: [turned(design.lattice.a1), turned(design.lattice.a2)],
            l2: 0.0,
            start,
            links: Vec::new(),
        };
        for m in -COPIES..=COPIES {
            for n in -COPIES..=COPIES {
                let [a, b] = weave.pair(&start, [0, 1], [m, n]);
                weave.links.push(([m, n], linking_number(&a, &b)));
            }
        }
        weave.l2 = l2;
        weave
    }

    fn pair(&self, state: &State, rings: [usize; 2], [m, n]: [i32; 2]) -> [Circle; 2] {
        let own = if rings[0] == rings[1] { Vec3::zeros() } else { state.place };
        let x = own + self.lattice[0] * f64::from(m) + self.lattice[1] * f64::from(n);
        let w = Vec3::new((1.0 + state.l1) * x.x, (1.0 + self.l2) * x.y, x.z);
        let circle =
            |center: Vec3, ring: usize| Circle::new(center, Unit::new_normalize(state.normals[ring]), self.radii[ring]);
        [circle(Vec3::zeros(), rings[0]), circle(w, rings[1])]
    }

    /// Whether no rings overlap and all links are those of the design.
    pub fn feasible(&self, state: &State) -> bool {
        let clear = |rings: [usize; 2], shift: [i32; 2]| {
            let [a, b] = self.pair(state, rings, shift);
            let touching = self.wires[rings[0]] + self.wires[rings[1]];
            let far = (b.center - a.center).norm() > a.radius + b.radius + touching;
            far || circle_distance_minima(&a, &b).closest().distance >= touching
        };
        let own = |ring: usize| self.links.iter().all(|(shift, _)| *shift <= [0, 0] || clear([ring, ring], *shift));
        let linked = |(shift, number): &([i32; 2], i32)| {
            let [a, b] = self.pair(state, [0, 1], *shift);
            let far = (b.center - a.center).norm() > a.radius + b.radius;
            clear([0, 1], *shift) && *number == if far { 0 } else { linking_number(&a, &b) }
        };
        self.links.iter().all(linked) && own(0) && own(1)
    }

    /// A state near by: a step of a random size in all unknowns or in one of them.
    pub fn moved(&self, state: &State, rng: &mut ChaCha8Rng) -> State {
        let size = 10_f64.powf(rng.random_range(-4.0..-0.5));
        let only: Option<usize> = rng.random::<bool>().then(|| rng.random_range(0..4));
        let step = |of: usize, rng: &mut ChaCha8Rng| match only {
            Some(k) if k != of => 0.0,
            _ => size * rng.random_range(-1.0..1.0),
        };
        let vector = |of: usize, rng: &mut ChaCha8Rng| Vec3::new(step(of, rng), step(of, rng), step(of, rng));
        State {
            place: state.place + vector(1, rng),
            normals: [0, 1].map(|k| (state.normals[k] + vector(2 + k, rng)).normalize()),
            l1: state.l1 + step(0, rng),
        }
    }

    /// The next state of a walk that likes large l1 by a factor e for each 1/`pull`, and whether the proposed one was feasible.
    pub fn walk(&self, state: &State, pull: f64, rng: &mut ChaCha8Rng) -> (State, Option<State>) {
        let next = self.moved(state, rng);
        if next.l1 <= -0.9 || !self.feasible(&next) {
            return (*state, None);
        }
        let taken = rng.random::<f64>() < ((next.l1 - state.l1) * pull).exp();
        (if taken { next } else { *state }, Some(next))
    }
}
