//! The fast method for one pair in SIMD registers (AVX2): its arcs, then its minima, lie side by side in the lanes.
//!
//! The roots on all eight arcs are counted at once, four per register. An arc in doubt is divided into eight parts,
//! which are counted in the same way. Pairs that are still in doubt are left to the plain `f64` code.

use crate::circle::{Circle, Vec3};
use crate::circle_circle::angle::{Angle, Direction};
use crate::circle_circle::fast::arc_tables::{ARC_TABLES, ARCS, ArcFan};
use crate::circle_circle::fast::bernstein::{Harmonics, bernstein_on_arc, rotate_harmonic, sign_changes};
use crate::circle_circle::fast::bracket::Bracket;
use crate::circle_circle::fast::halley::halley_roots;
use crate::circle_circle::fast::root_count::{FactorSigns, is_steep};
use crate::circle_circle::minimum::{MAX_MINIMA, Minima, Minimum, PairKind};
use crate::circle_circle::normalized_pair::NormalizedPair;
use crate::circle_circle::simd_frame::{PairFrames, PairVectors, Vector, broadcast_vector, dot, linear_combination};
use crate::simd::{Register, SimdReal};
use crate::tolerance::ROUNDING;
use arrayvec::ArrayVec;
use pulp::{Simd, WithSimd};

/// One value per arc.
type ArcLanes = [f64; ARCS];

/// Writes all minima of a pair to `out`. False, with `out` unchanged, if the pair cannot be decided here or the
/// machine has no AVX2.
pub(crate) fn minima(a: &Circle, b: &Circle, out: &mut Minima) -> bool {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        // AVX-512 is slower here: square roots take longer in wider registers, and nearly all is one chain of them.
        return Simd::vectorize(simd, SinglePairKernel { a, b, out });
    }
    let _ = (a, b, out);
    false
}

/// The arguments of [`minima`], to be run with an instruction set.
struct SinglePairKernel<'a> {
    a: &'a Circle,
    b: &'a Circle,
    out: &'a mut Minima,
}

/// The arcs on which `G₋` rises through 0: one minimum each.
struct RisingArcs {
    middles: [Direction; ARCS],
    /// Tangents of a quarter of their widths.
    quarter_tans: ArcLanes,
    /// Whether parts of arcs are among them, so that widths differ.
    has_parts: bool,
    count: usize,
}

impl RisingArcs {
    /// Adds an arc if `rises` is 1, and nothing if it is 0. Without a branch: it is written in any case and then
    /// counted or not.
    #[inline(always)]
    fn add(&mut self, middle: Direction, rises: f64) {
        self.middles[self.count % ARCS] = middle;
        // This bit is set in 1.0 and clear in 0.0.
        self.count += (rises.to_bits() >> 52) as usize & 1;
    }

    /// One bracket per lane; unused lanes repeat the first.
    #[inline(always)]
    fn bracket<S: Simd>(&self, simd: S) -> Bracket<Register<S>> {
        let (mut cos, mut sin, mut quarter_tans) = ([0.0; MAX_MINIMA], [0.0; MAX_MINIMA], [0.0; MAX_MINIMA]);
        for lane in 0..MAX_MINIMA {
            let k = if lane < self.count { lane } else { 0 };
            (cos[lane], sin[lane]) = (self.middles[k].cos, self.middles[k].sin);
            quarter_tans[lane] = self.quarter_tans[k];
        }
        let middle = Angle { cos: Register::load(simd, &cos, 0), sin: Register::load(simd, &sin, 0) };
        match self.has_parts {
            false => Bracket::on_arc(&ARC_TABLES.levels[0], middle),
            true => Bracket::new(middle, Register::load(simd, &quarter_tans, 0)),
        }
    }
}

impl WithSimd for SinglePairKernel<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let SinglePairKernel { a, b, out } = self;
        assert!(S::F64_LANES == MAX_MINIMA, "a lane for each minimum");
        // The common frame, the same in every lane.
        let swapped = a.radius < b.radius;
        let (base, moving) = if swapped { (b, a) } else { (a, b) };
        let frames = PairVectors::broadcast(simd, base, moving).frames();
        let pair = &frames.pair;
        if !<Register<S>>::any(<Register<S>>::and(is_steep(pair), frames.is_regular())) {
            return false;
        }
        // Isolate.
        let Some(rising) = rising_arcs(simd, pair) else { return false };
        if rising.count == 0 || rising.count > MAX_MINIMA {
            return false;
        }
        // Refine, all minima at once.
        let ([at], [good]) = halley_roots([pair], &[rising.bracket(simd)], 1);
        if <Register<S>>::any(good.lt(good.splat(1.0))) {
            return false;
        }
        MinimaLanes::new(simd, &frames, at, [base, moving], swapped).write(rising.count, &mut out.found);
        out.kind = if is_concentric(pair) { PairKind::Concentric } else { PairKind::Generic };
        true
    }
}

