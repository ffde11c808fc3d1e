//! Studies of `maille sweep`.

use crate::error;
use maille_io::{record::file_name, study::Study};
use pyo3::prelude::*;
use serde_json::json;

/// The designs of a study, as JSON: what is asked of each, and the values that it takes. `name` is what errors show.
#[pyfunction]
pub fn study(name: &str, text: &str) -> PyResult<String> {
    let study = Study::read(name, text).map_err(|e| error::study(name, &e))?;
    let designs = study.designs.iter().map(|design| {
        let variants = design.variants();
        let variants = variants.iter().map(|v| {
            let numbers: Vec<_> = v.numbers.iter().map(|(path, value)| json!([path.to_string(), value])).collect();
            json!([v.suffix, v.minor_radius, numbers, v.spacing, v.keep_links])
        });
        json!({
            "design": design.design,
            "name": design.name,
            "question": design.question,
            "variants": variants.collect::<Vec<_>>(),
        })
    });
    Ok(json!(designs.collect::<Vec<_>>()).to_string())
}

/// A design's name as a file or folder.
#[pyfunction]
pub fn folder_name(name: &str) -> String {
    file_name(name)
}
