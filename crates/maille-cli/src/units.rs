//! Lengths and densities as people write them: units, fractions of an inch, wire gauges.

use maille_io::millimetres;

/// Diameters of the British Standard Wire Gauge, numbers 0 to 40, in thousandths of an inch.
const SWG_MIL: [f64; 41] = [
    324.0, 300.0, 276.0, 252.0, 232.0, 212.0, 192.0, 176.0, 160.0, 144.0, 128.0, 116.0, 104.0, 92.0, 80.0, 72.0, 64.0,
    56.0, 48.0, 40.0, 36.0, 32.0, 28.0, 24.0, 22.0, 20.0, 18.0, 16.4, 14.8, 13.6, 12.4, 11.6, 10.8, 10.0, 9.2, 8.4,
    7.6, 6.8, 6.0, 5.2, 4.8,
];

/// A table of wire diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gauge {
    /// British Standard Wire Gauge.
    Swg,
    /// American Wire Gauge: 0.127 mm · 92^((36 − n)/39), to the tenth of a micrometre.
    Awg,
}

impl Gauge {
    fn name(self) -> &'static str {
        match self {
            Gauge::Swg => "swg",
            Gauge::Awg => "awg",
        }
    }

    fn millimetres(self, number: usize) -> Option<f64> {
        match self {
            Gauge::Swg => SWG_MIL.get(number).map(|mil| mil * 0.0254),
            Gauge::Awg if number <= 40 => {
                Some((0.127 * 92.0_f64.powf((36.0 - number as f64) / 39.0) * 1e4).round() / 1e4)
            }
            Gauge::Awg => None,
        }
    }

    /// The thickest wire of the table below `mm`, as `17swg (1.4224 mm)`.
    pub fn thinner(self, mm: f64) -> Option<String> {
        let found = (0..=40).find_map(|n| Some((n, self.millimetres(n)?)).filter(|(_, wire)| *wire < mm))?;
        Some(format!("{}{} ({:.4} mm)", found.0, self.name(), found.1))
    }
}

/// A wire or an inner diameter, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Millimetres.
    pub mm: f64,
    /// The table it was given by.
    pub gauge: Option<Gauge>,
}

/// Reads `1.6mm`, `0.064in`, `5/16in` or `5/16"`.
pub fn parse_length(text: &str) -> Result<Length, String> {
    let wrong = || match text.contains(',') {
        true => format!("\"{text}\" is not a length; decimals take a point, and lengths a unit, such as 1.6mm"),
        false => format!("\"{text}\" is not a length; give it with its unit, such as 8mm, 0.3125in or 5/16in"),
    };
    let text = text.trim();
    let split = text.find(|c: char| !(c.is_ascii_digit() || "./".contains(c))).ok_or_else(wrong)?;
    let (value, unit) = text.split_at(split);
    let value = match value.split_once('/') {
        Some((a, b)) => a.parse::<f64>().ok().zip(b.parse::<f64>().ok()).map(|(a, b)| a / b),
        None => value.parse().ok(),
    };
    let mm = value.zip(millimetres(unit)).map(|(value, unit)| without_rounding(value * unit));
    let mm = mm.filter(|mm| mm.is_finite() && *mm > 0.0).ok_or_else(wrong)?;
    Ok(Length { mm, gauge: None })
}

/// To nine decimals: what a sum or a change of unit adds beyond them is rounding.
pub fn without_rounding(mm: f64) -> f64 {
    (mm * 1e9).round() / 1e9
}

/// As [`parse_length`], or a gauge: `16swg`, `14awg`.
pub fn parse_wire(text: &str) -> Result<Length, String> {
    let lower = text.trim().to_lowercase();
    for gauge in [Gauge::Swg, Gauge::Awg] {
        let Some(number) = lower.strip_suffix(gauge.name()) else { continue };
        let mm =
            number.trim().parse::<usize>().ok().and_then(|n| gauge.millimetres(n)).ok_or_else(|| {
                format!("\"{text}\" is not a gauge; {0} has the numbers 0 to 40, as 16{0}", gauge.name())
            })?;
        return Ok(Length { mm, gauge: Some(gauge) });
    }
    if let Some(number) = gauge_number(&lower) {
        let of = |gauge: Gauge| gauge.millimetres(number).map(|mm| format!("{number}{} is {mm:.4} mm", gauge.name()));
        let tables: Vec<String> = [Gauge::Swg, Gauge::Awg].into_iter().filter_map(of).collect();
        let tables = if tables.is_empty() { "both have the numbers 0 to 40".into() } else { tables.join(", ") };
        return Err(format!(
            "\"{text}\" may be of two tables of gauges, swg (British) or awg (American): {tables}; a diameter takes its unit, as 1.6mm"
        ));
    }
    parse_length(text).map_err(|problem| match text.contains(',') {
        true => problem.replacen("a length", "a wire", 1),
        false => format!(
            "\"{text}\" is not a wire; give a diameter such as 1.6mm or 0.064in, or a gauge such as 16swg or 14awg"
        ),
    })
}

/// The number of a gauge that names no table: `16`, `16g`, `16ga`, `16 gauge`.
fn gauge_number(lower: &str) -> Option<usize> {
    let number = ["gauge", "ga", "g"].iter().find_map(|word| lower.strip_suffix(word)).unwrap_or(lower);
    number.trim().parse().ok()
}

