//! Where the picture is taken from.

use super::{error::RenderError, torus::Ray, tube::Tube};
use maille_geometry::Vec3;
use std::str::FromStr;

/// A direction of view: azimuth and elevation in degrees.
///
/// At azimuth 0 the viewer stands at −y, so that x points right; growing azimuths lead him counter-clockwise around the
/// sheet. Elevation 0 looks along the sheet, 90 straight down on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Counter-clockwise from −y.
    pub azimuth_deg: f64,
    /// Over the plane of the sheet, from −90 to 90.
    pub elevation_deg: f64,
}

impl View {
    /// From above: x right, y up, angles as in the polar plots.
    pub const TOP: View = View { azimuth_deg: 0.0, elevation_deg: 90.0 };
    /// A little from the side, so that over and under are seen.
    pub const TILTED: View = View { azimuth_deg: 16.0, elevation_deg: 50.0 };
    /// Along the sheet.
    pub const SIDE: View = View { azimuth_deg: 0.0, elevation_deg: 0.0 };

    /// Whether it looks along the sheet, which is then a narrow band.
    pub fn is_low(self) -> bool {
        self.elevation_deg.abs() < 15.0
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "top" => return Ok(Self::TOP),
            "tilted" => return Ok(Self::TILTED),
            "side" => return Ok(Self::SIDE),
            _ => {}
        }
        let wrong =
            || format!("\"{text}\" is not a view: give top, tilted, side, or azimuth,elevation in degrees as 30,45");
        let (azimuth, elevation) = text.split_once(',').ok_or_else(wrong)?;
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong);
        let view = View { azimuth_deg: number(azimuth)?, elevation_deg: number(elevation)? };
        match view.elevation_deg.abs() <= 90.0 {
            true => Ok(view),
            false => Err(format!("an elevation of {} is not between -90 and 90 degrees", view.elevation_deg)),
        }
    }
}

/// A camera that has been placed: it maps pixels to rays and points to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    /// Unit vector towards the viewer.
    pub(super) back: Vec3,
    /// The point seen at [`Self::middle`].
    target: Vec3,
    /// Pixel of the target.
    middle: [f64; 2],
    /// Length at the target that one pixel covers.
    pub(super) pixel: f64,
    /// Distance of the eye from the target; none in an orthographic picture.
    distance: Option<f64>,
}

/// Half of the angle of a perspective picture's shorter side, as a tangent: about 30° in all.
const SPREAD: f64 = 0.27;

impl Camera {
    /// The camera that shows all `tori` as large as possible in a frame of pixels (`left, top, right, bottom`).
    pub(super) fn fit(view: View, perspective: bool, tori: &[Tube], frame: [f64; 4]) -> Result<Self, RenderError> {
        let [left, top, right_edge, bottom] = frame;
        let (width, height) = (right_edge - left, bottom - top);
        let (sin_a, cos_a) = sin_cos(view.azimuth_deg);
        let (sin_e, cos_e) = sin_cos(view.elevation_deg);
        let right = Vec3::new(cos_a, sin_a, 0.0);
        let back = Vec3::new(sin_a * cos_e, -cos_a * cos_e, sin_e);
        let up = back.cross(&right);
        let extent = |axis: &Vec3| {
            let ends = tori.iter().map(|tube| tube.extent(axis));
            ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)))
        };
        let (x, y, z) = (extent(&right), extent(&up), extent(&back));
        let middle_of = |e: (f64, f64)| 0.5 * (e.0 + e.1);
        let target = right * middle_of(x) + up * middle_of(y) + back * middle_of(z);
        let pixel = ((x.1 - x.0) / width).max((y.1 - y.0) / height);
        let middle = [0.5 * (left + right_edge), 0.5 * (top + bottom)];
        if !(pixel > 0.0 && pixel.is_finite()) {
            return Err(RenderError::Nothing);
        }
        let mut camera = Camera { right, up, back, target, middle, pixel, distance: None };
        if perspective {
            camera.step_back(tori, width, height);
        }
        Ok(camera)
    }

    /// Sets the eye's distance: as near as shows everything, with what is shown in the middle.
    fn step_back(&mut self, tori: &[Tube], width: f64, height: f64) {
        let spread = |side: f64| SPREAD * side / width.min(height);
        let points: Vec<(Vec3, f64)> =
            tori.iter().flat_map(|tube| (0..24).map(move |k| (tube.outline(k), tube.minor_radius()))).collect();
        for _ in 0..4 {
            // A point at (x, y, z) from the target is shown at x/(D − z): its ball of radius r needs (|x| + r)/(D − z) ≤ spread.
            let distance = points.iter().map(|(p, r)| {
                let d = p - self.target;
                let need = |x: f64, side: f64| d.dot(&self.back) + r + (x.abs() + r * 1.05) / spread(side);
                need(d.dot(&self.right), width).max(need(d.dot(&self.up), height))
            });
            let distance = distance.fold(0.0, f64::max);
            self.distance = Some(distance);
            let shown = |axis: &Vec3| {
                let ends = points.iter().map(|(p, r)| {
                    let d = p - self.target;
                    let depth = distance - d.dot(&self.back);
                    ((d.dot(axis) - r) / depth, (d.dot(axis) + r) / depth)
                });
                let ends = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
                0.5 * (ends.0 + ends.1) * distance
            };
            self.target += self.right * shown(&self.right) + self.up * shown(&self.up);
            self.pixel = 2.0 * distance * spread(width) / width;
        }
    }

    /// The ray through a place in the picture, in pixels from the upper left corner.
    pub(super) fn ray(&self, x: f64, y: f64, far: f64) -> Ray {
        let (x, y) = ((x - self.middle[0]) * self.pixel, (self.middle[1] - y) * self.pixel);
        let point = self.target + self.right * x + self.up * y;
        match self.distance {
            None => Ray { origin: point + self.back * far, direction: -self.back },
            Some(distance) => {
                let eye = self.target + self.back * distance;
                Ray { origin: eye, direction: (point - eye).normalize() }
            }
        }
    }

    /// Place of a point in the picture.
    pub(super) fn project(&self, p: &Vec3) -> [f64; 2] {
        let d = p - self.target;
        let depth = self.distance.map_or(1.0, |distance| (distance - d.dot(&self.back)) / distance);
        let scale = 1.0 / (self.pixel * depth);
        [self.middle[0] + d.dot(&self.right) * scale, self.middle[1] - d.dot(&self.up) * scale]
    }
}

/// Sine and cosine, exact at multiples of 90°.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => turn.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is at a place of the picture is what the ray through that place meets: no picture is mirrored or moved.
    #[test]
    fn rays_pass_through_what_is_projected_to_their_place() {
        let (right, up, back) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.8, -0.6, 0.0));
        let target = Vec3::new(0.3, -0.2, 0.5);
        for distance in [None, Some(9.0)] {
            let camera = Camera { right, up, back, target, middle: [320.0, 200.0], pixel: 0.01, distance };
            for p in [Vec3::new(1.0, 0.5, -0.3), Vec3::new(-0.7, 0.9, 1.1), Vec3::new(0.2, -1.3, 0.4)] {
                let [x, y] = camera.project(&p);
                let ray = camera.ray(x, y, 50.0);
                let way = p - ray.origin;
                assert!(way.cross(&ray.direction).norm() < 1e-9 * way.norm() && way.dot(&ray.direction) > 0.0);
                assert_eq!(x > 320.0, (p - target).dot(&right) > 0.0, "right is right");
                assert_eq!(y < 200.0, (p - target).dot(&up) > 0.0, "up is up");
            }
        }
    }
}
