//! The contact energy of one overlapping point: the barrier (eq. 4.1.3), and the square that the thesis rejects (4.1.1).

use serde::{Deserialize, Serialize};

/// Which energy an overlap costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactLaw {
    /// `barrier`, eq. 4.1.3.
    #[default]
    Barrier,
    /// `quadratic`, eq. 4.1.1.
    Quadratic,
}

impl ContactLaw {
    /// ψ, ψ′ and ψ″ at the core distance `distance`.
    pub(crate) fn at(self, distance: f64, contact_distance: f64, alpha: f64) -> [f64; 3] {
        match self {
            ContactLaw::Barrier => barrier(distance, contact_distance, alpha),
            ContactLaw::Quadratic => quadratic(distance, contact_distance, alpha),
        }
    }
}

/// ψ, ψ′ and ψ″ of ψ(d) = α (d − r̂)² for d < r̂, and 0 from r̂ on. ψ″ jumps at r̂, and ψ(0) = α r̂² is finite: nothing
/// in it keeps core circles from crossing.
pub(crate) fn quadratic(distance: f64, contact_distance: f64, alpha: f64) -> [f64; 3] {
    if distance >= contact_distance {
        return [0.0; 3];
    }
    let gap = distance - contact_distance;
    [alpha * gap * gap, 2.0 * alpha * gap, 2.0 * alpha]
}

/// ψ, ψ′ and ψ″ of ψ(d) = −α (d − r̂)² ln(d/r̂) for 0 < d < r̂, and 0 from r̂ on.
///
/// d: distance of the core circles at the contact; r̂ = r1 + r2: where the tori touch. Units of α · length². Near
/// touching ψ ≈ α (r̂ − d)³/r̂; it is infinite at d = 0, where the core circles would cross.
pub(crate) fn barrier(distance: f64, contact_distance: f64, alpha: f64) -> [f64; 3] {
    if distance >= contact_distance {
        return [0.0; 3];
    }
    if distance <= 0.0 {
        return [f64::INFINITY; 3];
    }
    let gap = distance - contact_distance;
    let log = (distance / contact_distance).ln();
    let value = -alpha * gap * gap * log;
    let first = -alpha * (2.0 * gap * log + gap * gap / distance);
    let second = -alpha * (2.0 * log + 4.0 * gap / distance - gap * gap / (distance * distance));
    [value, first, second]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_differences() {
        for law in [ContactLaw::Barrier, ContactLaw::Quadratic] {
            for d in [0.01, 0.1, 0.19, 0.1999] {
                let h = 1e-6 * d;
                let [minus, here, plus] = [d - h, d, d + h].map(|d| law.at(d, 0.2, 1e3));
                let (first, second) = ((plus[0] - minus[0]) / (2.0 * h), (plus[1] - minus[1]) / (2.0 * h));
                assert!((here[1] - first).abs() < 1e-5 * first.abs().max(1e-3), "{d}: {} {first}", here[1]);
                assert!((here[2] - second).abs() < 1e-5 * second.abs(), "{d}: {} {second}", here[2]);
                assert!(here[0] > 0.0 && here[1] < 0.0);
            }
            assert_eq!(law.at(0.2, 0.2, 1.0), [0.0; 3]);
        }
        assert_eq!(barrier(0.0, 0.2, 1.0)[0], f64::INFINITY);
        assert_eq!(quadratic(0.0, 0.2, 2.0)[0], 2.0 * 0.2 * 0.2);
    }
}
