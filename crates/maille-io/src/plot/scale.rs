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

/// An axis of a chart, with its ticks and their labels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    pub(super) ticks: Vec<(f64, String)>,
}

/// Numbers that differ by this factor do not fit on a linear axis.
const WIDE: f64 = 30.0;

impl From<Scale> for Axis {
    fn from(scale: Scale) -> Self {
        let ticks = scale.ticks.iter().map(|&tick| (tick, scale.label(tick))).collect();
        Self { low: scale.low, high: scale.high, logarithmic: false, ticks }
    }
}

impl Axis {
    /// From 0, or from below it where a value is negative.
    pub(super) fn linear(values: impl Iterator<Item = f64>) -> Self {
        Scale::new(0.0, values, 6).into()
    }

    /// Stretches: from 1, or from below it where a sheet is compressed, with room behind the largest, where curves rise
    /// straight up.
    pub(super) fn of_stretch(values: impl Iterator<Item = f64>) -> Self {
        Scale::new(1.0, values.map(|x| if x > 1.0 { 1.0 + 1.03 * (x - 1.0) } else { x }), 6).into()
    }

    /// Round numbers around the values, wherever these lie.
    pub(super) fn between(values: &[f64]) -> Self {
        let (min, max) = range(values.iter().copied());
        if min > max {
            return Self::linear(std::iter::empty());
        }
        let step = round_step(if max > min { (max - min) / 6.0 } else { 0.1 * max.abs().max(0.1) });
        Scale::new((min / step + 1e-9).floor() * step, [min, max].into_iter(), 7).into()
    }

    /// Logarithmic where positive values differ by a large factor, else linear.
    pub(super) fn of_effort(values: &[f64]) -> Self {
        let (min, max) = range(values.iter().copied().filter(|x| *x > 0.0));
        if max < WIDE * min {
            return Self::linear(values.iter().copied());
        }
        // From 1, 2 or 5 times a power of ten to another, so that no decade is empty.
        let steps: Vec<(i32, u8)> = (min.log10().floor() as i32..=max.log10().ceil() as i32)
            .flat_map(|power| [1, 2, 5].map(|digit| (power, digit)))
            .collect();
        let value = |(power, digit): (i32, u8)| format!("{digit}e{power}").parse::<f64>().unwrap_or(1.0);
        let below = |step: &(i32, u8)| value(*step) <= min * (1.0 + 1e-9);
        let first = steps.iter().rposition(below).unwrap_or(0);
        let above = |step: &(i32, u8)| value(*step) >= max * (1.0 - 1e-9);
        let last = steps.iter().position(above).unwrap_or(steps.len() - 1);
        let few = last - first <= 7;
        let shown = (first..=last).filter(|&k| few || steps[k].1 == 1).map(|k| value(steps[k]));
        let ticks = shown.map(|tick| (tick, format!("{tick}"))).collect();
        Self { low: value(steps[first]), high: value(steps[last]), logarithmic: true, ticks }
    }

    /// Ticks at the values themselves where these are few and apart, with room at both ends.
    pub(super) fn of_l2(values: &[f64]) -> Self {
        let (Some(first), Some(last)) = (values.first(), values.last()) else {
            return Self::linear(std::iter::empty());
        };
        let span = last - first;
        let apart = values.windows(2).all(|w| w[1] - w[0] >= 0.09 * span);
        if !apart || values.len() > 9 {
            return Self::linear(values.iter().copied());
        }
        let room = if span > 0.0 { 0.06 * span } else { 0.1 };
        let ticks = values.iter().map(|&x| (x, signed(&format!("{x}")))).collect();
        Self { low: first - room, high: last + room, logarithmic: false, ticks }
    }

