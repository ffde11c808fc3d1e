//! Lists and ranges of numbers, as on the command line and in studies.

/// Numbers of `--directions` or `--l2`, in the order given, without repetition.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers(pub Vec<f64>);

/// Directions of a map where none are named, degrees.
pub const USUAL_DIRECTIONS: &str = "0:180:5";
/// Lateral strains that are held where none are named.
pub const USUAL_L2: &str = "-0.25:0.25:0.125";

/// Most numbers in one list.
const MOST: usize = 100_000;

/// Reads `0,15,30` or `first:last:step` (last included where the step meets it).
pub fn parse(text: &str) -> Result<Numbers, String> {
    let number = |t: &str| match t.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x + 0.0), // −0 is 0
        _ => Err(format!("\"{}\" is no number; give a list as 0,15,30 or a range as 0:180:15", t.trim())),
    };
    let parts: Vec<&str> = text.split(':').collect();
    let values = match parts[..] {
        [first, last, step] => {
            let (first, last, step) = (number(first)?, number(last)?, number(step)?);
            if step == 0.0 || (last - first) / step < 0.0 {
                return Err(format!(
                    "a step of {step} never leads from {first} to {last}; turn its sign, or give a list"
                ));
            }
            let count = ((last - first) / step + 1e-9).floor();
            if count >= MOST as f64 {
                return Err(format!("{count} numbers are too many; at most {MOST}: take a larger step"));
            }
            (0..=count as usize).map(|k| first + k as f64 * step).collect()
        }
        [_] => text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?,
        _ => return Err("give a list as 0,15,30 or a range as first:last:step".into()),
    };
    Ok(distinct(values))
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

/// As [`parse`], for l2: a stretch of 0 or less is no sheet.
pub fn parse_l2(text: &str) -> Result<Numbers, String> {
    let numbers = parse(text)?;
    match numbers.0.iter().find(|l2| **l2 <= -1.0) {
        Some(l2) => {
            Err(format!("l2 = {l2} would press the sheet to nothing; give values above -1 (0 holds the width)"))
        }
        None => Ok(numbers),
    }
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
}
