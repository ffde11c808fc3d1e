//! How a curve looks: colour, line and marker together, so that no reader needs all three.

use super::canvas::{Canvas, Stroke};
use super::palette;

/// Half the size of a marker.
pub(super) const MARKER: f64 = 3.6;

/// Line and marker of a curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) color: String,
    pub(super) width: f64,
    pub(super) dash: &'static str,
    pub(super) marker: Marker,
}

/// Shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Marker {
    shape: &'static [[f64; 2]],
    pub(super) filled: bool,
    /// Relative to others.
    size: f64,
}

impl Marker {
    fn of_rank(rank: i32) -> Self {
        Self { shape: palette::marker(rank), filled: true, size: 1.0 }
    }
}

impl Look {
    pub(super) fn stroke(&self) -> Stroke<'_> {
        Stroke { color: &self.color, width: self.width, dash: self.dash }
    }

    /// The same with a hollow marker if `hollow`.
    pub(super) fn hollow_if(&self, hollow: bool) -> Look {
        Look { marker: Marker { filled: !hollow, ..self.marker }, ..self.clone() }
    }

    /// The same with another shape of its marker, filled.
    pub(super) fn with_shape(&self, shape: &'static [[f64; 2]]) -> Look {
        Look { marker: Marker { shape, filled: true, size: 1.0 }, ..self.clone() }
    }

    pub(super) fn draw_marker(&self, canvas: &mut Canvas, at: [f64; 2], size: f64) {
        let fill = if self.marker.filled { &self.color } else { "#ffffff" };
        let stroke = Stroke::solid(&self.color, 1.4);
        let size = size * self.marker.size;
        if self.marker.shape.is_empty() {
            canvas.circle(at, size, fill, stroke);
        } else {
            let points: Vec<_> = self.marker.shape.iter().map(|p| [at[0] + size * p[0], at[1] + size * p[1]]).collect();
            canvas.path(&points, true, fill, stroke);
        }
    }
}

/// Looks of curves that differ in l2: black at 0, blue below, orange above, stronger the further away.
pub(super) fn of_l2(l2: &[f64]) -> Vec<Look> {
    let side = |sign: f64| {
        let mut side: Vec<f64> = l2.iter().map(|l2| l2 * sign).filter(|l2| *l2 > 0.0).collect();
        side.sort_by(f64::total_cmp);
        side.dedup();
        side
    };
    let (below, above) = (side(-1.0), side(1.0));
    let (blues, oranges) = (palette::negative(below.len()), palette::positive(above.len()));
    let rank = |side: &[f64], l2: f64| side.iter().position(|x| *x == l2).unwrap_or(0);
    let look = |&l2: &f64| {
        let (color, width, rank) = if l2 < 0.0 {
            let i = rank(&below, -l2);
            (blues[i].clone(), 1.9, -(i as i32) - 1)
        } else if l2 > 0.0 {
            let i = rank(&above, l2);
            (oranges[i].clone(), 1.9, i as i32 + 1)
        } else {
            (palette::NEUTRAL.to_owned(), 2.6, 0)
        };
        Look { color, width, dash: "", marker: Marker::of_rank(rank) }
    };
    l2.iter().map(look).collect()
}

/// Looks of `count` records: one line wide and the next narrow and broken, markers alike, so that both are seen where they
/// coincide.
pub(super) fn of_records(count: usize) -> Vec<Look> {
    let look = |i: usize| Look {
        color: palette::record(i).to_owned(),
        width: if i == 0 { 3.2 } else { [2.3, 1.7][i % 2] },
        dash: palette::dash(i),
        marker: Marker { shape: palette::record_marker(i), filled: true, size: [1.3, 0.9][i % 2] },
    };
    (0..count).map(look).collect()
}

impl Look {
    /// The look of a record's curve among those of several l2, which the marker tells.
    pub(super) fn with_l2(&self, l2: &Look) -> Look {
        Look { marker: Marker { size: self.marker.size, ..l2.marker }, ..self.clone() }
    }
}

/// A hollow circle, for the legend.
pub(super) fn hollow() -> Look {
    Look {
        color: palette::NEUTRAL.to_owned(),
        width: 1.4,
        dash: "",
        marker: Marker { shape: &[], filled: false, size: 1.0 },
    }
}
