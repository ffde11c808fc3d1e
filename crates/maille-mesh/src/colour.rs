//! Colours of elements, apart for colour-blind eyes.

use super::scene::Scene;

/// What the colours show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// The kind of element.
    #[default]
    Kind,
    /// The load on the element, from grey (none) to yellow (most). Without loads as [`Colours::Kind`].
    Load,
}

/// Okabe and Ito's colours, as sRGB.
const KINDS: [[u8; 3]; 8] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xd5, 0x5e, 0x00],
    [0xf0, 0xe4, 0x42],
    [0x99, 0x99, 0x99],
];

/// Viridis at five places, dark to bright.
const LOADS: [[u8; 3]; 5] =
    [[0x44, 0x01, 0x54], [0x3b, 0x52, 0x8b], [0x21, 0x91, 0x8c], [0x5e, 0xc9, 0x62], [0xfd, 0xe7, 0x25]];
const UNLOADED: [u8; 3] = [0xc8, 0xc8, 0xc8];

/// A colour with its meaning.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Colour {
    pub name: String,
    pub srgb: [u8; 3],
}

impl Colour {
    /// Linear RGB.
    pub fn linear(&self) -> [f32; 3] {
        self.srgb.map(|byte| {
            let x = f64::from(byte) / 255.0;
            let y = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
            (y * 1e4).round() as f32 / 1e4
        })
    }
}

/// A colour for every element of the solved cell.
pub(super) fn of_members(scene: &Scene, colours: Colours) -> Vec<Colour> {
    let members = scene.elements.iter().map(|e| e.member + 1).max().unwrap_or(0);
    match (&scene.loads, colours) {
        (Some(loads), Colours::Load) => {
            let most = loads.iter().copied().fold(0.0, f64::max);
            loads.iter().map(|&load| of_load(load, most)).collect()
        }
        _ => (0..members)
            .map(|member| {
                let kind = member % scene.kinds.len();
                Colour { name: scene.kinds[kind].name.clone(), srgb: KINDS[kind % KINDS.len()] }
            })
            .collect(),
    }
}

fn of_load(load: f64, most: f64) -> Colour {
    let name = format!("load {load:.4}");
    if load <= 1e-9 * most || most <= 0.0 {
        return Colour { name, srgb: UNLOADED };
    }
    let t = (load / most).clamp(0.0, 1.0) * (LOADS.len() - 1) as f64;
    let i = (t as usize).min(LOADS.len() - 2);
    let mix =
        |k: usize| f64::from(LOADS[i][k]) + (f64::from(LOADS[i + 1][k]) - f64::from(LOADS[i][k])) * (t - i as f64);
    Colour { name, srgb: [0, 1, 2].map(|k| mix(k).round() as u8) }
}
