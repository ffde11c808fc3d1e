//! Waves through the sheet against larger cells built as a whole: with the forces of one cell in every copy, the curvatures of the
//! large cell are those of the waves that fit into it, zero modes included.

use crate::common::builtin;
use faer::{Mat, Side};
use maille::{
    Answer, CellChoice, Question, Sheet,
    design::Design,
    lattice::{Cell, Direction},
    model::Model,
    program::{
        LatticeFamily, Parameter, Posed, SheetProgram,
        key::{pair_key, pair_of_key},
    },
    record::Status,
    solver::{
        constraints::{Derivatives, Loads, Multiplier},
        sqp::Program,
    },
    state::{Pose, State},
    topology::RingPair,
};
use maille_geometry::Vec3;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Cells with the phases of the waves that fit into them.
const CELLS: [(&str, &[[f64; 2]]); 4] = [
    ("2x1", &[[0.0, 0.0], [PI, 0.0]]),
    ("1x2", &[[0.0, 0.0], [0.0, PI]]),
    ("2x2", &[[0.0, 0.0], [PI, 0.0], [0.0, PI], [PI, PI]]),
    ("3,0;1,1", &[[0.0, 0.0], [TAU / 3.0, -TAU / 3.0], [-TAU / 3.0, TAU / 3.0]]),
];

fn designs() -> Vec<Design> {
    let builtin = ["1.1", "2", "3.1", "european-6-in-1", "5.1"].map(builtin);
    let random = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/random")).expect("a folder of designs");
    let mut paths: Vec<_> = random.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert_eq!(paths.len(), 10);
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("a design");
        maille_io::read_design(&path.display().to_string(), &text).expect("a valid design")
    };
    builtin.into_iter().chain(paths.iter().map(read)).collect()
}

/// The pull of a stretch along `direction` with its width held.
fn pull(model: &Model, direction_deg: f64, l2: f64) -> LatticeFamily {
    let direction = Direction::of_degrees(direction_deg);
    let d = direction.along();
    let reference = [model.start.a1, model.start.a2];
    let base = reference.map(|a| {
        let v = direction.gradient(0.0, l2, 0.0) * a.xy();
        Vec3::new(v.x, v.y, 0.0)
    });
    let rate = reference.map(|a| (d * d.dot(&a.xy())).push(0.0));
    LatticeFamily {
        base,
        parameters: vec![Parameter { rate, weight: 1.0, ..Parameter::default() }],
        metric: None,
        roll: None,
    }
}

/// The state of a cell repeated over a larger one.
fn tiled(model: &Model, state: &State) -> State {
    let [a1, a2] = [0, 1].map(|k| {
        let [[m11, m12], [m21, m22]] = rows(&model.cell);
        let [m, n] = [[m11, m12], [m21, m22]][k];
        state.a1 * f64::from(m) + state.a2 * f64::from(n)
    });
    let poses = copies(model).into_iter().flat_map(|copy| {
        let shift = state.translation(copy);
        state.poses.iter().map(move |pose| Pose { position: pose.position + shift, ..*pose })
    });
    State { poses: poses.collect(), a1, a2, roll: None }
}

fn rows(cell: &Cell) -> [[i32; 2]; 2] {
    let text = cell.to_string();
    let number = |t: &str| t.parse::<i32>().expect("a number");
    match text.split_once('x') {
        Some((m, n)) => [[number(m), 0], [0, number(n)]],
        None => {
            let entries: Vec<i32> = text.split([',', ';']).map(number).collect();
            [[entries[0], entries[1]], [entries[2], entries[3]]]
        }
    }
}

/// Where the copies of the design's cell stand, in its lattice vectors: as the names of the elements say.
fn copies(model: &Model) -> Vec<[i32; 2]> {
    let elements = model.elements.len() / model.cell.copies();
    let copy = |k: usize| {
        let name = &model.elements[k * elements].name;
        let Some((_, at)) = name.rsplit_once('@').filter(|_| model.cell.copies() > 1) else { return [0, 0] };
        let (p, q) = at.split_once(',').expect("a copy");
        [p, q].map(|x| x.parse().expect("a number"))
    };
    (0..model.cell.copies()).map(copy).collect()
}

