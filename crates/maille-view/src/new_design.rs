//! Designs that the page begins with: a weave, or one ring.

use crate::{
    api::{New, Text},
    refusal::Refusal,
};
use maille::design::{DESIGN_SCHEMA, Design, ElementSpec, LatticeSpec, RingSpec, Source};
use maille_io::{
    weave::{Rings, Weave, WeaveError},
    write_design,
};
use std::collections::BTreeMap;

/// Sides of the cell of a single ring, in its major radii: room to draw a second one into it.
const SIDE: f64 = 2.5;

/// The design file.
pub fn design_file(request: &New) -> Result<Text, Refusal> {
    let New { name, weave, major, minor, unit } = request;
    let unit = Some(unit.clone()).filter(|unit| !unit.trim().is_empty());
    let (design, text) = match weave {
        None => {
            let design = single(name, *major, *minor, unit);
            (design.clone(), write_design(&design))
        }
        Some(weave) => {
            let known = Weave::ALL.into_iter().find(|known| known.name() == weave);
            let weave = known.ok_or_else(|| Refusal::wrong("there is no weave of that name", "see the list"))?;
            let refused = |e: WeaveError| {
                let help = miette::Diagnostic::help(&e).map_or(String::new(), |help| help.to_string());
                Refusal::wrong(e.to_string(), help)
            };
            let design = weave.design(name, &Rings { major: *major, minor: *minor, unit }).map_err(refused)?;
            (design.clone(), weave.file(&design, None, None))
        }
    };
    match design.problems().first() {
        Some(problem) => Err(Refusal::wrong(problem.to_string(), &problem.help)),
        None => Ok(Text { name: design.name, text }),
    }
}

/// One flat ring in a square cell, linked with nothing.
fn single(name: &str, major: f64, minor: f64, unit: Option<String>) -> Design {
    let ring = RingSpec { major_radius: major, normal: [0.0, 0.0, 1.0], offset: [0.0; 3], minor_radius: None };
    Design {
        schema: DESIGN_SCHEMA,
        name: name.to_owned(),
        title: String::new(),
        source: Source::Own,
        unit,
        minor_radius: Some(minor),
        reference_radius: major,
        curve_tolerance: None,
        allow_initial_overlap: false,
        lattice: LatticeSpec { a1: [SIDE * major, 0.0, 0.0], a2: [0.0, SIDE * major, 0.0], single: false },
        varied: BTreeMap::new(),
        parameters: Vec::new(),
        formulas: BTreeMap::new(),
        elements: vec![ElementSpec { name: "ring-1".into(), center: [0.0; 3], rings: vec![ring], curves: Vec::new() }],
    }
}
