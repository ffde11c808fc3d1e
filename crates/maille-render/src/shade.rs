//! Light: how bright a point of the sheet looks.

use super::{color::Light, field::Field};
use maille_geometry::Vec3;

/// Lights that stand with the camera: the key light comes over the viewer's left shoulder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lights {
    key: Vec3,
    fill: Vec3,
    up: Vec3,
}

/// How much of a point's surroundings is open, 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    /// Of the hemisphere over it.
    pub(super) around: f64,
    /// Of the key light.
    pub(super) key: f64,
}

/// Axes of six cones of 60° that cover the hemisphere, as (tangent, across, normal), and their share of its light.
const CONES: [([f64; 3], f64); 6] = [
    ([0.0, 0.0, 1.0], 0.25),
    ([0.866_025, 0.0, 0.5], 0.15),
    ([0.267_617, 0.823_639, 0.5], 0.15),
    ([-0.700_629, 0.509_037, 0.5], 0.15),
    ([-0.700_629, -0.509_037, 0.5], 0.15),
    ([0.267_617, -0.823_639, 0.5], 0.15),
];

/// A cone is probed from half of the wire's radius on, each time so much further than the last.
const PROBES: f64 = 1.75;
/// How far occlusion is felt, in reference radii.
const FELT: f64 = 1.3;
/// Sine of half of the key light's angle, for shadows of rings on rings.
const SOFTNESS: f64 = 0.10;
/// No shadow falls from further away, in reference radii.
const SHADOW: f64 = 6.0;

impl Lights {
    pub(super) fn new(right: Vec3, up: Vec3, back: Vec3) -> Self {
        let place = |x: f64, y: f64, z: f64| (right * x + up * y + back * z).normalize();
        Self { key: place(-0.55, 0.62, 0.80), fill: place(0.8, 0.1, 0.7), up }
    }

    /// What a point with outward normal and a tangent sees. `wire` is its minor radius.
    pub(super) fn open(&self, field: &Field<'_>, p: &Vec3, normal: &Vec3, tangent: &Vec3, wire: f64) -> Open {
        let across = normal.cross(tangent);
        let mut around = 0.0;
        for ([x, y, z], share) in CONES {
            let axis = tangent * x + across * y + normal * z;
            let (mut t, mut open) = (0.5 * wire, 1.0_f64);
            while t < FELT {
                let d = field.at(&(p + axis * t));
                // The cone's ball at t is of radius t/2; half of it is covered where its centre is on a surface.
                let covered = (0.5 - d / t).clamp(0.0, 1.0) * (1.0 - 0.8 * t / FELT);
                open = open.min(1.0 - covered);
                t *= PROBES;
            }
            around += share * open;
        }
        Open { around, key: self.shadow(field, p, normal, wire, SOFTNESS) }
    }

    /// How much of the key light reaches a point; `softness` is the sine of half of the light's angle.
    pub(super) fn shadow(&self, field: &Field<'_>, p: &Vec3, normal: &Vec3, wire: f64, softness: f64) -> f64 {
        if normal.dot(&self.key) < -0.15 {
            return 0.0;
        }
        let start = p + normal * (0.05 * wire);
        let (mut t, mut open) = (0.3 * wire, 1.0_f64);
        while t < SHADOW {
            let d = field.at(&(start + self.key * t));
            open = open.min(0.5 + 0.5 * d / (softness * t).min(field.reach));
            if open <= 0.0 {
                return 0.0;
            }
            t += (0.8 * d).max(0.12 * wire + 0.02 * t);
        }
        open * open * (3.0 - 2.0 * open)
    }

    /// Light from a surface of colour `albedo` towards the unit vector `view`.
    pub(super) fn surface(&self, albedo: &Light, normal: &Vec3, view: &Vec3, open: Open) -> Light {
        let lambert = ((normal.dot(&self.key) + 0.12) / 1.12).max(0.0);
        let facing = normal.dot(view).clamp(0.0, 1.0);
        let sky = 0.34 + 0.16 * normal.dot(&self.up) + 0.20 * normal.dot(&self.fill).max(0.0);
        let around = open.around;
        // Light that bounces between near surfaces takes on their colour (Jimenez et al. 2016, eq. 10).
        let bounced = albedo.map(|a| {
            let (x, y, z) = (2.0404 * a - 0.3324, -4.7951 * a + 0.6417, 2.7552 * a + 0.6903);
            (((x * around + y) * around + z) * around).max(around)
        });
        let half = (self.key + view).normalize();
        let gloss = normal.dot(&half).max(0.0);
        let shine = (0.38 * gloss.powi(90) + 0.07 * gloss.powi(14)) * open.key + 0.05 * (1.0 - facing).powi(4) * around;
        let edge = 1.0 - 0.45 * (1.0 - facing).powi(3);
        let lit = albedo.component_mul(&(bounced * sky)).map(|x| 1.15 * x) + albedo * (0.92 * lambert * open.key);
        (lit * edge + Light::repeat(shine)).map(shoulder)
    }

    /// Light from an arrow: little shading, so that its colour is the same everywhere.
    pub(super) fn arrow(&self, color: &Light, normal: &Vec3, view: &Vec3) -> Light {
        let lambert = (0.5 + 0.5 * normal.dot(&self.key)).max(0.0);
        let gloss = normal.dot(&(self.key + view).normalize()).max(0.0).powi(40);
        (color * (0.55 + 0.6 * lambert) + Light::repeat(0.12 * gloss)).map(shoulder)
    }
}

/// Bends what is brighter than 0.75 below 1.
fn shoulder(x: f64) -> f64 {
    if x <= 0.75 { x } else { 0.75 + 0.25 * (1.0 - (-(x - 0.75) / 0.25).exp()) }
}
