//! The minima of one pair with the pair's arcs, then its minima, side by side in registers.
//!
//! The count of [`crate::brackets`] for all eight arcs at once; an arc in doubt is cut into eight parts, counted in the same way.
//! What is still in doubt is left to [`crate::quick`].

use crate::brackets::{Angle, Bracket, Value, is_steep};
use crate::count::{ARCS, Fan, Harmonics, TABLE, arc_coefficients, changes, turned};
use crate::lane::{Lane, Register};
use crate::minima::{Minima, Minimum, PairKind};
use crate::placed::{Framed, Placed, dot, splat, sum};
use crate::quick::roots;
use crate::relative::Reduced;
use crate::{Circle, MAX_MINIMA, ROUNDING, Vec3};
use arrayvec::ArrayVec;
use pulp::{Simd, WithSimd};

/// One number for each arc, or for each minimum.
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

/// Arcs on which G₋ rises through 0: their centres, and tan of a quarter of their widths.
struct Rising {
    cos: Row,
    sin: Row,
    edge: Row,
    count: usize,
    has_parts: bool,
}

impl Rising {
    /// Adds an arc if `rises` is 1. Written in any case, so that nothing branches.
    #[inline(always)]
    fn add(&mut self, [cos, sin]: [f64; 2], edge: f64, rises: f64) {
        let place = self.count % ARCS;
        (self.cos[place], self.sin[place], self.edge[place]) = (cos, sin, edge);
        self.count += usize::from(rises == 1.0);
    }

    /// The first one again in the lanes that are left.
    #[inline(always)]
    fn fill(&mut self) {
        for k in 1..MAX_MINIMA {
            if k >= self.count {
                (self.cos[k], self.sin[k], self.edge[k]) = (self.cos[0], self.sin[0], self.edge[0]);
            }
        }
    }
}

impl WithSimd for Single<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Single { a, b, out } = self;
        let swapped = a.radius < b.radius;
        let (base, moving) = if swapped { (b, a) } else { (a, b) };
        let framed = Placed::one(simd, base, moving).framed();
        let pair = &framed.pair;
        if !<Register<S>>::any(<Register<S>>::both(is_steep(pair), framed.is_tilted())) {
            return false;
        }
        let Some(rising) = rising(simd, pair) else { return false };
        if rising.count == 0 || rising.count > MAX_MINIMA.min(S::F64_LANES) {
            return false;
        }
        let middle = Angle { cos: Register::load(simd, &rising.cos, 0), sin: Register::load(simd, &rising.sin, 0) };
        let level = &TABLE.levels[0];
        let bracket = match rising.has_parts {
            false => Bracket::arc(level, middle),
            true => Bracket::new(middle, Register::load(simd, &rising.edge, 0)),
        };
        let ([at], [good]) = roots([pair], &[bracket], 1);
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
    let mut found = Rising { cos: [1.0; ARCS], sin: [0.0; ARCS], edge: [table.levels[0].edge; ARCS], count: 0, has_parts: false };
    let mut modes = [[harmonics.mean; 2]; 4];
    for k in 0..4 {
        modes[k] = [harmonics.cosine[k], harmonics.sine[k]];
    }
    let origin = Angle::like(Angle { cos: pair.radius, sin: pair.radius }, table.centers[0]);
    let ([excess, rises], certain) = counted(simd, pair, &harmonics, &modes, origin, &table.whole);
    for k in 0..ARCS {
        found.add([table.centers[k].cos, table.centers[k].sin], table.levels[0].edge, rises[k]);
    }
    if certain {
        found.fill();
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
            let [[cos, sin], ..] = table.parts.turns;
            let crate::grid::Direction { cos: x, sin: y } = table.centers[k];
            let middle = [x * cos[part] - y * sin[part], y * cos[part] + x * sin[part]];
            found.add(middle, table.levels[table.parts.level].edge, 1.0);
        }
    }
    found.fill();
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

/// What [`Minimum`] says, for the minima in the lanes.
struct Points {
    distance: Row,
    base: [Row; 3],
    moving: [Row; 3],
    /// `g_αα`, `g_αθ`, `g_θθ`, with α the angle on the base.
    hessian: [Row; 3],
    slope: Row,
    /// Along the axes of B's frame.
    direction_b: [Row; 2],
    swapped: bool,
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
        let row = [0.0; ARCS];
        let mut out = Points {
            distance: row,
            base: [row; 3],
            moving: [row; 3],
            hessian: [row; 3],
            slope: row,
            direction_b: [row; 2],
            swapped,
        };
        let [ex, ey, rho] = pair.foot(cos, sin);
        let inverse = rho.like(1.0) / rho;
        let (foot_x, foot_y) = (ex * inverse, ey * inverse);
        let ([x, y], unit_sq) = (framed.axes, framed.scale * framed.scale);
        let (base_direction, moving_direction) = (sum(x, foot_x, y, foot_y), sum(framed.steepest, cos, y, sin));
        (pair.distance(cos, rho) * framed.scale).store(&mut out.distance, 0);
        for (circle, direction, place) in
            [(base, base_direction, &mut out.base), (moving, moving_direction, &mut out.moving)]
        {
            let (center, radius) = (splat(simd, &circle.center), Register::all(simd, circle.radius));
            for axis in 0..3 {
                direction[axis].fused(radius, center[axis]).store(&mut place[axis], 0);
            }
        }
        let [base_second, mixed, moving_second, slope] = pair.derivatives(cos, sin, [foot_x, foot_y, rho]);
        for (number, place) in [base_second, mixed, moving_second].into_iter().zip(&mut out.hessian) {
            (number * unit_sq).store(place, 0);
        }
        (slope * unit_sq).store(&mut out.slope, 0);
        let (circle_b, direction) = if swapped { (base, base_direction) } else { (moving, moving_direction) };
        let (u, v) = circle_b.frame();
        for (axis, place) in [u, v].into_iter().zip(&mut out.direction_b) {
            dot(direction, splat(simd, &axis)).store(place, 0);
        }
        out
    }

    #[inline(always)]
    fn minimum(&self, lane: usize) -> Minimum {
        let vector = |rows: &[Row; 3]| Vec3::new(rows[0][lane], rows[1][lane], rows[2][lane]);
        let (base_point, moving_point) = (vector(&self.base), vector(&self.moving));
        let [base, mixed, moving] = [0, 1, 2].map(|k| self.hessian[k][lane]);
        let direction_b = [self.direction_b[0][lane], self.direction_b[1][lane]];
        Minimum::of_base(
            self.distance[lane],
            [base_point, moving_point],
            direction_b,
            self.slope[lane],
            [base, mixed, moving],
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