/// Reads `400x600mm`, `40x60cm` or `16x24in`; gives both in millimetres.
pub fn parse_size(text: &str) -> Result<[f64; 2], String> {
    let point = if text.contains(',') { "; decimals take a point" } else { "" };
    let wrong =
        || format!("\"{text}\" is not a size; give width and height with their unit, as 400x600mm or 16x24in{point}");
    let (width, height) = text.trim().split_once(['x', '×']).ok_or_else(wrong)?;
    let [width, height] = [width, height].map(str::trim);
    let unit = height.trim_start_matches(|c: char| c.is_ascii_digit() || "./".contains(c));
    let length = |text: &str| parse_length(text).map(|length| length.mm).map_err(|_| wrong());
    Ok([length(&format!("{width}{unit}"))?, length(height)?])
}

/// Typical densities of what rings are made of, in g/cm³.
const MATERIALS: [(&str, f64); 13] = [
    ("steel", 7.85),
    ("stainless", 7.93),
    ("aluminium", 2.70),
    ("copper", 8.96),
    ("brass", 8.5),
    ("bronze", 8.8),
    ("titanium", 4.5),
    ("silver", 10.4),
    ("pla", 1.24),
    ("petg", 1.27),
    ("abs", 1.04),
    ("nylon", 1.01),
    ("resin", 1.15),
];

/// Reads a density as `7.85g/cm3` or `7850kg/m3`, or a material's name; gives kilograms per cubic metre.
pub fn parse_density(text: &str) -> Result<f64, String> {
    let text = text.trim();
    if let Some((_, density)) = MATERIALS.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)) {
        return Ok(density * 1000.0);
    }
    let plain = text.replace(['^', ' '], "").replace('³', "3");
    let units = [("g/cm3", 1000.0), ("kg/m3", 1.0)];
    let found = units.iter().find_map(|(unit, factor)| Some(plain.strip_suffix(unit)?.parse::<f64>().ok()? * factor));
    found.filter(|x| x.is_finite() && *x > 0.0).ok_or_else(|| {
        let names: Vec<&str> = MATERIALS.iter().map(|(name, _)| *name).collect();
        format!("\"{text}\" is not a density; give it as 7.85g/cm3 or 7850kg/m3, or as one of {}", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_gauges() {
        let mm = |text: &str| parse_wire(text).map(|w| (w.mm * 1e4).round() / 1e4);
        assert_eq!(mm("1.6mm"), Ok(1.6));
        assert_eq!(parse_length("0.09cm").map(|length| length.mm), Ok(0.9));
        assert_eq!(mm("5/16in"), Ok(7.9375));
        assert_eq!(mm("5/16\""), Ok(7.9375));
        assert_eq!(mm(".25 in"), Ok(6.35));
        // Published values.
        assert_eq!((mm("16swg"), mm("18SWG"), mm("14 swg")), (Ok(1.6256), Ok(1.2192), Ok(2.032)));
        assert_eq!((mm("36awg"), mm("16awg"), mm("0awg")), (Ok(0.127), Ok(1.2908), Ok(8.2515)));
        for wrong in ["", "16", "16gauge", "41swg", "-1swg", "mm", "0mm", "1/0in", "1/2/3in", "-2mm", "1e999mm", "swg"]
        {
            assert!(parse_wire(wrong).is_err(), "{wrong}");
        }
        for open in ["16", "16g", "16ga", "16 gauge", "16G"] {
            let said = parse_wire(open).unwrap_err();
            assert!(said.contains("16swg is 1.6256 mm, 16awg is 1.2908 mm"), "{said}");
        }
        assert!(parse_wire("99ga").unwrap_err().contains("numbers 0 to 40"));
        assert!(parse_length("16swg").is_err());
        assert_eq!(Gauge::Swg.thinner(1.6).as_deref(), Some("17swg (1.4224 mm)"));
        assert!(SWG_MIL.windows(2).all(|w| w[0] > w[1]));
    }

    #[test]
    fn sizes() {
        assert_eq!(parse_size("400x600mm"), Ok([400.0, 600.0]));
        assert_eq!(parse_size("40 x 60 cm"), Ok([400.0, 600.0]));
        assert_eq!(parse_size("16×24in"), Ok([406.4, 609.6]));
        for wrong in ["", "400mm", "400x600", "x600mm", "0x1mm", "400x-1mm", "4x5x6mm", "4cmx5mm"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn densities() {
        assert_eq!((parse_density("steel"), parse_density(" PLA ")), (Ok(7850.0), Ok(1240.0)));
        assert_eq!((parse_density("7.85g/cm3"), parse_density("7850 kg/m³")), (Ok(7850.0), Ok(7850.0)));
        assert_eq!((parse_density("7850kg/m^3"), parse_density("7.85 g/cm^3")), (Ok(7850.0), Ok(7850.0)));
        assert_eq!(parse_density("7850 kg / m^3"), Ok(7850.0));
        for wrong in ["", "7.85", "g/cm3", "-1g/cm3", "7.85 lb/in3"] {
            assert!(parse_density(wrong).is_err(), "{wrong}");
        }
    }
}
