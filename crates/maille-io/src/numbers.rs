//! Lists and ranges of numbers, as on the command line and in studies, and counts in words.

use maille::question::Question;

/// Numbers of `--directions` or `--l2`, in the order given, without repetition.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers(pub Vec<f64>);

/// `1 limit`, `2 limits`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Rounded to nine significant digits.
pub fn nine_digits(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

/// Most numbers in one list.
const MOST: usize = 100_000;

/// Reads `0,15,30` or `first:last:step` (last included where the step meets it).
///
/// A range is computed in decimal: each of its numbers is the one nearest to the exact sum, so that `-0.3:0.3:0.1` has -0.2
/// and 0 as a list has them.
pub fn parse(text: &str) -> Result<Numbers, String> {
    let number = |t: &str| match t.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x + 0.0), // −0 is 0
        _ => Err(format!("\"{}\" is not a number; give a list such as 0,15,30 or a range such as 0:180:15", t.trim())),
    };
    let parts: Vec<&str> = text.split(':').collect();
    let values = match parts[..] {
        [first, last, step] => {
            for part in parts {
                number(part)?;
            }
            range([first, last, step].map(str::trim))?
        }
        [_] => text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?,
        _ => return Err("give a list as 0,15,30 or a range as first:last:step".into()),
    };
    Ok(distinct(values))
}

/// The numbers of a range, of texts that are finite numbers.
fn range([first, last, step]: [&str; 3]) -> Result<Vec<f64>, String> {
    let wide = || format!("{first}, {last} and {step} have too many digits between them for a range; give a list");
    let decimals = [first, last, step].map(|text| Decimal::read(text).ok_or_else(wide));
    let [from, to, by] = decimals.into_iter().collect::<Result<Vec<Decimal>, String>>()?[..] else {
        return Err(wide());
    };
    let exponent = [from, to, by].iter().filter(|d| d.digits != 0).map(|d| d.exponent).min().unwrap_or(0);
    let scaled = |d: Decimal| d.at(exponent).ok_or_else(wide);
    let (from, to, by) = (scaled(from)?, scaled(to)?, scaled(by)?);
    let way = to.checked_sub(from).ok_or_else(wide)?;
    if by == 0 {
        return Err(format!("a step of 0 never leads from {first} to {last}; give a step such as 15, or a list"));
    }
    if way.signum() * by.signum() < 0 {
        return Err(format!("a step of {step} never leads from {first} to {last}; turn its sign, or give a list"));
    }
    let count = way / by;
    if count >= MOST as i128 {
        return Err(format!("{} numbers are too many; at most {MOST}: take a larger step", count + 1));
    }
    // No sum lies beyond `to`, so none overflows. Reading rounds to the nearest number.
    let value = |k: i128| format!("{}e{exponent}", from + k * by).parse::<f64>().map_err(|_| wide());
    (0..=count).map(value).collect()
}

/// The number digits · 10^exponent.
#[derive(Clone, Copy)]
struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// A finite number as f64 reads it; `None` with more digits than fit.
    fn read(text: &str) -> Option<Decimal> {
        let (number, exponent) = match text.split_once(['e', 'E']) {
            Some((number, exponent)) => (number, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        let fraction = fraction.trim_end_matches('0');
        let digits = format!("{whole}{fraction}").parse().ok()?;
        Some(Decimal { digits, exponent: exponent.checked_sub(i32::try_from(fraction.len()).ok()?)? })
    }

    /// In units of 10^`exponent`, which is not above its own.
    fn at(self, exponent: i32) -> Option<i128> {
        if self.digits == 0 {
            return Some(0);
        }
        let power = u32::try_from(self.exponent.checked_sub(exponent)?).ok()?;
        self.digits.checked_mul(10i128.checked_pow(power)?)
    }
}

/// Each number once, −0 as 0.
pub fn distinct(values: impl IntoIterator<Item = f64>) -> Numbers {
    let mut out: Vec<f64> = Vec::new();
    for value in values {
        if !out.contains(&value) {
            out.push(value + 0.0);
        }
    }
    Numbers(out)
}

/// As [`parse`], for l2.
pub fn parse_l2(text: &str) -> Result<Numbers, String> {
    let numbers = parse(text)?;
    let check = |l2: &f64| Question::stretch_along(0.0).with_lateral(*l2).check();
    numbers.0.iter().try_for_each(check).map_err(|e| format!("{}; {}", e.problem, e.help))?;
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges() {
        assert_eq!(parse("0:180:45").unwrap().0, [0.0, 45.0, 90.0, 135.0, 180.0]);
        assert_eq!(parse("0:1:0.1").unwrap().0.len(), 11);
        assert_eq!(parse("10:0:-5").unwrap().0, [10.0, 5.0, 0.0]);
        assert_eq!(parse("3, 1,3,-0").unwrap().0, [3.0, 1.0, 0.0]);
        for wrong in ["", "a", "0:10:0", "0:10:-1", "0:10", "0:1e9:1e-9", "nan", "1,,2", "inf"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
        assert!(parse_l2("-1").is_err() && parse_l2("-0.25,0").is_ok());
    }
    #[test]
    fn ranges_are_exact_decimals() {
        // As a list has them: the numbers that Rust reads, not sums of rounded steps.
        for (range, list) in [
            ("-0.3:0.3:0.1", "-0.3,-0.2,-0.1,0,0.1,0.2,0.3"),
            ("0.05:0.15:0.05", "0.05,0.10,0.15"),
            ("0.3:-0.1:-.1", "0.3,0.2,0.1,0,-0.1"),
            ("1e-3:3e-3:.001", "0.001,0.002,0.003"),
            ("0:2.5:1", "0,1,2"),
            (" 5. : +7 : 1E0 ", "5,6,7"),
            ("1e300:3e300:1e300", "1e300,2e300,3e300"),
            ("1:1:2", "1"),
            ("0:0:1e-300", "0"),
        ] {
            let (found, expected) = (parse(range).unwrap().0, parse(list).unwrap().0);
            let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&found), bits(&expected), "{range}: {found:?}");
        }
        // Every range of thousandths, against its own decimals.
        for step in 1..100 {
            let range = format!("-1:1:{}", step as f64 / 1000.0);
            let shown: Vec<String> = parse(&range).unwrap().0.iter().map(f64::to_string).collect();
            let expected: Vec<String> = (-1000..=1000).step_by(step).map(thousandths).collect();
            assert_eq!(shown, expected, "{range}");
        }
        for wide in ["0:1e300:1e299.5", "1e300:2e300:1e-300", "0:1:0.1234567890123456789012345678901234567890"] {
            assert!(parse(wide).is_err(), "{wide}");
        }
    }

    /// The decimal of a whole number of thousandths, without needless zeros.
    fn thousandths(k: i32) -> String {
        let text = format!("{}{}.{:03}", if k < 0 { "-" } else { "" }, k.abs() / 1000, k.abs() % 1000);
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}
