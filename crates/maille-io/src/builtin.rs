//! The designs that come with the program, embedded from `designs/`.

/// A built-in design: its name and the text of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// Name of the design, as `1.1`.
    pub name: &'static str,
    /// Text of the design file.
    pub toml: &'static str,
}

macro_rules! embed {
    ($($name:literal),* $(,)?) => {
        &[$(Builtin { name: $name, toml: include_str!(concat!("../../../designs/", $name, ".toml")) }),*]
    };
}

const DESIGNS: &[Builtin] = embed![
    "1.1", "1.1t", "1.2", "1.2t", "1.3", "2", "3.1", "3.1t", "3.2", "3.2t", "3.3", "3.4", "4.1", "4.2", "4.3", "5.1",
    "5.2",
];

/// All built-in designs, ordered by name.
pub fn builtin_designs() -> &'static [Builtin] {
    DESIGNS
}

/// The text of a built-in design file.
pub fn builtin(name: &str) -> Option<&'static str> {
    DESIGNS.iter().find(|d| d.name == name).map(|d| d.toml)
}
