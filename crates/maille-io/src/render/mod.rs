//! Pictures of a sheet, without a GPU: exact tori, cast by rays, lit for print.
//!
//! A [`Subject`] is a model in one of its states, perhaps with the contact forces of a limit. [`render`] draws a patch of
//! it as RGBA pixels. `docs/decisions/0006-renderer.md` says why the renderer is our own.
//!
//! The way of a picture: `scene` places rings and arrows, `camera` frames them, `film` takes samples of every pixel through
//! `bvh` (which rings may a ray meet?) and `torus` (where?), `shade` lights them by the distance `field`, and `overlay`
//! writes the scale bar and the keys. Work is shared by the threads of the current pool; the pixels do not depend on them.

mod arrow;
mod bvh;
mod camera;
mod color;
mod field;
mod film;
mod ground;
mod overlay;
mod scene;
mod shade;
mod torus;

pub use camera::View;
pub use color::{FORCE, KINDS, LOADS, UNLOADED};
pub use scene::{Subject, kinds};
pub use torus::{Ray, first_hit};

use crate::plot::svg_to_png;
use camera::Camera;
use color::Light;
use film::{Pixel, Stage};
use maille_geometry::Torus;
use miette::Diagnostic;
use overlay::Overlay;
use resvg::tiny_skia::{Pixmap, PixmapPaint, PremultipliedColorU8, Transform};
use scene::Scene;
use thiserror::Error;

/// What keeps a picture from being drawn.
#[derive(Debug, Error, Diagnostic, PartialEq)]
pub enum RenderError {
    /// The picture has no pixels, or too many.
    #[error("a picture of {width} × {height} pixels cannot be drawn")]
    #[diagnostic(help("take from 16 to {MOST_SIDE} pixels a side"))]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No ring is in the patch.
    #[error("no ring is in the picture")]
    #[diagnostic(help("take a larger patch or tile"))]
    Nothing,
    /// The patch has too many rings.
    #[error("the picture would show {rings:.0} rings; {most} are possible")]
    #[diagnostic(help("take a smaller patch or tile"))]
    TooManyRings {
        /// Rings, about.
        rings: f64,
        /// Most rings.
        most: usize,
    },
    /// Loads or arrows are asked for where no contact forces are known.
    #[error("no contact forces are known of this state")]
    NoForces,
    /// The pixels could not be written as PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Encode(String),
}

/// The dark background.
const DARK: u32 = 0x1b1e24;

/// Most pixels on one side.
const MOST_SIDE: u32 = 16_384;

/// Which part of the sheet is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Cells along a1 and a2.
    Cells([u32; 2]),
    /// The elements with their reference point in a rectangle around that of the first, in the file's unit.
    Patch([f64; 2]),
}

impl Extent {
    /// A patch that about fills a picture of this size and view: 13 reference radii wide.
    pub fn filling([width, height]: [u32; 2], view: View, reference_radius: f64) -> Self {
        let across = 12.6 * reference_radius;
        let foreshortened = view.elevation_deg.to_radians().sin().abs().max(0.5);
        let deep = across * f64::from(height.max(1)) / f64::from(width.max(1)) / foreshortened;
        Extent::Patch([across, deep.min(2.0 * across)])
    }
}

/// What the colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBy {
    /// One colour for each kind of element: elements that differ by a translation alone are of one kind.
    #[default]
    Element,
    /// The sum of the contact forces on each element.
    Load,
    /// All elements alike.
    None,
}

/// Whether contact forces are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Forces {
    /// They are not.
    #[default]
    None,
    /// As arrows, seen through the rings: at each contact, the force on either ring.
    Arrows,
}

/// What is behind the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// White paper.
    #[default]
    White,
    /// Nothing: the picture has an alpha channel.
    Transparent,
    /// A dark slide.
    Dark,
}

/// How a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Part of the sheet.
    pub extent: Extent,
    /// Direction of view.
    pub view: View,
    /// Near rings larger than far ones.
    pub perspective: bool,
    /// Behind the sheet.
    pub background: Background,
    /// Colours.
    pub color: ColorBy,
    /// Contact forces.
    pub forces: Forces,
    /// Draw the outline of the cell.
    pub cell: bool,
    /// Draw a scale bar.
    pub scale_bar: bool,
    /// Draw the shadow on the ground below.
    pub shadow: bool,
}

impl RenderOptions {
    /// A tilted picture of 1600 × 1200 on white.
    pub fn new(extent: Extent) -> Self {
        Self {
            size: [1600, 1200],
            extent,
            view: View::TILTED,
            perspective: false,
            background: Background::default(),
            color: ColorBy::default(),
            forces: Forces::default(),
            cell: false,
            scale_bar: true,
            shadow: true,
        }
    }
}

/// A picture in sRGB.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Rings that are shown.
    pub rings: usize,
    /// Length that one pixel covers in the middle of the picture, in the file's unit.
    pub pixel: f64,
    pixmap: Pixmap,
}

