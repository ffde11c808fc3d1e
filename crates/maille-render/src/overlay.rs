//! What is written over the picture: scale bar, outline of the cell, what colours and arrows mean.

use super::{
    camera::Camera,
    color,
    options::{Background, Caption},
    scene::Scene,
};
use maille::lattice::Direction;
use maille_geometry::Vec3;
use std::fmt::Write;

/// Words and lines over the picture, as SVG.
pub(super) struct Overlay<'a> {
    pub(super) scene: &'a Scene,
    pub(super) camera: &'a Camera,
    pub(super) size: [u32; 2],
    pub(super) background: Background,
    /// Lengths of the scene in one of the shown unit, and the unit's name; none without a scale bar.
    pub(super) scale: Option<(f64, String)>,
    pub(super) perspective: bool,
    pub(super) caption: Option<&'a Caption>,
}

/// Size of letters for a picture of this size.
pub(super) fn letters(size: [u32; 2]) -> f64 {
    (0.019 * f64::from(size[0]).min(1.4 * f64::from(size[1]))).max(9.0)
}

/// Height of the strip below the sheet for scale bar and keys.
pub(super) fn strip(size: [u32; 2]) -> f64 {
    3.0 * letters(size)
}

/// Height of the strip above the sheet for a caption.
pub(super) fn heading(size: [u32; 2]) -> f64 {
    2.0 * letters(size)
}

/// Distance of everything from the picture's edge.
pub(super) fn margin(size: [u32; 2]) -> f64 {
    0.035 * f64::from(size[0].min(size[1]))
}

