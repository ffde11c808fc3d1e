//! Colours and markers that stay apart for colour-blind readers and in grey print.

/// Colour of each of `count` curves on the negative side, from the one nearest to zero outward.
pub(super) fn negative(count: usize) -> Vec<String> {
    shades(count, &[[0x56, 0xa0, 0xd3], [0x2a, 0x72, 0xb5], [0x15, 0x49, 0x8c], [0x0b, 0x27, 0x5c]])
}

/// Colour of each of `count` curves on the positive side, from the one nearest to zero outward.
pub(super) fn positive(count: usize) -> Vec<String> {
    shades(count, &[[0xf0, 0x9c, 0x42], [0xdb, 0x69, 0x17], [0xa8, 0x40, 0x10], [0x66, 0x22, 0x08]])
}

/// Colour of the curve at zero.
pub(super) const NEUTRAL: &str = "#222222";

/// Colours of records: those of Okabe and Ito that are dark enough on white, neighbours far apart in grey.
pub(super) fn record(i: usize) -> &'static str {
    const COLORS: [&str; 7] = ["#0072b2", "#e69f00", "#222222", "#cc79a7", "#009e73", "#d55e00", "#56b4e9"];
    COLORS[i % COLORS.len()]
}

/// Broken lines of records: with the colours, 35 pairs before one comes again.
pub(super) fn dash(i: usize) -> &'static str {
    const DASHES: [&str; 5] = ["", "7 4", "1.5 4", "9 3.5 1.5 3.5", "14 4"];
    DASHES[i % DASHES.len()]
}

fn shades(count: usize, ramp: &[[u8; 3]; 4]) -> Vec<String> {
    // Few curves keep away from the ends, many fill the ramp.
    let margin = 0.3 * 4usize.saturating_sub(count) as f64;
    let at = |i: usize| if count == 1 { 1.3 } else { margin + (3.0 - 2.0 * margin) * i as f64 / (count - 1) as f64 };
    (0..count).map(|i| color(ramp, at(i))).collect()
}

fn color(ramp: &[[u8; 3]; 4], t: f64) -> String {
    let i = (t.floor() as usize).min(2);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * (t - i as f64)).round() as u8;
    let [r, g, b] = [0, 1, 2].map(|k| mix(ramp[i][k], ramp[i + 1][k]));
    format!("#{r:02x}{g:02x}{b:02x}")
}

type Shape = &'static [[f64; 2]];

const CIRCLE: Shape = &[];
const SQUARE: Shape = &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]];
const DIAMOND: Shape = &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]];
const DOWN: Shape = &[[-1.2, -0.8], [1.2, -0.8], [0.0, 1.3]];
const UP: Shape = &[[-1.2, 0.8], [1.2, 0.8], [0.0, -1.3]];
const HOURGLASS: Shape = &[[-1.0, -1.1], [1.0, -1.1], [-1.0, 1.1], [1.0, 1.1]];
const PLUS: Shape = &[
    [-0.4, -1.2],
    [0.4, -1.2],
    [0.4, -0.4],
    [1.2, -0.4],
    [1.2, 0.4],
    [0.4, 0.4],
    [0.4, 1.2],
    [-0.4, 1.2],
    [-0.4, 0.4],
    [-1.2, 0.4],
    [-1.2, -0.4],
    [-0.4, -0.4],
];

/// A thin ×: nothing was found.
pub(super) const CROSS: Shape = &[
    [0.67, -1.03],
    [1.03, -0.67],
    [0.35, 0.0],
    [1.03, 0.67],
    [0.67, 1.03],
    [0.0, 0.35],
    [-0.67, 1.03],
    [-1.03, 0.67],
    [-0.35, 0.0],
    [-1.03, -0.67],
    [-0.67, -1.03],
    [0.0, -0.35],
];

/// A dash: there is nothing.
pub(super) const DASH: Shape = &[[-1.3, -0.3], [1.3, -0.3], [1.3, 0.3], [-1.3, 0.3]];

/// Shapes of the markers of records: a polygon around the origin; a circle if empty.
pub(super) fn record_marker(i: usize) -> Shape {
    [CIRCLE, SQUARE, DIAMOND, DOWN, UP, PLUS, HOURGLASS][i % 7]
}

/// The same of l2 by its rank: 0 the sheet as it is, below and above it others.
pub(super) fn marker(rank: i32) -> Shape {
    let side = match rank.signum() {
        0 => return CIRCLE,
        -1 => [SQUARE, DOWN, HOURGLASS],
        _ => [DIAMOND, UP, PLUS],
    };
    side[(rank.unsigned_abs() as usize - 1) % 3]
}
