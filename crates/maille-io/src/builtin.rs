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
    ($($name:literal),*; $($start:literal),* $(,)?) => {
        &[
            $(Builtin { name: $name, toml: include_str!(concat!("../designs/", $name, ".toml")) },)*
            $(Builtin {
                name: concat!($start, "-chapter6"),
                toml: include_str!(concat!("../designs/chapter6/", $start, ".toml")),
            },)*
        ]
    };
}

const DESIGNS: &[Builtin] = embed![
    "1.1",
    "1.2",
    "1.3",
    "1.3-small",
    "2",
    "2-oblong",
    "3.1",
    "3.2",
    "3.3",
    "3.4",
    "4.1",
    "4.2",
    "4.3",
    "5.1",
    "5.2",
    "european-4-in-1",
    "european-6-in-1",
    "japanese-4-in-1",
    "japanese-6-in-1",
    "japanese-8-in-2",
    "japanese-12-in-2",
    "kings-mail",
    "cable",
    "curb",
    "byzantine",
    "box",
    "stadium-chain",
    "stadium-sheet",
    "squares",
    "hexagons",
    "ellipses",
    "torus-knots",
    "cages",
    "octahedra";
    "1.1",
    "1.2",
    "2",
    "3.1",
    "3.2",
    "3.4",
    "4.1",
    "4.3",
    "5.2",
];

/// All built-in designs: those of the thesis, weaves with a name, sheets of other elements than rings, and closer starts of chapter 6.
pub fn builtin_designs() -> &'static [Builtin] {
    DESIGNS
}

/// The start of chapter 6 of a design of the thesis: `1.1-chapter6` where there is one, or the design itself.
pub fn chapter6(name: &str) -> Option<Builtin> {
    let start = DESIGNS.iter().find(|d| d.name.strip_suffix("-chapter6") == Some(name));
    start.or_else(|| DESIGNS.iter().find(|d| d.name == name)).copied()
}

/// The text of a built-in design file.
pub fn builtin(name: &str) -> Option<&'static str> {
    DESIGNS.iter().find(|d| d.name == name).map(|d| d.toml)
}

/// The built-in name that `name` was probably meant to be.
pub fn nearest_builtin(name: &str) -> Option<&'static str> {
    let names: Vec<&'static str> = DESIGNS.iter().map(|d| d.name).collect();
    crate::nearest::nearest(name, &names)
}