    /// Directions in degrees.
    pub(super) fn of_directions(values: &[f64]) -> Self {
        let (min, max) = range(values.iter().copied());
        if min > max {
            return Self::of_directions(&[0.0, 180.0]);
        }
        let steps = [1.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0];
        let step = steps.into_iter().find(|step| (max - min) / step <= 6.0 + 1e-9).unwrap_or(180.0);
        let (low, high) = ((min / step).floor() as i64, (max / step).ceil() as i64);
        let high = high.max(low + 1);
        let ticks = (low..=high).map(|k| (step * k as f64, format!("{}°", signed(&format!("{}", step * k as f64)))));
        Self { low: step * low as f64, high: step * high as f64, logarithmic: false, ticks: ticks.collect() }
    }

    pub(super) fn is_logarithmic(&self) -> bool {
        self.logarithmic
    }

    /// The value where the axis has a place for it: nothing at all has none on a logarithmic one.
    pub(super) fn shown(&self, x: f64) -> Option<f64> {
        (!self.logarithmic || x > 0.0).then_some(x)
    }

    /// What the name of the axis is to say of it.
    pub(super) fn words(&self) -> &'static str {
        if self.logarithmic { ", logarithmic" } else { "" }
    }

    /// 0 at the low end, 1 at the high end.
    pub(super) fn fraction(&self, x: f64) -> f64 {
        match self.logarithmic {
            true => (x / self.low).ln() / (self.high / self.low).ln(),
            false => (x - self.low) / (self.high - self.low),
        }
    }
}

/// The least and the largest of some values; from ∞ to −∞ where there are none.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
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

    fn ticks(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn axes_of_charts_fit_their_values() {
        assert_eq!(ticks(&Axis::of_effort(&[3.0, 0.0, 1500.0])), ["10", "100", "1000"]);
        let axis = Axis::of_effort(&[3.0, 1500.0]);
        assert!(axis.fraction(2.0) == 0.0 && (axis.fraction(2000.0) - 1.0).abs() < 1e-12);
        assert_eq!(ticks(&Axis::of_effort(&[0.04, 0.9, 2.0])), ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(ticks(&Axis::between(&[0.05, 0.2])), ["0.05", "0.10", "0.15", "0.20"]);
        assert_eq!(ticks(&Axis::between(&[1.31, 1.52])), ["1.30", "1.35", "1.40", "1.45", "1.50", "1.55"]);
        assert_eq!(ticks(&Axis::of_effort(&[3.0, 7.0])), ["0", "2", "4", "6", "8"]);
        assert_eq!(ticks(&Axis::of_l2(&[-0.25, -0.125, 0.0])), ["−0.25", "−0.125", "0"]);
        assert_eq!(ticks(&Axis::of_l2(&[0.0])), ["0"]);
        assert_eq!(ticks(&Axis::of_l2(&[-0.25, -0.24, 0.25])), ["−0.3", "−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(
            ticks(&Axis::of_directions(&[0.0, 180.0, 45.0])),
            ["0°", "30°", "60°", "90°", "120°", "150°", "180°"]
        );
        assert_eq!(ticks(&Axis::of_directions(&[30.0])), ["30°", "31°"]);
        assert_eq!(ticks(&Axis::of_stretch([1.0, 1.44].into_iter())), ["1.0", "1.1", "1.2", "1.3", "1.4", "1.5"]);
        assert_eq!(ticks(&Axis::of_stretch([1.0, 1.8].into_iter())), ["1.0", "1.2", "1.4", "1.6", "1.8", "2.0"]);
        let axis = Axis::of_effort(&[1.0, 100.0]);
        assert!(axis.is_logarithmic());
        assert!((axis.fraction(10.0) - 0.5).abs() < 1e-12);
        for empty in [Axis::of_effort(&[]), Axis::of_l2(&[]), Axis::of_directions(&[])] {
            assert!(empty.fraction(0.0).is_finite() && empty.ticks.len() > 1);
        }
    }

    #[test]
    fn an_axis_of_one_value_has_a_length() {
        assert_eq!(labels(0.0, &[]), ["0.00", "0.02", "0.04", "0.06", "0.08", "0.10"]);
    }
}
