//! The minima of one pair with the pair's arcs, then its minima, side by side in registers.
//!
//! The count of [`crate::brackets`] for all eight arcs at once; an arc in doubt is cut into eight parts, counted in the same way.
//! What is still in doubt is left to [`crate::quick`].

use crate::arcs::{ARCS, Fan, TABLE};
use crate::brackets::{Angle, Bracket, Value, is_steep};
use crate::count::{Harmonics, arc_coefficients, changes, turned};
use crate::grid::Direction;
use crate::lane::{Lane, Register};
use crate::minima::{Minima, Minimum, PairKind};
use crate::placed::{Framed, Placed, Vector, dot, splat, sum};
use crate::quick::roots;
use crate::reduced::Reduced;
use crate::{Circle, MAX_MINIMA, ROUNDING, Vec3};
use arrayvec::ArrayVec;
use pulp::{Simd, WithSimd};

/// A number of each arc.
type Row = [f64; ARCS];

/// Finds the minima of a pair, if it is an ordinary one.
pub(crate) fn minima(a: &Circle, b: &Circle, out: &mut Minima) -> bool {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        // Wider registers take longer over a root, and nearly all here is one chain of them.
        return Simd::vectorize(simd, Single { a, b, out });
    }
    let _ = (a, b, out);
    false
}

struct Single<'a> {
    a: &'a Circle,
    b: &'a Circle,
    out: &'a mut Minima,
}

/// Arcs on which G₋ rises through 0.
struct Rising {
    middles: [Direction; ARCS],
    /// tan of a quarter of their widths.
    edges: Row,
    has_parts: bool,
    count: usize,
}

impl Rising {
    /// Adds an arc if `rises` is 1. Written in any case, so that nothing branches.
    #[inline(always)]
    fn add(&mut self, middle: Direction, rises: f64) {
        self.middles[self.count % ARCS] = middle;
        // 1.0 has this bit, 0.0 has not.
        self.count += (rises.to_bits() >> 52) as usize & 1;
    }

    /// Lanes with the arcs, the first one again in those that are left.
    #[inline(always)]
    fn bracket<S: Simd>(&self, simd: S) -> Bracket<Register<S>> {
        let (mut cos, mut sin, mut edges) = ([0.0; MAX_MINIMA], [0.0; MAX_MINIMA], [0.0; MAX_MINIMA]);
        for lane in 0..MAX_MINIMA {
            let k = if lane < self.count { lane } else { 0 };
            (cos[lane], sin[lane]) = (self.middles[k].cos, self.middles[k].sin);
            edges[lane] = self.edges[k];
        }
        let middle = Angle { cos: Register::load(simd, &cos, 0), sin: Register::load(simd, &sin, 0) };
        match self.has_parts {
            false => Bracket::arc(&TABLE.levels[0], middle),
            true => Bracket::new(middle, Register::load(simd, &edges, 0)),
        }
    }
}

impl WithSimd for Single<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Single { a, b, out } = self;
        assert!(S::F64_LANES == MAX_MINIMA, "a lane for each minimum");
        let swapped = a.radius < b.radius;
        let (base, moving) = if swapped { (b, a) } else { (a, b) };
        let framed = Placed::one(simd, base, moving).framed();
        let pair = &framed.pair;
        if !<Register<S>>::any(<Register<S>>::both(is_steep(pair), framed.is_ordinary())) {
            return false;
        }
        let Some(rising) = rising(simd, pair) else { return false };
        if rising.count == 0 || rising.count > MAX_MINIMA {
            return false;
        }
        let ([at], [good]) = roots([pair], &[rising.bracket(simd)], 1);
        if <Register<S>>::any(good.below(good.like(1.0))) {
            return false;
        }
        Points::new(simd, &framed, at, [base, moving], swapped).write(rising.count, &mut out.found);
        out.kind = if concentric(pair) { PairKind::Concentric } else { PairKind::Generic };
        true
    }
}