/// The pair of rings in the large cell that is the copy `from` of a pair of one cell.
fn pair_in(large: &Model, rings: usize, from: usize, pair: &RingPair) -> RingPair {
    let at = copies(large);
    let [[m11, m12], [m21, m22]] = rows_i64(large);
    let det = m11 * m22 - m12 * m21;
    let (p, q) = (i64::from(at[from][0] + pair.shift[0]), i64::from(at[from][1] + pair.shift[1]));
    let place = |to: usize| {
        let (p, q) = (p - i64::from(at[to][0]), q - i64::from(at[to][1]));
        let [s, t] = [p * m22 - q * m21, q * m11 - p * m12];
        (s % det == 0 && t % det == 0).then(|| [(s / det) as i32, (t / det) as i32])
    };
    let (to, shift) = (0..at.len()).find_map(|to| Some((to, place(to)?))).expect("each place is of one copy");
    RingPair { ring_a: from * rings + pair.ring_a, ring_b: to * rings + pair.ring_b, shift }
}

fn rows_i64(model: &Model) -> [[i64; 2]; 2] {
    rows(&model.cell).map(|row| row.map(i64::from))
}

/// The angle of a point on the second ring of a pair.
fn angle(model: &Model, state: &State, pair: &RingPair, point: &Vec3) -> f64 {
    let circle = state.circle(model, pair.ring_b, pair.shift);
    let (u, v) = circle.frame();
    let out = point - circle.center;
    out.dot(&v).atan2(out.dot(&u))
}

/// The forces of an answer in one cell in each copy of `large`, as rows of its program: a pair is listed from one of its rings. Force and
/// moment of a flat pair are spread over its heights; `None` where that takes a pull.
fn repeated(
    program: &SheetProgram<'_>,
    large: &Model,
    x: &Posed,
    answer: &Answer,
    rings: usize,
) -> Option<Vec<Multiplier>> {
    let listed: Vec<u64> = program.rows(x, 1e-3, Derivatives::None).iter().map(|row| row.key).collect();
    let at = copies(large);
    let mut out: Vec<Multiplier> = Vec::new();
    let mut flat: std::collections::BTreeMap<u64, Vec<(f64, f64)>> = Default::default();
    for (from, contact) in (0..at.len()).flat_map(|from| answer.contacts.iter().map(move |c| (from, c))) {
        let own = large.cell == answer.cell;
        let pair = if own { contact.pair } else { pair_in(large, rings, from, &contact.pair) };
        let to_copy = answer.state.translation(at[from]);
        let back = RingPair { ring_a: pair.ring_b, ring_b: pair.ring_a, shift: pair.shift.map(|s| -s) };
        let away = x.state.translation(back.shift);
        let (pair, point) = match listed.contains(&pair_key(&pair)) {
            true => (pair, contact.point_b + to_copy),
            false => (back, contact.point_a + to_copy + away),
        };
        let key = pair_key(&pair);
        assert!(listed.contains(&key), "a contact of no near pair");
        let (angle, value) = (angle(large, &x.state, &pair, &point), contact.force);
        match program.flat_pairs().contains(&key) {
            true => flat.entry(key).or_default().push((angle, value)),
            false => out.push(Multiplier { key, angle, angle_a: 0.0, minimum: true, value }),
        }
    }
    for (key, forces) in flat {
        let total: f64 = forces.iter().map(|(_, force)| force).sum();
        let [c, s] = [f64::cos, f64::sin].map(|f| forces.iter().map(|(angle, force)| force * f(*angle)).sum::<f64>());
        if 2.0 * c.hypot(s) > total {
            return None;
        }
        for k in 0..16 {
            let angle = TAU * f64::from(k) / 16.0;
            let value = (total + 2.0 * (c * angle.cos() + s * angle.sin())) / 16.0;
            out.push(Multiplier { key, angle, angle_a: 0.0, minimum: false, value });
        }
    }
    Some(out)
}

