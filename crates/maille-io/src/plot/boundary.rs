//! The surface of attainable strains: three sections through the written lattice, with the proven bound, and a view in space.

use super::canvas::{Anchor, Canvas, Stroke};
use super::clip;
use super::frame::{Area, Entry, Frame, GRID, INK, Layout, RIM, SOFT, style};
use super::look::{self, Look};
use super::scale::{Scale, range};
use crate::boundary::{colour, point, triangles};
use maille::{lattice::Cell, record::Status, survey::surface::Boundary};

/// Names of the coordinates.
const NAMES: [&str; 3] = ["E_xx", "E_yy", "E_xy"];
/// A square or a rectangle of the figure.
#[derive(Clone, Copy)]
struct Panel {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

/// The three sections and the view; where the legend stands beside them, the view has the room below it.
fn panels(area: Area) -> [Panel; 4] {
    let side = 0.5 * (area.right - area.left - 2.0 * 58.0);
    let columns = [area.left + 52.0, area.left + 52.0 + side + 58.0];
    let rows = [area.top, area.top + side + 66.0];
    let square = |column: usize, row: usize| Panel { left: columns[column], top: rows[row], width: side, height: side };
    let view = square(1, 1);
    let view = if area.print { view } else { Panel { width: 1.75 * side, ..view } };
    [square(0, 0), square(1, 0), square(0, 1), view]
}

/// The coordinate that is 0 in each section, and the two that are drawn.
const SECTIONS: [[usize; 3]; 3] = [[2, 0, 1], [1, 0, 2], [0, 1, 2]];
/// Where the eye is: turned about E_xy, then raised.
const TURN: f64 = -0.6;
const RAISE: f64 = 0.45;
const BOUND: &str = "#8a8a8a";

/// The figure, as SVG.
pub fn boundary_svg(boundary: &Boundary, title: &str, caption: Vec<String>, layout: Layout) -> String {
    let solid: Vec<[f64; 3]> = boundary.vertices.iter().map(|v| point(v).unwrap_or_default()).collect();
    let sample = |color: String, width: f64, label: &str| {
        Entry::sample(&Look { color, width, ..look::hollow() }, true, false, label)
    };
    let statuses = [Status::Global, Status::Local, Status::Uncertified];
    let labels = ["proved: the bound is attained", "not proved (local)", "not certified"];
    let there = |status: Status| boundary.vertices.iter().any(|v| colour(v.status) == colour(status));
    let mut legend = vec![Entry::Heading("Surface".into())];
    let shown = statuses.into_iter().zip(labels).filter(|(status, _)| there(*status));
    legend.extend(shown.map(|(status, label)| sample(hex(colour(status)), 6.0, label)));
    let bounded = boundary.vertices.iter().any(|v| v.bound.is_some());
    legend.extend(bounded.then(|| sample(BOUND.into(), 1.4, "proven bounds of rays, joined")));
    legend.push(Entry::Note("circle: the sheet as written".into()));
    let frame = Frame {
        title: format!("{title}: {}", of_cells(boundary)),
        subtitle: "Green strain E, with E_xy the tensor shear".into(),
        legend,
        caption,
    };
    let panels = panels(frame.area(layout));
    let bottom = panels[2].top + panels[2].height + 40.0;
    frame.svg(layout, bottom, |canvas| {
        for (panel, of) in panels.into_iter().zip(SECTIONS) {
            section(canvas, panel, boundary, &solid, of);
        }
        view(canvas, panels[3], boundary, &solid);
    })
}

/// Of which cells the strains are.
fn of_cells(boundary: &Boundary) -> String {
    let mut cells: Vec<Cell> = Vec::new();
    for vertex in &boundary.vertices {
        if !cells.contains(&vertex.cell) {
            cells.push(vertex.cell);
        }
    }
    match cells.as_slice() {
        [cell] => format!("cell {}", cell.to_string().replace('x', " × ")),
        _ => format!("cells of up to {} copies", cells.iter().map(Cell::copies).max().unwrap_or(1)),
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Where the triangles cross the plane on which coordinate `zero` is 0, with the corner nearest to each piece.
fn cut<'a>(
    corners: impl Iterator<Item = &'a [usize; 3]>,
    points: &[[f64; 3]],
    zero: usize,
) -> Vec<([[f64; 3]; 2], usize)> {
    let mut out = Vec::new();
    for corners in corners {
        let mut ends = Vec::new();
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
            let (p, q) = (points[a], points[b]);
            // A corner on the plane belongs to the upper side.
            if (p[zero] >= 0.0) != (q[zero] >= 0.0) {
                let share = p[zero] / (p[zero] - q[zero]);
                ends.push((std::array::from_fn(|i| p[i] + share * (q[i] - p[i])), if share < 0.5 { a } else { b }));
            }
        }
        if let [(p, near), (q, _)] = ends[..] {
            out.push(([p, q], near));
        }
    }
    out
}

fn section(
    canvas: &mut Canvas,
    Panel { left, top, width: side, .. }: Panel,
    boundary: &Boundary,
    solid: &[[f64; 3]],
    [zero, x, y]: [usize; 3],
) {
    let pieces = cut(triangles(boundary), solid, zero);
    // One unit is as long on both axes, and the surface fills the panel; of the bound what fits is shown.
    let of = |axis: usize| range(pieces.iter().flat_map(|(ends, _)| ends).map(|p| p[axis]).chain([0.0]));
    let (of_x, of_y) = (of(x), of(y));
    let span = 1.16 * (of_x.1 - of_x.0).max(of_y.1 - of_y.0).max(1e-9);
    let middle = [0.5 * (of_x.0 + of_x.1), 0.5 * (of_y.0 + of_y.1)];
    let unit = side / span;
    let at =
        |p: &[f64; 3]| [left + side / 2.0 + (p[x] - middle[0]) * unit, top + side / 2.0 - (p[y] - middle[1]) * unit];
    let scale = Scale::new(0.0, [-span / 2.0, span / 2.0].into_iter(), 4);
    let step = scale.ticks.windows(2).map(|w| w[1] - w[0]).next().unwrap_or(span);
    for k in -40..=40 {
        let value = f64::from(k) * step;
        let mut p = [0.0; 3];
        (p[x], p[y]) = (value, value);
        let [px, py] = at(&p);
        if px >= left && px <= left + side {
            canvas.line([px, top], [px, top + side], Stroke::solid(GRID, 1.0));
            canvas.text([px, top + side + 15.0], style(11.0, INK, Anchor::Middle), &scale.label(value));
        }
        if py >= top && py <= top + side {
            canvas.line([left, py], [left + side, py], Stroke::solid(GRID, 1.0));
            canvas.text([left - 5.0, py + 4.0], style(11.0, INK, Anchor::End), &scale.label(value));
        }
    }
    let bound: Vec<[f64; 3]> = boundary.vertices.iter().map(|v| v.point(v.bound.unwrap_or_default())).collect();
    let bounded = |corners: &&[usize; 3]| corners.iter().all(|&k| boundary.vertices[k].bound.is_some());
    let inside = boundary.triangles.iter().filter(|corners| corners.iter().all(|k| *k < boundary.vertices.len()));
    for ([p, q], _) in cut(inside.filter(bounded), &bound, zero) {
        for part in clip::to_rectangle(&[at(&p), at(&q)], [left, top], [left + side, top + side]) {
            canvas.path(&part, false, "none", Stroke::solid(BOUND, 1.2));
        }
    }
    for ([p, q], near) in &pieces {
        let color = hex(colour(boundary.vertices[*near].status));
        canvas.path(&[at(p), at(q)], false, "none", Stroke::solid(&color, 2.0));
    }
    canvas.circle(at(&[0.0; 3]), 3.0, "#ffffff", Stroke::solid(INK, 1.2));
    let corners = [[left, top], [left + side, top], [left + side, top + side], [left, top + side]];
    canvas.path(&corners, true, "none", Stroke::solid(RIM, 1.0));
    canvas.text([left + side / 2.0, top + side + 33.0], style(13.0, INK, Anchor::Middle), NAMES[x]);
    canvas.text_upward([left - 40.0, top + side / 2.0], 13.0, NAMES[y]);
    canvas.text([left, top - 7.0], style(12.0, INK, Anchor::Start), &format!("Section {} = 0", NAMES[zero]));
}

/// The surface from the side, far triangles first, lit from the eye. Each axis is stretched to the same length.
fn view(canvas: &mut Canvas, Panel { left, top, width, height }: Panel, boundary: &Boundary, points: &[[f64; 3]]) {
    let ends: [(f64, f64); 3] = std::array::from_fn(|i| range(points.iter().map(|p| p[i]).chain([0.0])));
    let size = ends.map(|(low, high)| (high - low).max(1e-9));
    let center = ends.map(|(low, high)| 0.5 * (low + high));
    // Right, up and towards the eye.
    let seen = |p: &[f64; 3]| -> [f64; 3] {
        let [x, y, z] = std::array::from_fn(|i| (p[i] - center[i]) / size[i]);
        let (across, deep) = (x * TURN.cos() - y * TURN.sin(), x * TURN.sin() + y * TURN.cos());
        [across, z * RAISE.cos() + deep * RAISE.sin(), -deep * RAISE.cos() + z * RAISE.sin()]
    };
    let ends: [(f64, f64); 2] = [0, 1].map(|i| range(points.iter().map(|p| seen(p)[i])));
    let extent = ends.map(|(low, high)| (high - low).max(1e-9));
    let unit = (0.94 * width / extent[0]).min(0.94 * height / extent[1]);
    let at = |p: &[f64; 3]| {
        let [u, v, _] = seen(p);
        let [u, v] = [u - 0.5 * (ends[0].0 + ends[0].1), v - 0.5 * (ends[1].0 + ends[1].1)];
        [left + width / 2.0 + u * unit, top + height / 2.0 - v * unit]
    };
    let mut faces: Vec<(f64, &[usize; 3])> =
        triangles(boundary).map(|c| (c.iter().map(|k| seen(&points[*k])[2]).sum(), c)).collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, corners) in faces {
        let [a, b, c] = corners.map(|k| seen(&points[k]));
        let (e, f): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300);
        let light = 0.5 + 0.5 * (0.3 * n[0] + 0.4 * n[1] + 0.87 * n[2]).abs() / length;
        let rank = |k: &usize| match boundary.vertices[*k].status {
            Status::Global => 0,
            Status::Local => 1,
            _ => 2,
        };
        let worst = corners.iter().max_by_key(|k| rank(k)).copied().unwrap_or(corners[0]);
        let fill = hex(colour(boundary.vertices[worst].status).map(|x| (f64::from(x) * light).min(255.0) as u8));
        canvas.path(&corners.map(|k| at(&points[k])), true, &fill, Stroke::solid(&fill, 0.6));
    }
    let corner = [left + 4.0, top + height + 22.0];
    for (i, name) in NAMES.iter().enumerate() {
        let mut p = center;
        p[i] += 0.16 * size[i];
        let [u, v, _] = seen(&p);
        let tip = [corner[0] + 8.0 + 170.0 * u, corner[1] - 170.0 * v];
        canvas.line([corner[0] + 8.0, corner[1]], tip, Stroke::solid(RIM, 1.4));
        canvas.text([tip[0] + 3.0, tip[1] + 3.0], style(11.0, SOFT, Anchor::Start), name);
    }
    canvas.text([left, top - 7.0], style(12.0, INK, Anchor::Start), "In space (axes scaled)");
}