#[inline(always)]
fn concentric<S: Simd>(pair: &Reduced<Register<S>>) -> bool {
    let off = pair.x0.abs().max(pair.y0.abs()).max(pair.z0.abs());
    !<Register<S>>::any(off.like(ROUNDING).below(off))
}

/// The arcs on which G₋ rises, or `None` where the count does not decide.
#[inline(always)]
fn rising<S: Simd>(simd: S, pair: &Reduced<Register<S>>) -> Option<Rising> {
    let table = &*TABLE;
    let harmonics = Harmonics::new(pair, table);
    let level = &table.levels[0];
    let mut found = Rising { middles: [table.centers[0]; ARCS], edges: [level.edge; ARCS], has_parts: false, count: 0 };
    let mut modes = [[harmonics.mean; 2]; 4];
    for k in 0..4 {
        modes[k] = [harmonics.cosine[k], harmonics.sine[k]];
    }
    let origin = Angle::like(Angle { cos: pair.radius, sin: pair.radius }, table.centers[0]);
    let ([excess, rises], certain) = counted(simd, pair, &harmonics, &modes, origin, &table.whole);
    for k in 0..ARCS {
        found.add(table.centers[k], rises[k]);
    }
    if certain {
        return Some(found);
    }
    found.has_parts = true;
    for k in (0..ARCS).filter(|k| excess[*k] != 0.0) {
        let center = Angle::like(origin, table.centers[k]);
        let turn = center.turned(origin.cos, -origin.sin);
        let modes = harmonics.turned_by([turn.cos, turn.sin]);
        let ([_, rises], certain) = counted(simd, pair, &harmonics, &modes, center, &table.parts);
        if !certain {
            return None;
        }
        for part in (0..ARCS).filter(|part| rises[*part] == 1.0) {
            let [[cos, sin], ..] = &table.parts.turns;
            found.edges[found.count % ARCS] = table.levels[table.parts.level].edge;
            found.add(table.centers[k].turned(Direction { cos: cos[part], sin: sin[part] })[1], 1.0);
        }
    }
    Some(found)
}

/// How many more critical points than known each arc could have, and whether it has none and G₋ rises there (1, else 0);
/// and whether none has more.
#[inline(always)]
fn counted<S: Simd>(
    simd: S,
    pair: &Reduced<Register<S>>,
    harmonics: &Harmonics<Register<S>>,
    modes: &[[Register<S>; 2]; 4],
    origin: Angle<Register<S>>,
    fan: &Fan,
) -> ([Row; 2], bool) {
    let mut out = [[0.0; ARCS]; 2];
    let doubt = harmonics.doubt();
    let mut doubts = doubt.like(0.0);
    let (zero, one) = (doubt.like(0.0), doubt.like(1.0));
    for from in (0..ARCS).step_by(S::F64_LANES) {
        let mut ends = [Value { product: zero, minus: zero, plus: zero }; 2];
        for side in 0..2 {
            let [cos, sin] = &fan.ends[side];
            let at = origin.turned(Register::load(simd, cos, from), Register::load(simd, sin, from));
            ends[side] = Value::at(pair, at.cos, at.sin);
        }
        let mut around = *modes;
        for k in 0..4 {
            let [cos, sin] = &fan.turns[k];
            around[k] = turned(modes[k], [Register::load(simd, cos, from), Register::load(simd, sin, from)]);
        }
        let [first, last] = ends;
        let coefficients = arc_coefficients(harmonics.mean, &around, [first.product, last.product], &fan.basis);
        let excess = (changes(&coefficients, doubt) - first.changes(last)).abs();
        let rises = <Register<S>>::both(first.rises(last), excess.below(one));
        doubts = doubts + excess;
        excess.store(&mut out[0], from);
        <Register<S>>::pick(rises, one, zero).store(&mut out[1], from);
    }
    (out, !<Register<S>>::any(zero.below(doubts)))
}

/// A number of each minimum.
type Lanes = [f64; MAX_MINIMA];

