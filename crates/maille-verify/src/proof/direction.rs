//! The direction of the pull, enclosed: cos and sin of an angle in degrees.

use super::form::Form;

/// π: the double nearest to it is less than 1.3e-16 away.
const PI: Form = Form::about(std::f64::consts::PI, 1.3e-16);
/// Powers of the series of cos and sin; the rest of both series at π/4 is below 1/24! < 2e-24.
const POWERS: u32 = 24;

/// Enclosures of cos and sin.
pub(crate) fn cos_sin(degrees: f64) -> (Form, Form) {
    // Exact: a remainder is, and so are differences of numbers within a factor of two.
    let turn = degrees % 360.0;
    let quarter = (turn / 90.0).round();
    let (cos, sin) = near_zero(turn - 90.0 * quarter);
    match (quarter as i32).rem_euclid(4) {
        0 => (cos, sin),
        1 => (sin.neg(), cos),
        2 => (cos.neg(), sin.neg()),
        _ => (sin, cos.neg()),
    }
}

/// For up to 45°, and a little more: alternating series, whose rest is smaller than its first term.
fn near_zero(degrees: f64) -> (Form, Form) {
    let x = PI.times(degrees).mul(&Form::number(180.0).reciprocal());
    let (mut cos, mut sin) = (Form::number(1.0), Form::number(0.0));
    let mut term = Form::number(1.0);
    for k in 1..POWERS {
        term = term.mul(&x).mul(&Form::number(f64::from(k)).reciprocal());
        let signed = if k % 4 >= 2 { term.neg() } else { term };
        if k % 2 == 0 {
            cos = cos.add(&signed);
        } else {
            sin = sin.add(&signed);
        }
    }
    (widened(cos), widened(sin))
}

fn widened(x: Form) -> Form {
    Form::about(x.c, x.r + 2e-24)
}

impl Form {
    /// 1/x of an exact number.
    fn reciprocal(&self) -> Form {
        let c = 1.0 / self.c;
        Form::about(c, c.abs() * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_angles_and_the_circle() {
        for (degrees, cos, sin) in [(0.0, 1.0, 0.0), (90.0, 0.0, 1.0), (180.0, -1.0, 0.0), (-90.0, 0.0, -1.0)] {
            let (c, s) = cos_sin(degrees);
            assert!(c.inf() <= cos && cos <= c.sup() && s.inf() <= sin && sin <= s.sup(), "{degrees}");
        }
        let (c, _) = cos_sin(60.0);
        assert!(c.inf() <= 0.5 && 0.5 <= c.sup());
        let (_, s) = cos_sin(-30.0);
        assert!(s.inf() <= -0.5 && -0.5 <= s.sup());
        for k in 0..2000 {
            let degrees = f64::from(k) * 0.731 - 500.0;
            let ((c, s), (sin, cos)) = (cos_sin(degrees), degrees.to_radians().sin_cos());
            // The library's own error, and that of the conversion, is some 1e-15.
            assert!((c.c - cos).abs() < 4e-15 && (s.c - sin).abs() < 4e-15, "{degrees}");
            assert!(c.sup() - c.inf() < 5e-13, "{degrees}: {}", c.sup() - c.inf());
            let one = c.mul(&c).add(&s.mul(&s));
            assert!(one.inf() <= 1.0 && 1.0 <= one.sup());
        }
    }
}
