//! Files that the page asks for, by the code of `maille export`, `render`, `table` and `plot`.

use crate::{api::Export, refusal::Refusal, sheet::tolerant};
use maille::{lattice::Cell, model::Model, record::ContactRecord, state::State};
use maille_io::{
    Quantity, Tile,
    plot::{Layout, PolarPlot, polar_svg},
    record::write_limits,
};
use maille_mesh::{Colours, Fineness, Format, Scene, WriteOptions};
use maille_render::{Extent, Forces, RenderOptions, Subject, render};
use std::io::Cursor;

/// Triangles of one file, at most.
const MOST_TRIANGLES: usize = 6_000_000;
/// Rings of one file, at most.
const MOST_RINGS: u64 = 50_000;

/// A file with its type.
pub struct File {
    /// MIME type.
    pub kind: &'static str,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Makes the file.
pub fn export(request: &Export) -> Result<File, Refusal> {
    let read = request.subject.read()?;
    match request.format.as_str() {
        "csv" => {
            let text = write_limits(&request.rows).map_err(Refusal::fault)?;
            return Ok(File { kind: "text/csv; charset=utf-8", bytes: text.into_bytes() });
        }
        "svg" if request.rows.is_empty() => return Err(Refusal::wrong("there are no limits to plot", "solve some")),
        "svg" => {
            let plot = PolarPlot::from_rows(&read.design, &request.rows, Quantity::default(), &[]);
            return Ok(File { kind: "image/svg+xml", bytes: polar_svg(&plot, Layout::Beside).into_bytes() });
        }
        _ => {}
    }
    let unusable = |problem: String| Refusal::wrong(problem, "solve the limit again");
    let cell: Cell = match &request.cell {
        Some(text) => text.parse().map_err(|e: maille::error::InvalidInput| unusable(e.problem))?,
        None => Cell::PRIMITIVE,
    };
    let design = if request.state.is_some() { &tolerant(&read.design) } else { &read.design };
    let model = read.compile_for(design, cell, request.finite)?;
    let state = match &request.state {
        Some(record) => maille_mesh::state_of(&model, record).map_err(|e| unusable(e.to_string()))?,
        None => model.start.clone(),
    };
    let contacts = request.state.as_ref().map_or(&[][..], |record| &record.contacts);
    if let Some(contact) = contacts.iter().find(|c| c.ring_a.max(c.ring_b) >= model.rings.len()) {
        let (a, b) = (contact.ring_a, contact.ring_b);
        return Err(unusable(format!("a contact names rings {a} and {b}; there are {}", model.rings.len())));
    }
    let [m, n] = request.tile;
    let rings = u64::from(m).saturating_mul(u64::from(n)).saturating_mul(model.rings.len() as u64);
    if rings == 0 || rings > MOST_RINGS {
        return Err(Refusal::wrong(format!("a tile of {rings} rings cannot be exported"), "take another tile"));
    }
    match request.format.as_str() {
        "png" => picture(&model, &state, contacts, request),
        "stl" | "3mf" | "obj" | "ply" | "glb" => scene(&model, &state, contacts, request, &read.design),
        other => {
            Err(Refusal::wrong(format!("there is no format \"{other}\""), "stl, 3mf, obj, ply, glb, png, csv or svg"))
        }
    }
}

fn picture(model: &Model, state: &State, contacts: &[ContactRecord], request: &Export) -> Result<File, Refusal> {
    let subject = Subject { model, state, contacts, unit: None };
    let forces = if contacts.is_empty() { Forces::None } else { Forces::Arrows };
    let options = RenderOptions { forces, ..RenderOptions::new(Extent::Cells(request.tile)) };
    let wrong = |e: maille_render::RenderError| Refusal::wrong(e.to_string(), "take another tile");
    let bytes = render(&subject, &options).and_then(|picture| picture.to_png()).map_err(wrong)?;
    Ok(File { kind: "image/png", bytes })
}

fn scene(
    model: &Model,
    state: &State,
    contacts: &[ContactRecord],
    request: &Export,
    design: &maille::design::Design,
) -> Result<File, Refusal> {
    let format = Format::of_ending(&request.format).ok_or_else(|| Refusal::wrong("there is no such format", ""))?;
    let mm = design.unit.as_deref().and_then(maille_io::millimetres).unwrap_or(1.0);
    let fineness = Fineness::Tolerance(0.01 * design.reference_radius);
    let wrong = |e: maille_mesh::MeshError| Refusal::wrong(e.to_string(), "take a smaller tile");
    let mut scene = Scene::new(model, state, Tile(request.tile), fineness, mm).map_err(wrong)?;
    let words = match request.finite {
        true => "a state of a simulated sheet".to_owned(),
        false => maille_mesh::state_words(request.state.as_ref()),
    };
    let tile = Tile(request.tile);
    scene.description = format!("{} {}; {words}; {tile} cells; 1 file unit = {mm} mm", design.name, design.title);
    if !contacts.is_empty() {
        scene.add_contacts(model, state, Tile(request.tile), contacts);
    }
    if scene.triangle_count() > MOST_TRIANGLES {
        let problem = format!("{} triangles are too many for a browser", scene.triangle_count());
        return Err(Refusal::wrong(problem, "take a smaller tile, or `maille export`"));
    }
    let options = WriteOptions { colours: Colours::Load, ..WriteOptions::default() };
    let mut bytes = Cursor::new(Vec::new()); // 3MF goes back in its file
    for file in format.files(&scene) {
        file.write(&scene, options, &mut bytes).map_err(wrong)?;
    }
    Ok(File { kind: "application/octet-stream", bytes: bytes.into_inner() })
}