/// Do the centres coincide up to [`ROUNDING`]?
#[inline(always)]
fn is_concentric<S: Simd>(pair: &NormalizedPair<Register<S>>) -> bool {
    let off = pair.x0.abs().max(pair.y0.abs()).max(pair.z0.abs());
    !<Register<S>>::any(off.splat(ROUNDING).lt(off))
}

/// The arcs on which `G₋` rises through 0, or `None` if the root count does not decide.
#[inline(always)]
fn rising_arcs<S: Simd>(simd: S, pair: &NormalizedPair<Register<S>>) -> Option<RisingArcs> {
    let tables = &*ARC_TABLES;
    let harmonics = Harmonics::new(pair, tables);
    let level = &tables.levels[0];
    let mut found = RisingArcs {
        middles: [tables.centers[0]; ARCS],
        quarter_tans: [level.quarter_tan; ARCS],
        has_parts: false,
        count: 0,
    };
    // All eight arcs.
    let mut modes = [[harmonics.mean; 2]; 4];
    for k in 0..4 {
        modes[k] = [harmonics.cosine[k], harmonics.sine[k]];
    }
    let origin = Angle::splat(Angle { cos: pair.radius, sin: pair.radius }, tables.centers[0]);
    let ([excess, rises], certain) = count_roots(simd, pair, &harmonics, &modes, origin, &tables.all_arcs);
    for k in 0..ARCS {
        found.add(tables.centers[k], rises[k]);
    }
    if certain {
        return Some(found);
    }
    // Arcs in doubt, in eight parts each.
    found.has_parts = true;
    for k in (0..ARCS).filter(|k| excess[*k] != 0.0) {
        let center = Angle::splat(origin, tables.centers[k]);
        let turn = center.rotated(origin.cos, -origin.sin);
        let modes = harmonics.rotated_by([turn.cos, turn.sin]);
        let ([_, rises], certain) = count_roots(simd, pair, &harmonics, &modes, center, &tables.sub_arcs);
        if !certain {
            return None;
        }
        for part in (0..ARCS).filter(|part| rises[*part] == 1.0) {
            let [[cos, sin], ..] = &tables.sub_arcs.turns;
            found.quarter_tans[found.count % ARCS] = tables.levels[tables.sub_arcs.level].quarter_tan;
            found.add(tables.centers[k].rotated_both_ways(Direction { cos: cos[part], sin: sin[part] })[1], 1.0);
        }
    }
    Some(found)
}

/// Compares the two bounds of the number of roots (`fast/root_count.rs`) on eight arcs, four per register.
///
/// Returned are the excess of each arc; whether its roots are known and `G₋` rises there (1, else 0); and whether
/// the roots on all arcs are known. `modes` are the harmonics of H about `origin`.
#[inline(always)]
fn count_roots<S: Simd>(
    simd: S,
    pair: &NormalizedPair<Register<S>>,
    harmonics: &Harmonics<Register<S>>,
    modes: &[[Register<S>; 2]; 4],
    origin: Angle<Register<S>>,
    fan: &ArcFan,
) -> ([ArcLanes; 2], bool) {
    let mut out = [[0.0; ARCS]; 2];
    let threshold = harmonics.product_threshold();
    let mut total_excess = threshold.splat(0.0);
    let (zero, one) = (threshold.splat(0.0), threshold.splat(1.0));
    for from in (0..ARCS).step_by(S::F64_LANES) {
        // Lower bound: signs at the ends.
        let mut ends = [FactorSigns { product: zero, minus: zero, plus: zero }; 2];
        for side in 0..2 {
            let [cos, sin] = &fan.ends[side];
            let at = origin.rotated(Register::load(simd, cos, from), Register::load(simd, sin, from));
            ends[side] = FactorSigns::at(pair, at.cos, at.sin);
        }
        // Upper bound: Bernstein coefficients on the arcs.
        let mut rotated = *modes;
        for k in 0..4 {
            let [cos, sin] = &fan.turns[k];
            rotated[k] = rotate_harmonic(modes[k], [Register::load(simd, cos, from), Register::load(simd, sin, from)]);
        }
        let [first, last] = ends;
        let coefficients = bernstein_on_arc(harmonics.mean, &rotated, [first.product, last.product], &fan.basis);
        let excess = (sign_changes(&coefficients, threshold) - first.sign_changes(last)).abs();
        let rises = <Register<S>>::and(first.rises(last), excess.lt(one));
        total_excess = total_excess + excess;
        excess.store(&mut out[0], from);
        <Register<S>>::select(rises, one, zero).store(&mut out[1], from);
    }
    (out, !<Register<S>>::any(zero.lt(total_excess)))
}

