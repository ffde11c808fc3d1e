//! Single questions: one strain as large or small as can be, the thickest wire, the widest gap.

use crate::{design::Design, error, map::cell_choice, wait::wait};
use maille::{
    characterize::Method,
    lattice::Cell,
    limit::{
        exact::ExactOptions,
        extreme::{Extreme, ExtremeOptions},
        strain::{Strain, StrainMethod, StrainOptions, StrainQuery},
    },
    model::Model,
    record::pose_records,
    solve::certificate::Certificate,
    state::State,
};
use pyo3::prelude::*;
use serde_json::{Value, json};

fn strain(argument: &str, name: &str) -> PyResult<Strain> {
    let known = Strain::ALL.into_iter().find(|strain| strain.name() == name);
    known.ok_or_else(|| error::argument(argument, format!("\"{name}\" is no strain"), "give exx, eyy or exy"))
}

/// The state and its proof, as in the program's JSON.
fn proved(model: &Model, state: &State, certificate: Option<&Certificate>) -> Value {
    let vector = |a: maille_geometry::Vec3| -> [f64; 3] { (a * model.unit).into() };
    let f = state.deformation_gradient(model);
    json!({
        "cell": model.cell.to_string(),
        "a1": vector(state.a1),
        "a2": vector(state.a2),
        "deformation_gradient": [[f[(0, 0)], f[(0, 1)]], [f[(1, 0)], f[(1, 1)]]],
        "poses": pose_records(model, state),
        "certificate": certificate.map(|c| json!({
            "smallest_gap": c.smallest_gap * model.unit,
            "dual_residual": c.dual_residual,
            "complementarity": c.complementarity,
            "min_multiplier": c.min_multiplier,
            "min_curvature": c.min_curvature,
            "zero_modes": c.zero_modes,
        })),
    })
}

/// The largest (`sign` 1) or least (−1) value of a strain, as `maille limit` finds it; a JSON document.
#[pyfunction]
#[pyo3(signature = (design, goal, sign, *, fix, free, cell, starts, seed))]
pub fn limit(
    py: Python<'_>,
    design: &Design,
    goal: &str,
    sign: f64,
    fix: Vec<(String, f64)>,
    free: Vec<String>,
    cell: &str,
    starts: usize,
    seed: u64,
) -> PyResult<String> {
    let goal = strain(if sign > 0.0 { "maximize" } else { "minimize" }, goal)?;
    let fix: Vec<_> = fix.iter().map(|(name, x)| Ok((strain("fix", name)?, *x))).collect::<PyResult<_>>()?;
    let free: Vec<_> = free.iter().map(|name| strain("free", name)).collect::<PyResult<_>>()?;
    let query = StrainQuery::of(goal, sign, &fix, &free, 0.0).map_err(|e| error::invalid(&e))?;
    let exact = Method::Exact(ExactOptions::default());
    let cells = cell_choice(cell)?.cells(&exact, design.design.elements.len());
    let models: Vec<Model> = cells.iter().map(|cell| design.compile(*cell)).collect::<PyResult<_>>()?;
    let options = StrainOptions { starts: starts.max(1), seed, compression: sign < 0.0 };
    let found = wait(py, Some(1), None, |cancel, _| StrainMethod::new(&models, options).solve(&query, &[], cancel))?;
    let strains = Strain::ALL.map(|s| s.of(&found.strain, 0.0));
    let signed = |x: Option<f64>| x.map(|x| sign * x);
    let by_cell = found.trend.iter().map(|trend| json!([cells[trend.cell].to_string(), signed(trend.value)]));
    Ok(json!({
        "status": found.status.name(),
        "value": signed(found.value),
        "bound": signed(found.bound),
        "strain": found.value.map(|_| strains),
        "links_ok": found.links_ok,
        "n_starts": found.n_starts,
        "n_distinct": found.n_distinct,
        "by_cell": by_cell.collect::<Vec<_>>(),
        "state": found.value.map(|_| proved(&models[found.cell], &found.state, found.certificate.as_ref())),
    })
    .to_string())
}

/// The thickest wire or the widest gap, as `maille tightest` and `maille roomiest` find them: a JSON document, and the state
/// as a design.
#[pyfunction]
#[pyo3(signature = (design, *, thickest, lattice_free, starts, seed, threads))]
pub fn extreme(
    py: Python<'_>,
    design: &Design,
    thickest: bool,
    lattice_free: bool,
    starts: usize,
    seed: u64,
    threads: Option<usize>,
) -> PyResult<(String, Option<Design>)> {
    let model = design.compile(Cell::PRIMITIVE)?;
    if model.links.is_empty() {
        let remedy = "rings that hold each other bound the wire, and nothing else does";
        return Err(error::argument("design", "no rings of this design are linked", remedy));
    }
    let what = if thickest { Extreme::ThickestWire } else { Extreme::WidestGap };
    let options = ExtremeOptions { lattice_free, starts: starts.max(1), seed };
    let found = wait(py, threads, None, |cancel, _| maille::limit::extreme::extreme(&model, what, &options, cancel))?;
    let some = found.value.is_some();
    let sizes = found.sizes(&model).into_iter().filter(|_| some);
    let sizes = sizes.map(|size| json!([size.major_radius, size.minor_radius, size.aspect_ratio()]));
    let json = json!({
        "status": found.status.name(),
        "gap": found.gap(&model),
        "sizes": sizes.collect::<Vec<_>>(),
        "links_ok": found.links_ok,
        "n_starts": found.n_starts,
        "n_distinct": found.n_distinct,
        "state": some.then(|| proved(&model, &found.state, found.certificate.as_ref())),
    });
    Ok((json.to_string(), some.then(|| Design::of(found.design(&design.design, &model)))))
}
