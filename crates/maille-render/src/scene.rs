//! What is in the picture: a patch of the sheet, its colours and its forces.

use super::{
    arrow::Arrow,
    color::{self, Light},
    error::RenderError,
    options::{ColorBy, Extent, Forces, RenderOptions},
    tube::{Tube, drawn},
};
use maille::{
    lattice::{Shift, shifts_within},
    model::{Core, Model},
    record::ContactRecord,
    state::State,
    topology,
};
use maille_geometry::{Torus, Vec3};
use std::collections::BTreeSet;

/// What is shown: a state of a model, and the contacts that carry force in it.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The design, compiled for the state's cell.
    pub model: &'a Model,
    /// Poses and lattice.
    pub state: &'a State,
    /// Contacts of the locked state; empty for the starting state.
    pub contacts: &'a [ContactRecord],
    /// Name of the design file's unit of length, if it has one.
    pub unit: Option<&'a str>,
}

/// Most rings of one picture.
const MOST_RINGS: usize = 1_000_000;

/// The patch, ready to be drawn. Lengths in reference radii.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// Number of rings.
    pub(super) rings: usize,
    /// Their tori, or the tubes round their pieces.
    pub(super) tori: Vec<Tube>,
    /// Colour of each torus.
    pub(super) colors: Vec<Light>,
    pub(super) arrows: Vec<Arrow>,
    /// Corners of a cell, at the origin, a1, a1 + a2, a2.
    pub(super) cell: Option<[Vec3; 4]>,
    /// Largest load of an element, where colours show it.
    pub(super) most_load: Option<f64>,
    /// Largest force of a contact, where arrows show it.
    pub(super) most_force: Option<f64>,
    /// Whether the arrows are those of one cell alone.
    pub(super) forces_of_cell: bool,
}

/// Length of the longest arrow, and radius of its shaft, in reference radii.
const ARROW: (f64, f64) = (1.0, 0.05);
/// More arrows than this on the area R² hide the sheet: those of one cell are shown then, with thinner shafts.
const DENSE: f64 = 0.8;
const THIN: f64 = 0.035;
/// Forces below this fraction of the largest are not shown.
const FORCE_SHOWN: f64 = 1e-3;

impl Scene {
    pub(super) fn new(subject: &Subject<'_>, options: &RenderOptions) -> Result<Self, RenderError> {
        let Subject { model, state, contacts, .. } = *subject;
        let arrows_shown = options.forces != Forces::None;
        if contacts.is_empty() && (options.color == ColorBy::Load || arrows_shown) {
            return Err(RenderError::NoForces);
        }
        let (members, middle) = members(model, state, options.extent)?;
        let (colors, most_load) = colors_of_elements(model, contacts, options.color);
        let mut scene = Scene {
            rings: 0,
            tori: Vec::new(),
            colors: Vec::new(),
            arrows: Vec::new(),
            cell: None,
            most_load,
            most_force: None,
            forces_of_cell: false,
        };
        for &(element, shift) in &members {
            for ring in model.elements[element].rings.clone() {
                let minor_radius = model.rings[ring].minor_radius;
                match state.core(model, ring, shift) {
                    Core::Circle(circle) => scene.tori.push(Tube::Torus(Torus { circle, minor_radius })),
                    curve => {
                        let pieces =
                            drawn(&curve.own_pieces()).into_iter().map(|piece| Tube::Piece(piece, minor_radius));
                        scene.tori.extend(pieces);
                    }
                }
                scene.colors.resize(scene.tori.len(), colors[element]);
                scene.rings += 1;
            }
        }
        if scene.tori.is_empty() {
            return Err(RenderError::Nothing);
        }
        if arrows_shown {
            let only = (options.forces == Forces::Arrows).then_some(middle);
            scene.add_arrows(subject, &members, only);
        }
        // In the plane: a rolled cell has no such outline.
        if options.cell && state.roll.is_none() {
            let corner = state.poses[0].position + state.translation(middle);
            let corner = Vec3::new(corner.x, corner.y, 0.0);
            scene.cell = Some([corner, corner + state.a1, corner + state.a1 + state.a2, corner + state.a2]);
        }
        Ok(scene)
    }

    /// Two arrows for each contact within the patch, from where the wires touch: what each ring feels from the other. Where
    /// they are dense, those of the cell `only`.
    fn add_arrows(&mut self, subject: &Subject<'_>, members: &[(usize, Shift)], only: Option<Shift>) {
        let Subject { model, state, contacts, .. } = *subject;
        let most = contacts.iter().map(|c| c.force).fold(0.0, f64::max);
        self.most_force = Some(most);
        let there: BTreeSet<_> = members.iter().copied().collect();
        let shown = || contacts.iter().filter(|c| c.force > FORCE_SHOWN * most);
        let dense = model.periodic && 2.0 * shown().count() as f64 > DENSE * state.a1.cross(&state.a2).norm();
        let only = only.filter(|_| dense);
        self.forces_of_cell = only.is_some();
        let thickness = if dense { THIN } else { ARROW.1 };
        for contact in shown() {
            let [a, b] = [contact.ring_a, contact.ring_b].map(|ring| model.rings[ring].element);
            let normal = Vec3::from(contact.normal);
            let on_a = Vec3::from(contact.point_a) / model.unit + normal * model.rings[contact.ring_a].minor_radius;
            let on_b = Vec3::from(contact.point_b) / model.unit - normal * model.rings[contact.ring_b].minor_radius;
            for &(_, shift) in members.iter().filter(|m| m.0 == a && only.is_none_or(|cell| cell == m.1)) {
                let image = [shift[0] + contact.shift[0], shift[1] + contact.shift[1]];
                if !there.contains(&(b, image)) {
                    continue;
                }
                let image = state.image(shift);
                let (from, normal) = (image.point(&(0.5 * (on_a + on_b))), image.vector(&normal));
                let length = ARROW.0 * contact.force / most;
                self.arrows.push(Arrow::new(from, normal, length, thickness));
                self.arrows.push(Arrow::new(from, -normal, length, thickness));
            }
        }
    }
}

