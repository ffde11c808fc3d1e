//! Axes with round ticks.

/// An axis from a round number to a round number.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Round numbers from `low` to `high`, both included.
    pub(super) ticks: Vec<f64>,
    decimals: usize,
}

impl Scale {
    /// From `base` upward, or from below it where a value is smaller; at most `most` intervals, one more if it reaches to both sides.
    pub(super) fn new(base: f64, values: impl Iterator<Item = f64>, most: usize) -> Self {
        let (min, max) = values.fold((base, base), |(lo, hi), x| (lo.min(x), hi.max(x)));
        let span: f64 = if max > min { max - min } else { 0.1 * base.abs().max(1.0) };
        let step = round_step(span / most as f64);
        let intervals = |x: f64| ((x / step) - 1e-9).ceil().max(0.0);
        let (below, above) = (intervals(base - min), intervals(max.max(min + span) - base).max(1.0));
        let tick = |i: f64| ((base + i * step) / step).round() * step;
        let ticks = (-below as i64..=above as i64).map(|i| tick(i as f64)).collect();
        let decimals = (0..9).find(|&d| ((step * 10f64.powi(d)).fract() - 0.5).abs() > 0.5 - 1e-6).unwrap_or(9);
        Self { low: tick(-below), high: tick(above), ticks, decimals: decimals as usize }
    }

    /// 0 at the low end, 1 at the high end.
    pub(super) fn fraction(&self, x: f64) -> f64 {
        (x - self.low) / (self.high - self.low)
    }

    pub(super) fn label(&self, x: f64) -> String {
        signed(&format!("{:.*}", self.decimals, x))
    }
}

/// 1, 2 or 5 times a power of ten, at least `x`.
fn round_step(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= x * (1.0 - 1e-9)).unwrap_or(10.0);
    factor * power
}

/// A number's text with the sign that is as wide as a plus.
pub(super) fn signed(number: &str) -> String {
    let zero = number.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if zero { number.trim_start_matches('-').to_owned() } else { number.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(base: f64, values: &[f64]) -> Vec<String> {
        let scale = Scale::new(base, values.iter().copied(), 6);
        scale.ticks.iter().map(|&t| scale.label(t)).collect()
    }

    #[test]
    fn ticks_are_round_and_start_at_the_base() {
        assert_eq!(labels(1.0, &[1.04, 1.44, 1.83]), ["1.0", "1.2", "1.4", "1.6", "1.8", "2.0"]);
        assert_eq!(labels(0.0, &[2.76]), ["0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"]);
        assert_eq!(labels(0.0, &[0.04, 0.12]), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10", "0.12"]);
        assert_eq!(labels(0.0, &[3.1, 4.9]), ["0", "1", "2", "3", "4", "5"]);
    }

    #[test]
    fn values_below_the_base_extend_the_axis() {
        assert_eq!(labels(0.0, &[-0.12, 0.3]), ["−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(1.0, &[0.93, 0.97]), ["0.92", "0.94", "0.96", "0.98", "1.00", "1.02"]);
    }

    #[test]
    fn an_axis_of_one_value_has_a_length() {
        assert_eq!(labels(0.0, &[]), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
    }
}