/// One value per minimum.
type MinimumLanes = [f64; MAX_MINIMA];

/// The lanes of a register, stored in memory.
#[inline(always)]
fn to_lanes<S: Simd>(number: Register<S>) -> MinimumLanes {
    let mut out = [0.0; MAX_MINIMA];
    number.store(&mut out, 0);
    out
}

/// The fields of [`Minimum`], for the minima in the lanes.
struct MinimaLanes {
    distance: MinimumLanes,
    /// Points on the base circle.
    base: [MinimumLanes; 3],
    /// Points on the moving circle.
    moving: [MinimumLanes; 3],
    /// `g_αα`, `g_αθ`, `g_θθ`, with `α` the angle on the base.
    hessian: [MinimumLanes; 3],
    slope: MinimumLanes,
    /// Cosine and sine of the angle in B's own frame.
    direction_b: [MinimumLanes; 2],
    swapped: bool,
}

/// The points of a circle in given directions from its centre.
#[inline(always)]
fn points_on_circle<S: Simd>(simd: S, circle: &Circle, direction: Vector<Register<S>>) -> [MinimumLanes; 3] {
    let (center, radius) = (broadcast_vector(simd, &circle.center), Register::broadcast(simd, circle.radius));
    [
        to_lanes(direction[0].mul_add(radius, center[0])),
        to_lanes(direction[1].mul_add(radius, center[1])),
        to_lanes(direction[2].mul_add(radius, center[2])),
    ]
}

impl MinimaLanes {
    /// Same formulas as `PairFrame::minimum`.
    #[inline(always)]
    fn new<S: Simd>(
        simd: S,
        frames: &PairFrames<Register<S>>,
        Angle { cos, sin }: Angle<Register<S>>,
        [base, moving]: [&Circle; 2],
        swapped: bool,
    ) -> Self {
        // The foot on the base circle, and the directions from the centres to the points.
        let pair = &frames.pair;
        let [ex, ey, rho] = pair.position_and_rho(cos, sin);
        let inverse = rho.splat(1.0) / rho;
        let (foot_x, foot_y) = (ex * inverse, ey * inverse);
        let ([x, y], unit_sq) = (frames.axes, frames.scale * frames.scale);
        let (base_direction, moving_direction) =
            (linear_combination(x, foot_x, y, foot_y), linear_combination(frames.steepest, cos, y, sin));
        let [base_second, mixed, moving_second, slope] = pair.distance_derivatives(cos, sin, [foot_x, foot_y, rho]);
        // Direction in B's own frame.
        let (circle_b, direction) = if swapped { (base, base_direction) } else { (moving, moving_direction) };
        let (u, v) = circle_b.frame();
        MinimaLanes {
            distance: to_lanes(pair.distance(cos, rho) * frames.scale),
            base: points_on_circle(simd, base, base_direction),
            moving: points_on_circle(simd, moving, moving_direction),
            hessian: [to_lanes(base_second * unit_sq), to_lanes(mixed * unit_sq), to_lanes(moving_second * unit_sq)],
            slope: to_lanes(slope * unit_sq),
            direction_b: [
                to_lanes(dot(direction, broadcast_vector(simd, &u))),
                to_lanes(dot(direction, broadcast_vector(simd, &v))),
            ],
            swapped,
        }
    }

    /// The minimum in one lane.
    #[inline(always)]
    fn minimum(&self, lane: usize) -> Minimum {
        let (base, moving, [second, mixed, moving_second]) = (&self.base, &self.moving, &self.hessian);
        Minimum::from_base(
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

    /// Appends the minima in ascending order. More than two have never been observed.
    #[inline(always)]
    fn write(&self, count: usize, out: &mut ArrayVec<Minimum, MAX_MINIMA>) {
        // Two are written in any case, since a branch on their number would be mispredicted. A single one fills all
        // lanes.
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