/// The elements that a picture shows, with their cells, and the cell in its middle.
///
/// # Errors
/// [`RenderError::TooManyRings`].
pub fn members(model: &Model, state: &State, extent: Extent) -> Result<(Vec<(usize, Shift)>, Shift), RenderError> {
    let elements = model.elements.len();
    let too_many = |cells: f64| RenderError::TooManyRings { rings: cells * model.rings.len() as f64, most: MOST_RINGS };
    match extent {
        Extent::Cells([m, n]) => {
            let cells = f64::from(m) * f64::from(n);
            if cells * model.rings.len() as f64 > MOST_RINGS as f64 {
                return Err(too_many(cells));
            }
            let shifts = (0..m as i32).flat_map(|i| (0..n as i32).map(move |j| [i, j]));
            let members = shifts.flat_map(|shift| (0..elements).map(move |element| (element, shift))).collect();
            Ok((members, [(m as i32 - 1) / 2, (n as i32 - 1) / 2]))
        }
        Extent::Patch([width, height]) => {
            let [width, height] = [width, height].map(|x| x / model.unit);
            let cells = width * height / state.a1.cross(&state.a2).norm();
            if cells.is_nan() || cells * model.rings.len() as f64 > MOST_RINGS as f64 {
                return Err(too_many(cells));
            }
            let middle = state.poses[0].position;
            let slack = 1e-6;
            let within = |p: &Vec3| p.x.abs() <= 0.5 * width + slack && p.y.abs() <= 0.5 * height + slack;
            let mut members = Vec::new();
            for (element, pose) in state.poses.iter().enumerate() {
                let offset = pose.position - middle;
                let flat = Vec3::new(offset.x, offset.y, 0.0);
                let shifts = shifts_within(&flat, &state.a1, &state.a2, 0.5 * width.hypot(height) + slack);
                members.extend(
                    shifts.into_iter().filter(|s| within(&(flat + state.translation(*s)))).map(|s| (element, s)),
                );
            }
            Ok((without_loose_ends(model, members), [0, 0]))
        }
    }
}

/// Leaves out elements of which a single neighbour of several is there: they dangle from the edge.
fn without_loose_ends(model: &Model, members: Vec<(usize, Shift)>) -> Vec<(usize, Shift)> {
    let there: BTreeSet<_> = members.iter().copied().collect();
    let neighbours: Vec<_> = (0..model.elements.len()).map(|element| topology::neighbours(model, element)).collect();
    let holds = |&(element, shift): &(usize, Shift)| {
        let all = &neighbours[element];
        let near = all.iter().filter(|n| there.contains(&(n.element, [shift[0] + n.shift[0], shift[1] + n.shift[1]])));
        all.len() < 2 || near.take(2).count() == 2
    };
    let kept: Vec<_> = members.iter().copied().filter(holds).collect();
    if kept.is_empty() { members } else { kept }
}

/// Colour of each element of the cell, and the largest load where it is by load.
fn colors_of_elements(model: &Model, contacts: &[ContactRecord], by: ColorBy) -> (Vec<Light>, Option<f64>) {
    let elements = model.elements.len();
    match by {
        ColorBy::None => (vec![color::light(color::PLAIN); elements], None),
        ColorBy::Element => (kinds(model).into_iter().map(color::kind).collect(), None),
        ColorBy::Load => {
            let mut loads = vec![0.0; elements];
            for contact in contacts {
                for ring in [contact.ring_a, contact.ring_b] {
                    loads[model.rings[ring].element] += contact.force;
                }
            }
            let most = loads.iter().copied().fold(0.0, f64::max);
            let of = |&load: &f64| match load > FORCE_SHOWN * most {
                true => color::load(load / most),
                false => color::light(color::UNLOADED),
            };
            (loads.iter().map(of).collect(), Some(most))
        }
    }
}

/// Kind of each element, from 0: elements are of one kind if the starting state has them in the same orientation, with
/// the same rings in the same order (translates of each other).
pub fn kinds(model: &Model) -> Vec<usize> {
    let same = |a: usize, b: usize| {
        let rings = |e: usize| model.elements[e].rings.clone().map(|ring| &model.rings[ring]);
        let alike = |(a, b): (&maille::model::Ring, &maille::model::Ring)| {
            let close = |x: f64, y: f64| (x - y).abs() <= 1e-9;
            close(a.major_radius, b.major_radius)
                && close(a.minor_radius, b.minor_radius)
                && (a.offset - b.offset).norm() <= 1e-9
                && a.normal.cross(&b.normal).norm() <= 1e-9
        };
        rings(a).len() == rings(b).len() && rings(a).zip(rings(b)).all(alike)
    };
    let (mut firsts, mut out) = (Vec::new(), Vec::new());
    for e in 0..model.elements.len() {
        let known = firsts.iter().position(|&first| same(first, e));
        out.push(known.unwrap_or_else(|| {
            firsts.push(e);
            firsts.len() - 1
        }));
    }
    out
}
