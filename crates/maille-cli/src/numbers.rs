//! Numbers on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use maille::error::InvalidInput;
pub use maille_io::numbers::{Numbers, parse, parse_l2};
use serde::{Deserialize, de::value::StrDeserializer};
use std::str::FromStr;

/// A positive finite number.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err(format!("\"{text}\" is not a positive number")),
    }
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("\"{text}\" is not a number")),
    }
}

/// What the library reads by itself, as a cell.
pub fn read<T: FromStr<Err = InvalidInput>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|e: InvalidInput| format!("{}; {}", e.problem, e.help))
}

/// One of the values of the library that files name so.
pub fn one_of<T>(names: impl IntoIterator<Item = impl Into<PossibleValue>>) -> impl TypedValueParser<Value = T>
where
    T: for<'de> Deserialize<'de> + Clone + Send + Sync + 'static,
{
    let value = |name: String| T::deserialize(StrDeserializer::<serde::de::value::Error>::new(&name));
    PossibleValuesParser::new(names.into_iter().map(Into::<PossibleValue>::into)).try_map(value)
}