impl Overlay<'_> {
    /// The SVG; nothing if nothing is to be written.
    pub(super) fn svg(&self) -> Option<String> {
        let mut out = String::new();
        if let Some(corners) = self.scene.cell {
            self.cell(&mut out, corners.map(|p| self.camera.project(&p)));
        }
        if let Some((length, unit)) = &self.scale {
            self.scale_bar(&mut out, *length, unit);
        }
        self.keys(&mut out);
        if let Some(caption) = self.caption {
            self.heading(&mut out, caption);
        }
        if out.is_empty() {
            return None;
        }
        let [w, h] = self.size;
        Some(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"DejaVu Sans\">\n{out}</svg>\n"
        ))
    }

    fn ink(&self) -> &'static str {
        match self.background {
            Background::Dark => "#e8e8e8",
            Background::White | Background::Transparent => "#222222",
        }
    }

    fn base_line(&self) -> f64 {
        f64::from(self.size[1]) - margin(self.size)
    }

    fn scale_bar(&self, out: &mut String, length: f64, unit: &str) {
        let (ink, size, y) = (self.ink(), letters(self.size), self.base_line());
        let most = 0.2 * f64::from(self.size[0]) * self.camera.pixel / length;
        let count = round_below(most);
        let (x, width) = (margin(self.size), count * length / self.camera.pixel);
        let thick = (0.16 * size).max(1.5);
        let tick = 0.3 * size;
        let _ = writeln!(
            out,
            "<path d=\"M{x:.2} {:.2}V{:.2}M{x:.2} {y:.2}H{:.2}M{:.2} {:.2}V{:.2}\" stroke=\"{ink}\" fill=\"none\" \
             stroke-width=\"{thick:.2}\" stroke-linecap=\"square\"/>",
            y - tick,
            y + tick,
            x + width,
            x + width,
            y - tick,
            y + tick,
        );
        let place = if self.perspective { " in the middle" } else { "" };
        let label = format!("{count} {unit}{place}");
        text(out, [x, y - 0.75 * size], size, ink, "start", &label);
    }

    /// Keys of load and force, from the right.
    fn keys(&self, out: &mut String) {
        let (ink, size, y) = (self.ink(), letters(self.size), self.base_line());
        let mut right = f64::from(self.size[0]) - margin(self.size);
        if let Some(most) = self.scene.most_load {
            let width = 11.0 * size;
            let left = right - width;
            let _ = write!(out, "<defs><linearGradient id=\"load\">");
            for (k, stop) in color::LOADS.iter().enumerate() {
                let offset = k as f64 / (color::LOADS.len() - 1) as f64;
                let _ = write!(out, "<stop offset=\"{offset}\" stop-color=\"#{stop:06x}\"/>");
            }
            let _ = writeln!(
                out,
                "</linearGradient></defs><rect x=\"{left:.2}\" y=\"{:.2}\" width=\"{width:.2}\" height=\"{:.2}\" \
                 fill=\"url(#load)\"/>",
                y - 0.35 * size,
                0.5 * size
            );
            text(out, [left, y - 0.75 * size], size, ink, "start", "load  0");
            text(out, [right, y - 0.75 * size], size, ink, "end", &significant(most));
            right = left - 2.0 * size;
        }
        if let Some(most) = self.scene.most_force {
            let color = color::FORCE;
            let (tip, tail, half) = (right, right - 3.4 * size, 0.32 * size);
            let neck = tip - 1.3 * size;
            let _ = writeln!(
                out,
                "<path d=\"M{tail:.2} {y:.2}H{neck:.2}\" stroke=\"#{color:06x}\" stroke-width=\"{:.2}\"/>\
                 <path d=\"M{neck:.2} {:.2}L{tip:.2} {y:.2}L{neck:.2} {:.2}Z\" fill=\"#{color:06x}\"/>",
                0.26 * size,
                y - half,
                y + half,
            );
            let of = if self.scene.forces_of_cell { " (of one cell)" } else { "" };
            let label = format!("contact force per unit of pull{of}, longest {}", significant(most));
            text(out, [right, y - 0.75 * size], size, ink, "end", &label);
        }
    }

    /// The caption at the left, the pull at the right: an arrow along both ways of D as the camera sees it.
    fn heading(&self, out: &mut String, caption: &Caption) {
        let (ink, size, margin) = (self.ink(), letters(self.size), margin(self.size));
        text(out, [margin, margin + 0.8 * size], size, ink, "start", &caption.text);
        let Some(degrees) = caption.pull_deg else { return };
        let pull = Direction::of_degrees(degrees).along();
        let [from, to] = [Vec3::zeros(), pull.push(0.0)].map(|p| self.camera.project(&p));
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        // Seen along the pull, it has no direction in the picture.
        if length * self.camera.pixel < 0.1 {
            return;
        }
        let [x, y] = along.map(|part| part / length);
        let middle = [f64::from(self.size[0]) - margin - 3.0 * size, margin + 2.6 * size];
        let at = |forward: f64, aside: f64| {
            [middle[0] + size * (forward * x - aside * y), middle[1] + size * (forward * y + aside * x)]
        };
        let mut path = String::new();
        for way in [1.0, -1.0] {
            let points = [at(way * 1.4, 0.0), at(way * 1.2, 0.42), at(way * 2.4, 0.0), at(way * 1.2, -0.42)];
            let corner = |(k, [x, y]): (usize, &[f64; 2])| format!("{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
            path += &points.iter().enumerate().map(corner).collect::<String>();
            path.push('Z');
        }
        let [[x1, y1], [x2, y2]] = [at(-1.5, 0.0), at(1.5, 0.0)];
        for (color, thick, edge) in [("#ffffff", 0.6, 0.36), (ink, 0.24, 0.0)] {
            let _ = writeln!(
                out,
                "<path d=\"M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}\" stroke=\"{color}\" stroke-width=\"{:.2}\"/>\
                 <path d=\"{path}\" fill=\"{color}\" stroke=\"{color}\" stroke-width=\"{:.2}\" stroke-linejoin=\"round\"/>",
                thick * size,
                edge * size
            );
        }
        // Beside the arrow, on the side that is higher.
        let side = if x >= 0.0 { -1.3 } else { 1.3 };
        let [x, y] = at(0.0, side);
        text(out, [x, y + 0.35 * size], size, ink, "middle", "D");
    }

    fn cell(&self, out: &mut String, corners: [[f64; 2]; 4]) {
        let size = letters(self.size);
        let mut d = String::new();
        for (k, [x, y]) in corners.iter().enumerate() {
            let _ = write!(d, "{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
        }
        for (color, width, dash) in [("#ffffff", 0.34, ""), ("#111111", 0.15, "stroke-dasharray=\"")] {
            let dash = match dash.is_empty() {
                true => String::new(),
                false => format!(" {dash}{:.2} {:.2}\"", 0.55 * size, 0.35 * size),
            };
            let _ = writeln!(
                out,
                "<path d=\"{d}Z\" fill=\"none\" stroke=\"{color}\" stroke-opacity=\"0.95\" stroke-width=\"{:.2}\" \
                 stroke-linejoin=\"round\"{dash}/>",
                width * size
            );
        }
        let middle = [0, 1].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 4.0);
        for (far, label) in [(1, "a₁"), (3, "a₂")] {
            let half = [0, 1].map(|k| 0.5 * (corners[0][k] + corners[far][k]));
            let out_of = [half[0] - middle[0], half[1] - middle[1]];
            let length = out_of[0].hypot(out_of[1]).max(1e-9);
            let [x, y] = [0, 1].map(|k| half[k] + out_of[k] / length * 1.1 * size);
            let _ = writeln!(
                out,
                "<text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"{:.2}\" font-weight=\"bold\" text-anchor=\"middle\" \
                 fill=\"#111111\" stroke=\"#ffffff\" stroke-width=\"{:.2}\" stroke-linejoin=\"round\" \
                 paint-order=\"stroke\">{label}</text>",
                y + 0.4 * size,
                1.1 * size,
                0.3 * size
            );
        }
    }
}

fn text(out: &mut String, at: [f64; 2], size: f64, color: &str, anchor: &str, text: &str) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let [x, y] = at;
    let _ = writeln!(
        out,
        "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.2}\" fill=\"{color}\" text-anchor=\"{anchor}\">{text}</text>"
    );
}

/// The largest of 1, 2, 5 times a power of ten that is no more than `x`.
fn round_below(x: f64) -> f64 {
    let mut power = 10_f64.powf(x.log10().floor());
    if power > x {
        power /= 10.0;
    }
    let factor = [5.0, 2.0].into_iter().find(|f| f * power <= x * (1.0 + 1e-9)).unwrap_or(1.0);
    let rounded: f64 = format!("{:.0e}", factor * power).parse().unwrap_or(factor * power);
    rounded
}

fn significant(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_round() {
        for (most, bar) in [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.9, 2.0), (5.0, 5.0), (73.0, 50.0), (0.0031, 0.002)]
        {
            assert_eq!(round_below(most), bar, "{most}");
        }
    }
}
