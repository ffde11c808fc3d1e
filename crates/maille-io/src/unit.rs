//! Units that people write in a design.

/// Millimetres of a unit that people write in a design.
pub fn millimetres(unit: &str) -> Option<f64> {
    Some(match unit.trim().to_lowercase().as_str() {
        "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => 1.0,
        "cm" | "centimetre" | "centimetres" | "centimeter" | "centimeters" => 10.0,
        "m" | "metre" | "metres" | "meter" | "meters" => 1000.0,
        "um" | "µm" | "μm" | "micron" | "microns" | "micrometre" | "micrometer" => 0.001,
        "in" | "inch" | "inches" | "\"" => 25.4,
        "ft" | "foot" | "feet" => 304.8,
        _ => return None,
    })
}