/// Curvatures of the Lagrangian, ascending, on the motions of all elements of a cell that keep the loaded contacts; the lattice is held.
fn curvatures(program: &SheetProgram<'_>, model: &Model, x: &Posed, multipliers: &[Multiplier]) -> Vec<f64> {
    let loads = Loads::new(multipliers);
    // The program holds the first element's place: its unknowns are the places of the others against it.
    let n = program.objective().len() - 1;
    let turns = |e: usize| {
        let rings = model.elements[e].rings.clone();
        if rings.len() == 1 && model.rings[rings.start].offset.norm() < 1e-12 { 2 } else { 3 }
    };
    let mut first = vec![0];
    (0..model.elements.len()).for_each(|e| first.push(first[e] + turns(e) + if e > 0 { 3 } else { 0 }));
    assert_eq!(first[model.elements.len()], n);
    let mut held = DMatrix::<f64>::zeros(n, n + 3);
    (0..n).for_each(|k| held[(k, k)] = 1.0);
    for e in 1..model.elements.len() {
        (0..3).for_each(|k| held[(first[e] + k, n + k)] = -1.0);
    }
    let mut hessian = DMatrix::<f64>::zeros(n, n);
    let mut gram = DMatrix::<f64>::zeros(n, n);
    let mut used = 0.0;
    let rows = program.rows(x, 1e-2, Derivatives::Second(&loads));
    let carried = loads.of(&rows);
    for (row, mu) in rows.into_iter().zip(carried) {
        if mu <= 1e-9 {
            continue;
        }
        used += mu;
        let k = row.columns.len();
        for (p, &i) in row.columns.iter().enumerate().filter(|(_, i)| **i < n) {
            for (q, &j) in row.columns.iter().enumerate().filter(|(_, j)| **j < n) {
                hessian[(i, j)] -= mu * row.hessian[p * k + q];
                gram[(i, j)] += if mu > 1e-8 { row.gradient[p] * row.gradient[q] } else { 0.0 };
            }
        }
    }
    let all: f64 = multipliers.iter().map(|m| m.value).sum();
    assert!((used - all).abs() < 1e-6 * all, "forces without a row: {used} of {all}");
    for v in program.hidden_curvature(x, multipliers) {
        let v = DVector::from_column_slice(&v[..n]);
        hessian -= &v * v.transpose();
    }
    let [hessian, gram] = [hessian, gram].map(|of| held.transpose() * of * &held);
    let eigen = |of: &DMatrix<f64>| {
        let n = of.nrows();
        let of = Mat::from_fn(n, n, |i, j| 0.5 * (of[(i, j)] + of[(j, i)]));
        of.self_adjoint_eigen(Side::Lower).expect("eigenvalues")
    };
    let grams = eigen(&gram);
    let values: Vec<f64> = grams.S().column_vector().iter().copied().collect();
    let most = values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let free: Vec<usize> = (0..n + 3).filter(|&k| values[k] < 1e-12 * most).collect();
    let basis = DMatrix::from_fn(n + 3, free.len(), |i, k| grams.U()[(i, free[k])]);
    let kept = eigen(&(basis.transpose() * hessian * &basis));
    let mut out: Vec<f64> = kept.S().column_vector().iter().copied().collect();
    out.sort_by(f64::total_cmp);
    out
}

/// Compares the waves of one limit with four larger cells; how many were negative.
fn compare(design: &Design, model: &Model, answer: &Answer, direction_deg: f64, l2: f64) -> Option<usize> {
    let what = format!("{} at {direction_deg}°, l2 = {l2}", design.name);
    let family = pull(model, direction_deg, l2);
    let at = |program: &SheetProgram<'_>, state: State| program.posed(state, vec![answer.value.expect("a limit")]);
    let mut program = SheetProgram::new(model, &family);
    let x = at(&program, answer.state.clone());
    program.take_flat_pairs(&x);
    let own = repeated(&program, model, &x, answer, model.rings.len())?;
    let waves = program.waves(&x, &own);
    let loads = own.iter().map(|m| pair_of_key(m.key));
    let carrying: std::collections::BTreeSet<usize> =
        loads.flat_map(|pair| [pair.ring_a, pair.ring_b]).map(|ring| model.rings[ring].element).collect();
    let mut negative = 0;
    for (text, phases) in CELLS {
        let large = Model::compile(design, text.parse().expect("a cell")).expect("a design that compiles");
        let family = pull(&large, direction_deg, l2);
        let mut program = SheetProgram::new(&large, &family);
        let x = at(&program, tiled(&large, &answer.state));
        program.take_flat_pairs(&x);
        let loads = repeated(&program, &large, &x, answer, model.rings.len())?;
        let known = curvatures(&program, &large, &x, &loads);
        let of_wave = |q: &[f64; 2]| waves.modes(*q).expect("eigenvalues").values;
        let mut found: Vec<f64> = phases.iter().flat_map(of_wave).collect();
        // Elements that carry nothing are no part of the waves.
        let loose = (0..model.elements.len()).filter(|e| !carrying.contains(e));
        let turns = |e: usize| {
            let rings = model.elements[e].rings.clone();
            if rings.len() == 1 && model.rings[rings.start].offset.norm() < 1e-12 { 2 } else { 3 }
        };
        let idle: usize = loose.map(|e| 3 + turns(e)).sum();
        found.extend(std::iter::repeat_n(0.0, idle * phases.len()));
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), known.len(), "{what}: {text} has {} motions", known.len());
        let scale = known.iter().fold(1.0f64, |most, v| most.max(v.abs()));
        for (a, b) in found.iter().zip(&known) {
            assert!((a - b).abs() < 1e-8 * scale, "{what}: {a} {b} in {text}");
        }
        let zero = 1e-7 * scale;
        for q in &phases[1..] {
            negative += usize::from(waves.least(*q).is_some_and(|mode| mode.curvature < -zero));
        }
    }
    Some(negative)
}

