//! The tolerance that decides between answers, and the range of accepted lengths.

/// Relative size of what counts as rounding error: `1e-14` of the largest length of a pair, about fifty units in
/// the last place.
///
/// If the distance of two circles varies by less than this along a whole circle, the minima are a continuum; if two
/// planes are tilted by less, they count as parallel. No other tolerance of this crate decides between answers.
pub const ROUNDING: f64 = 1e-14;

/// Smallest valid radius. Squares and cubes of lengths from `MIN_LENGTH` to [`MAX_LENGTH`] are normal `f64` numbers.
pub(crate) const MIN_LENGTH: f64 = 1e-90;
/// Largest valid radius or coordinate difference, see [`MIN_LENGTH`].
pub(crate) const MAX_LENGTH: f64 = 1e90;
