//! Derivatives to both sides.

/// Derivatives of a value along a change of the design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneSided {
    /// For a step back, as a derivative: the value falls by this times the step.
    pub backward: Slope,
    /// For a step forward.
    pub forward: Slope,
}

/// A one-sided derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slope {
    /// Its value.
    Finite(f64),
    /// No state near this one has what is held: its forces hold it already without any pull.
    NoState,
    /// The linear program over the forces was not solved to its tolerance.
    NotFound,
}

impl Slope {
    /// The value, where it is finite.
    pub fn finite(self) -> Option<f64> {
        if let Slope::Finite(value) = self { Some(value) } else { None }
    }
}

impl OneSided {
    /// Whether the two differ by more than rounding: by a millionth of the larger one or of 1 in the units of the slope.
    pub fn is_kink(&self) -> bool {
        match (self.backward, self.forward) {
            (Slope::Finite(a), Slope::Finite(b)) => (a - b).abs() > 1e-6 * a.abs().max(b.abs()).max(1e-2),
            (a, b) => a != b,
        }
    }
}
