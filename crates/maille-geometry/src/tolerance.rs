//! The one tolerance of the crate, and the range of lengths that it accepts.

/// What counts as rounding, relative to the largest length of a pair: `1e-14`, about fifty units in the last place.
///
/// Two circles whose distance varies by less along the whole circle are a continuum of minima, planes tilted by less
/// are parallel. It is the only tolerance of this crate that decides between answers.
pub const ROUNDING: f64 = 1e-14;

/// Radii from here and lengths up to [`MAX_LENGTH`] have squares and cubes that are ordinary numbers.
pub(crate) const MIN_LENGTH: f64 = 1e-90;
/// See [`MIN_LENGTH`].
pub(crate) const MAX_LENGTH: f64 = 1e90;
