//! Colours: which are used, and how light adds up in them.

use maille_geometry::Vec3;

/// A colour as light: red, green and blue, linear, 1 as bright as paper.
pub(super) type Light = Vec3;

/// Kinds of elements, apart for colour-blind readers and in grey print.
pub const KINDS: [u32; 8] = [0x2f77b4, 0xf0a830, 0x2fa084, 0xcf6f9c, 0x7fc4ea, 0xd4602a, 0xe8dc6a, 0x8d8d8d];

/// Every element alike.
pub(super) const PLAIN: u32 = 0xb4bac2;

/// An element that carries no load.
pub const UNLOADED: u32 = 0xd2d4d8;

/// Load from little to most: a ramp that darkens evenly.
pub const LOADS: [u32; 5] = [0xf6d98a, 0xf0a45a, 0xd9604f, 0x9c2f6a, 0x4b1d63];

/// Arrows of forces.
pub const FORCE: u32 = 0xd81b43;

/// Colour of the kind `k`.
pub(super) fn kind(k: usize) -> Light {
    light(KINDS[k % KINDS.len()])
}

/// Colour of a load as a fraction of the largest.
pub(super) fn load(fraction: f64) -> Light {
    let place = fraction.clamp(0.0, 1.0) * (LOADS.len() - 1) as f64;
    let i = (place as usize).min(LOADS.len() - 2);
    let mix = place - i as f64;
    let srgb = |k: usize| Vec3::from([16, 8, 0].map(|bits| f64::from((LOADS[k] >> bits) & 0xff) / 255.0));
    (srgb(i) * (1.0 - mix) + srgb(i + 1) * mix).map(linear)
}

/// The light of an sRGB colour, as `0xrrggbb`.
pub(super) fn light(srgb: u32) -> Light {
    Vec3::from([16, 8, 0].map(|bits| linear(f64::from((srgb >> bits) & 0xff) / 255.0)))
}

fn linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB value, 0 to 1, of a linear one.
pub(super) fn encoded(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}