#[test]
fn curvatures_of_waves_are_those_of_larger_cells() {
    let (mut compared, mut negative) = (0, 0);
    for design in designs() {
        let sheet = Sheet::in_cells(&design, Cell::PRIMITIVE.into()).expect("a design that compiles");
        for (direction_deg, l2) in [(0.0, 0.0), (30.0, -0.1), (135.0, -0.25)] {
            let asked = Question::stretch_along(direction_deg).with_lateral(l2);
            // Any limit has waves.
            let question = Question { starts: Some(2), ..asked };
            let answer = sheet.answer(&question).expect("a right question");
            if matches!(answer.status, Status::Global | Status::Local)
                && let Some(more) = compare(&design, sheet.model(), &answer, direction_deg, l2)
            {
                (compared, negative) = (compared + 1, negative + more);
            }
        }
    }
    println!("{compared} limits, {negative} unstable waves");
    assert!(compared >= 30 && negative >= 10, "{compared} limits, {negative} unstable waves");
}

fn limit(design: &Design, cells: CellChoice, direction_deg: f64, l2: f64) -> Answer {
    let sheet = Sheet::in_cells(design, cells).expect("a design that compiles");
    sheet.answer(&Question::stretch_along(direction_deg).with_lateral(l2)).expect("a right question")
}

/// Along 45° and 135° the limits are images of each other: the wave is one of the image's own state. In another basis of the lattice
/// it is the same wave.
#[test]
fn waves_of_images_and_in_other_bases_are_the_same() {
    let design = builtin("european-6-in-1");
    let mut found = Vec::new();
    for (direction_deg, cell) in [(45.0, "1x1"), (135.0, "1x1"), (45.0, "1,1;0,1"), (135.0, "1,0;-1,1")] {
        let cell: Cell = cell.parse().expect("a cell");
        let answer = limit(&design, cell.into(), direction_deg, -0.25);
        let wave = answer.wave.expect("a wave");
        let model = Model::compile(&design, cell).expect("a design that compiles");
        let family = pull(&model, direction_deg, -0.25);
        let program = SheetProgram::new(&model, &family);
        let x = program.posed(answer.state.clone(), vec![answer.value.expect("a limit")]);
        let forces = repeated(&program, &model, &x, &answer, model.rings.len()).expect("no flat pairs");
        let again = program.waves(&x, &forces).least(wave.q.map(|q| TAU * q)).expect("a wave").curvature;
        assert!((again - wave.least).abs() < 1e-6 * wave.least.abs(), "{direction_deg}° {cell}: {again} {wave:?}");
        found.push(wave.least);
    }
    assert!(found.iter().all(|least| *least < -1.0 && (least - found[0]).abs() < 1e-6 * found[0].abs()), "{found:?}");
}

/// No element presses on its own image here; by default 0.088782239 was found.
#[test]
fn an_unstable_wave_leads_to_a_larger_cell() {
    let answer = limit(&builtin("european-6-in-1"), CellChoice::Auto, 135.0, -0.25);
    assert_eq!((answer.status, answer.cell), (Status::Local, "2x1".parse().expect("a cell")));
    assert!(answer.value.expect("a limit") > 0.12649);
    assert!((answer.by_cell[0].value.expect("a limit") - 0.088782239).abs() < 1e-8, "{:?}", answer.by_cell);
}

#[test]
fn a_named_cell_reaches_what_the_own_cell_does() {
    for design in designs().into_iter().filter(|design| design.elements.len() < 4) {
        let direction_deg = 40.0;
        let [own, larger] = ["1x1", "2x1"].map(|cell| {
            let cell: Cell = cell.parse().expect("a cell");
            limit(&design, cell.into(), direction_deg, -0.1).limit()
        });
        let what = format!("{} at {direction_deg}°: {own:?}, {larger:?}", design.name);
        assert!(own.is_none_or(|own| larger.is_some_and(|larger| larger > own - 1e-9)), "{what}");
    }
}
