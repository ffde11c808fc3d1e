//! The minima by the polynomial of degree 8 (Appendix A).

use crate::{Circle, Minima, circle_distance_minima};

/// Placeholder.
pub fn circle_distance_minima_polynomial(a: &Circle, b: &Circle) -> Minima {
    circle_distance_minima(a, b)
}
