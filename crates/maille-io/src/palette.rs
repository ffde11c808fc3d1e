//! Pictures of 256 colours: PNGs of a third of the bytes, for web pages, and films as GIF.

use crate::{plot::PlotError, render::Picture};
use color_quant::NeuQuant;
use resvg::tiny_skia::Pixmap;

/// Pixels that the palette is trained on: all of them. It takes longer for large pictures, and is always the same.
const SAMPLE: i32 = 1;
const COLOURS: usize = 256;

/// The picture in a PNG of 8 bits a channel as a PNG of 256 colours, chosen for it.
pub fn with_palette(png: &[u8]) -> Result<Vec<u8>, PlotError> {
    let fail = |e: &dyn std::fmt::Display| PlotError::Encode(e.to_string());
    let pixmap = Pixmap::decode_png(png).map_err(|e| fail(&e))?;
    let straight = pixmap.pixels().iter().map(|p| p.demultiply());
    let rgba: Vec<u8> = straight.flat_map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect();
    let palette = NeuQuant::new(SAMPLE, COLOURS, &rgba);
    let mut colours = palette.color_map_rgba();
    let mut indices: Vec<u8> = rgba.chunks_exact(4).map(|pixel| palette.index_of(pixel) as u8).collect();
    // The ground stays as it was to the last bit: next to other pictures a shade would show.
    let ground = [rgba[0], rgba[1], rgba[2], rgba[3]];
    let at = usize::from(indices[0]);
    colours[4 * at..4 * at + 4].copy_from_slice(&ground);
    for (index, pixel) in indices.iter_mut().zip(rgba.chunks_exact(4)) {
        if pixel == ground {
            *index = at as u8;
        }
    }

    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(colours.chunks_exact(4).flat_map(|c| [c[0], c[1], c[2]]).collect::<Vec<u8>>());
    // A palette that was trained on opaque pixels alone has alphas of 254 too: rounding.
    if rgba.chunks_exact(4).any(|pixel| pixel[3] < u8::MAX) {
        encoder.set_trns(colours.chunks_exact(4).map(|c| c[3]).collect::<Vec<u8>>());
    }
    let mut writer = encoder.write_header().map_err(|e| fail(&e))?;
    writer.write_image_data(&indices).map_err(|e| fail(&e))?;
    writer.finish().map_err(|e| fail(&e))?;
    Ok(out)
}

/// A film as GIF that repeats for ever, all frames in one palette, which is that of the first, middle and last one.
///
/// `centiseconds`: how long a frame is shown; the last one is shown for two seconds. Transparent pixels become white.
pub fn film(frames: &[Picture], centiseconds: u16) -> Result<Vec<u8>, PlotError> {
    let fail = |e: gif::EncodingError| PlotError::Encode(e.to_string());
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
        return Err(PlotError::Encode("a film without frames".into()));
    };
    let opaque = |picture: &Picture| -> Vec<u8> {
        let on_white = |[r, g, b, a]: [u8; 4]| {
            let over = |c: u8| ((u32::from(c) * u32::from(a) + 255 * (255 - u32::from(a))) / 255) as u8;
            [over(r), over(g), over(b), 255]
        };
        picture.rgba().into_iter().flat_map(on_white).collect()
    };
    let samples: Vec<u8> = [first, &frames[frames.len() / 2], last].into_iter().flat_map(opaque).collect();
    let palette = NeuQuant::new(SAMPLE, COLOURS, &samples);
    let [width, height] = first.size().map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    let mut out = Vec::new();
    let mut encoder = gif::Encoder::new(&mut out, width, height, &palette.color_map_rgb()).map_err(fail)?;
    encoder.set_repeat(gif::Repeat::Infinite).map_err(fail)?;
    for (k, picture) in frames.iter().enumerate() {
        let indices: Vec<u8> = opaque(picture).chunks_exact(4).map(|pixel| palette.index_of(pixel) as u8).collect();
        let delay = if k + 1 == frames.len() { 200 } else { centiseconds };
        let frame = gif::Frame { width, height, delay, buffer: indices.into(), ..gif::Frame::default() };
        encoder.write_frame(&frame).map_err(fail)?;
    }
    drop(encoder);
    Ok(out)
}
