//! A picture, from the sheet to its pixels.

use super::{
    camera::Camera,
    color::{self, Light},
    error::{MOST_PIXELS, MOST_SIDE, RenderError},
    options::{Background, RenderOptions},
    overlay::{self, Overlay},
    scene::{Scene, Subject},
    stage::{Pixel, Stage},
    tube::Tube,
};
use maille_svg::svg_to_png;
use resvg::tiny_skia::{Pixmap, PixmapPaint, PremultipliedColorU8, Transform};

/// The dark background.
const DARK: u32 = 0x1b1e24;

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
    draw(subject, &scene, &camera, options, &|_| {})
}

/// Draws `subjects` as the frames of a film, seen by one camera that has all of them in view, and gives each to `each`.
/// `told` hears which frame is drawn, from 0, and what part of it is done.
pub fn render_frames(
    subjects: &[Subject<'_>],
    options: &RenderOptions,
    told: impl Fn(usize, f64) + Sync,
    mut each: impl FnMut(Picture),
) -> Result<(), RenderError> {
    let scenes = subjects.iter().map(|subject| Scene::new(subject, options)).collect::<Result<Vec<_>, _>>()?;
    let camera = camera(&scenes, options)?;
    for (frame, (subject, scene)) in subjects.iter().zip(&scenes).enumerate() {
        each(draw(subject, scene, &camera, options, &|part| told(frame, part))?);
    }
    Ok(())
}

fn camera(scenes: &[Scene], options: &RenderOptions) -> Result<Camera, RenderError> {
    let [width, height] = options.size;
    if !options.size.iter().all(|side| (16..=MOST_SIDE).contains(side)) || width * height > MOST_PIXELS {
        return Err(RenderError::Size { width, height });
    }
    let margin = overlay::margin(options.size);
    let written = |scene: &Scene| scene.most_load.is_some() || scene.most_force.is_some();
    let written = options.scale_bar || scenes.iter().any(written);
    let strip = if written { overlay::strip(options.size) } else { 0.0 };
    let top = margin + if options.caption.is_some() { overlay::heading(options.size) } else { 0.0 };
    let frame = [margin, top, f64::from(width) - margin, f64::from(height) - margin - strip];
    let tori: Vec<Tube> = scenes.iter().flat_map(|scene| &scene.tori).copied().collect();
    Camera::fit(options.view, options.perspective, &tori, frame)
}

fn draw(
    subject: &Subject<'_>,
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    told: &(dyn Fn(f64) + Sync),
) -> Result<Picture, RenderError> {
    let [width, height] = options.size;
    let stage = Stage::new(scene, camera, options.shadow);
    let pixels = stage.draw(width as usize, height as usize, told);

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
        caption: options.caption.as_ref(),
    };
    if let Some(svg) = overlay.svg() {
        let fail = |e: &dyn std::fmt::Display| RenderError::Encode(e.to_string());
        let png = svg_to_png(&svg, 1.0).map_err(|e| fail(&e))?;
        let words = Pixmap::decode_png(&png).map_err(|e| fail(&e))?;
        pixmap.draw_pixmap(0, 0, words.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    }
    Ok(Picture { rings: scene.rings, pixel: camera.pixel * subject.model.unit, pixmap })
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