impl Picture {
    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.pixmap.width(), self.pixmap.height()]
    }

    /// Red, green, blue and straight alpha of each pixel, row by row from above.
    pub fn rgba(&self) -> Vec<[u8; 4]> {
        let straight = self.pixmap.pixels().iter().map(|p| p.demultiply());
        straight.map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect()
    }

    /// The picture as PNG.
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        self.pixmap.encode_png().map_err(|e| RenderError::Encode(e.to_string()))
    }
}

/// Draws `subject`.
pub fn render(subject: &Subject<'_>, options: &RenderOptions) -> Result<Picture, RenderError> {
    let scene = Scene::new(subject, options)?;
    let camera = camera(std::slice::from_ref(&scene), options)?;
    draw(subject, &scene, &camera, options)
}

/// Draws `subjects` as the frames of a film, seen by one camera that has all of them in view, and gives each to `each`.
pub fn render_frames(
    subjects: &[Subject<'_>],
    options: &RenderOptions,
    mut each: impl FnMut(Picture),
) -> Result<(), RenderError> {
    let scenes = subjects.iter().map(|subject| Scene::new(subject, options)).collect::<Result<Vec<_>, _>>()?;
    let camera = camera(&scenes, options)?;
    for (subject, scene) in subjects.iter().zip(&scenes) {
        each(draw(subject, scene, &camera, options)?);
    }
    Ok(())
}

fn camera(scenes: &[Scene], options: &RenderOptions) -> Result<Camera, RenderError> {
    let [width, height] = options.size;
    if !(16..=MOST_SIDE).contains(&width) || !(16..=MOST_SIDE).contains(&height) {
        return Err(RenderError::Size { width, height });
    }
    let margin = overlay::margin(options.size);
    let written = |scene: &Scene| scene.most_load.is_some() || scene.most_force.is_some();
    let written = options.scale_bar || scenes.iter().any(written);
    let strip = if written { overlay::strip(options.size) } else { 0.0 };
    let frame = [margin, margin, f64::from(width) - margin, f64::from(height) - margin - strip];
    let tori: Vec<Torus> = scenes.iter().flat_map(|scene| &scene.tori).copied().collect();
    Camera::fit(options.view, options.perspective, &tori, frame)
}

fn draw(
    subject: &Subject<'_>,
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
) -> Result<Picture, RenderError> {
    let [width, height] = options.size;
    let stage = Stage::new(scene, camera, options.shadow);
    let pixels = stage.draw(width as usize, height as usize);

    let mut pixmap = Pixmap::new(width, height).ok_or(RenderError::Size { width, height })?;
    for (to, from) in pixmap.pixels_mut().iter_mut().zip(&pixels) {
        *to = developed(from, options.background);
    }
    let scale = match subject.unit {
        Some(unit) => (1.0 / subject.model.unit, unit.to_owned()),
        None => (1.0, "R".to_owned()),
    };
    let overlay = Overlay {
        scene,
        camera,
        size: options.size,
        background: options.background,
        scale: options.scale_bar.then_some(scale),
        perspective: options.perspective,
    };
    if let Some(svg) = overlay.svg() {
        let fail = |e: &dyn std::fmt::Display| RenderError::Encode(e.to_string());
        let png = svg_to_png(&svg, 1.0).map_err(|e| fail(&e))?;
        let words = Pixmap::decode_png(&png).map_err(|e| fail(&e))?;
        pixmap.draw_pixmap(0, 0, words.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    }
    Ok(Picture { rings: scene.tori.len(), pixel: camera.pixel * subject.model.unit, pixmap })
}

/// The pixel on its background, as the pixmap holds it: sRGB values times alpha.
fn developed(pixel: &Pixel, background: Background) -> PremultipliedColorU8 {
    let on = |behind: Light| (pixel.light + behind * (1.0 - pixel.cover - pixel.shadow), 1.0, 1.0);
    let (light, cover, alpha) = match background {
        Background::White => on(Light::repeat(1.0)),
        Background::Dark => on(color::light(DARK)),
        Background::Transparent => {
            // Most programs lay pictures over others in sRGB values: a black of this alpha looks there as the shadow
            // does on white.
            let bare = (1.0 - pixel.cover).max(1e-9);
            let shadow = 1.0 - color::encoded(1.0 - pixel.shadow / bare);
            (pixel.light / pixel.cover.max(1e-9), pixel.cover, pixel.cover + (1.0 - pixel.cover) * shadow)
        }
    };
    let alpha = (255.0 * alpha).round().clamp(0.0, 255.0);
    let byte = |x: f64| (255.0 * color::encoded(x) * cover).round().min(alpha) as u8;
    PremultipliedColorU8::from_rgba(byte(light.x), byte(light.y), byte(light.z), alpha as u8)
        .expect("no colour exceeds alpha")
}