#[inline(always)]
fn lanes<S: Simd>(number: Register<S>) -> Lanes {
    let mut out = [0.0; MAX_MINIMA];
    number.store(&mut out, 0);
    out
}

/// What [`Minimum`] says, for the minima in the lanes.
struct Points {
    distance: Lanes,
    base: [Lanes; 3],
    moving: [Lanes; 3],
    /// `g_αα`, `g_αθ`, `g_θθ`, with α the angle on the base.
    hessian: [Lanes; 3],
    slope: Lanes,
    /// Along the axes of B's frame.
    direction_b: [Lanes; 2],
    swapped: bool,
}

/// The points of a circle in some directions.
#[inline(always)]
fn points<S: Simd>(simd: S, circle: &Circle, direction: Vector<Register<S>>) -> [Lanes; 3] {
    let (center, radius) = (splat(simd, &circle.center), Register::all(simd, circle.radius));
    [
        lanes(direction[0].fused(radius, center[0])),
        lanes(direction[1].fused(radius, center[1])),
        lanes(direction[2].fused(radius, center[2])),
    ]
}

impl Points {
    /// As [`crate::relative::Relative::minimum`].
    #[inline(always)]
    fn new<S: Simd>(
        simd: S,
        framed: &Framed<Register<S>>,
        Angle { cos, sin }: Angle<Register<S>>,
        [base, moving]: [&Circle; 2],
        swapped: bool,
    ) -> Self {
        let pair = &framed.pair;
        let [ex, ey, rho] = pair.foot(cos, sin);
        let inverse = rho.like(1.0) / rho;
        let (foot_x, foot_y) = (ex * inverse, ey * inverse);
        let ([x, y], unit_sq) = (framed.axes, framed.scale * framed.scale);
        let (base_direction, moving_direction) = (sum(x, foot_x, y, foot_y), sum(framed.steepest, cos, y, sin));
        let [base_second, mixed, moving_second, slope] = pair.derivatives(cos, sin, [foot_x, foot_y, rho]);
        let (circle_b, direction) = if swapped { (base, base_direction) } else { (moving, moving_direction) };
        let (u, v) = circle_b.frame();
        Points {
            distance: lanes(pair.distance(cos, rho) * framed.scale),
            base: points(simd, base, base_direction),
            moving: points(simd, moving, moving_direction),
            hessian: [lanes(base_second * unit_sq), lanes(mixed * unit_sq), lanes(moving_second * unit_sq)],
            slope: lanes(slope * unit_sq),
            direction_b: [lanes(dot(direction, splat(simd, &u))), lanes(dot(direction, splat(simd, &v)))],
            swapped,
        }
    }

    #[inline(always)]
    fn minimum(&self, lane: usize) -> Minimum {
        let (base, moving, [second, mixed, moving_second]) = (&self.base, &self.moving, &self.hessian);
        Minimum::of_base(
            self.distance[lane],
            [
                Vec3::new(base[0][lane], base[1][lane], base[2][lane]),
                Vec3::new(moving[0][lane], moving[1][lane], moving[2][lane]),
            ],
            [self.direction_b[0][lane], self.direction_b[1][lane]],
            self.slope[lane],
            [second[lane], mixed[lane], moving_second[lane]],
            self.swapped,
        )
    }

    /// The minima in ascending order. More than two have never been seen.
    #[inline(always)]
    fn write(&self, count: usize, out: &mut ArrayVec<Minimum, MAX_MINIMA>) {
        // Two in any case: whether there is a second is anyone's guess. The lanes of one alone are the same.
        let first = usize::from(self.distance[1] < self.distance[0]);
        out.push(self.minimum(first));
        out.push(self.minimum(1 - first));
        out.truncate(count);
        if count > 2 {
            out.extend((2..count).map(|lane| self.minimum(lane)));
            out.sort_unstable_by(|p, q| p.distance.total_cmp(&q.distance));
        }
    }
}
