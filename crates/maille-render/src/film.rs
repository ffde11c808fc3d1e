//! Films as GIF.

use super::picture::Picture;
use color_quant::NeuQuant;
use maille_svg::{COLOURS, PlotError, SAMPLE};

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
