//! Where between two directions, by their heights and slopes, a larger height may be.

/// Directions closer than this are not divided, in degrees.
pub(super) const CLOSE_DEG: f64 = 4e-6;
/// The end of the directions with a state is found to this, in degrees.
pub(super) const END_DEG: f64 = 1e-3;
/// Directions that are tried are multiples of this part of a degree.
const STEPS_PER_DEGREE: f64 = 1e6;
/// A place is tried no nearer to the ends of its interval than this share of its width.
const MARGIN: f64 = 0.02;

/// A direction with its limit, as a height that is to be as large as can be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub deg: f64,
    pub height: Option<f64>,
    /// Whether no state was found: what has limits ends before it.
    pub ends: bool,
    /// Derivative of the height by the angle in radians; none where it is not known.
    pub slope: Option<f64>,
    /// Whether a mirror maps the direction to itself: then a state and its image have opposite slopes, and each side has one of them.
    pub mirrored: bool,
}

/// A place between two directions, and the height that it may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub deg: f64,
    pub promise: f64,
    /// The limit whose state is followed this way, as far as it goes.
    pub from_deg: Option<f64>,
}

/// The way from a limit to a direction without a state, where the height rises that way: as high as its tangent at most.
pub(super) fn end(last: &Point, end: &Point) -> Option<Place> {
    let width = (end.deg - last.deg).to_radians();
    let slope = last.slope?;
    let rise = if last.mirrored { slope.abs() * width.abs() } else { slope * width };
    let promise = last.height? + rise;
    let open = end.ends && !last.ends && rise > 0.0 && (end.deg - last.deg).abs() > 1.5 * END_DEG;
    open.then_some(Place { deg: end.deg, promise, from_deg: Some(last.deg) })
}

pub(super) fn rounded(deg: f64) -> f64 {
    (deg * STEPS_PER_DEGREE).round() / STEPS_PER_DEGREE
}

/// Where between two directions the height may be larger, and how large: where the tangents meet, or where the cubic through both is largest.
/// None where it need not rise between them.
pub(super) fn place(a: &Point, b: &Point, smooth: bool) -> Option<Place> {
    let width = (b.deg - a.deg).to_radians();
    let (from, to) = (a.height?, b.height?);
    // On a mirror's line: the slope that fits the other end and the rise between them, as of a parabola.
    let (mut rise, mut fall, mean) = (a.slope?, b.slope?, (to - from) / width);
    if a.mirrored {
        rise = rise.abs().copysign(if b.mirrored { mean } else { 2.0 * mean - fall });
    }
    if b.mirrored {
        fall = fall.abs().copysign(if a.mirrored { mean } else { 2.0 * mean - rise });
    }
    if b.deg - a.deg < CLOSE_DEG {
        return None;
    }
    let peaks = (rise > 0.0 && (fall < 0.0 || to < from)) || (fall < 0.0 && from < to);
    if !peaks {
        return None;
    }
    let meet = (to - from - fall * width) / (rise - fall);
    let meets = rise > fall && meet > 0.0 && meet < width;
    // Tangents that do not meet in between: the height bends up and down again.
    let promise = if meets { from + rise * meet } else { from.max(to) + 0.25 * width * rise.max(-fall) };
    let share = match (smooth, meets) {
        (true, _) => cubic_peak(from, to, rise * width, fall * width),
        (false, true) => Some(meet / width),
        (false, false) => None,
    };
    let share = share.unwrap_or(if from > to { 0.25 } else { 0.75 }).clamp(MARGIN, 1.0 - MARGIN);
    let deg = rounded(a.deg + share * (b.deg - a.deg));
    (deg > a.deg && deg < b.deg).then_some(Place { deg, promise, from_deg: None })
}

/// Where in 0..1 the cubic with these ends and slopes has its peak.
fn cubic_peak(from: f64, to: f64, rise: f64, fall: f64) -> Option<f64> {
    // c₃ t³ + c₂ t² + rise t + from.
    let (c2, c3) = (3.0 * (to - from) - 2.0 * rise - fall, rise + fall - 2.0 * (to - from));
    let root = (c2 * c2 - 3.0 * c3 * rise).sqrt();
    // The root where the second derivative 6 c₃ t + 2 c₂ is negative, without cancellation.
    let t = if c2 < 0.0 { rise / (root - c2) } else { -(c2 + root) / (3.0 * c3) };
    (t > 0.0 && t < 1.0).then_some(t)
}
