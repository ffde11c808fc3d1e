//! The closest cell with a gap: against a closed form, gaps counted by brute force, lattices beside it, and other ways to write the design.

use crate::common::builtin;
use maille::{
    answer::Answer,
    design::Design,
    lattice::Cell,
    model::Model,
    question::Question,
    record::Status,
    search::{Extreme, ExtremeOptions, extreme::extreme},
    sheet::Sheet,
};
use maille_geometry::Vec3;
use std::sync::atomic::AtomicBool;

/// The answer, and its state as a design.
fn closest(design: &Design, gap: f64) -> (Answer, Design) {
    let sheet = Sheet::in_cells(design, Cell::PRIMITIVE.into()).unwrap();
    let found = sheet.answer(&Question::closest_cell(gap)).unwrap();
    let what = Extreme::ClosestCell { gap: gap / design.reference_radius };
    let posed = what.design(&found, design, sheet.model());
    (found, posed)
}

fn certified(found: &Answer) -> f64 {
    assert_eq!(found.status, Status::Local, "{:?}", found.certificate);
    assert!(found.certificate.as_ref().unwrap().holds() && found.links_ok == Some(true));
    found.value.unwrap()
}

/// The widest gap, in the design's unit.
fn widest(design: &Design) -> f64 {
    let model = Model::compile(design, Cell::PRIMITIVE).unwrap();
    let found = extreme(&model, Extreme::LargestClearance, &ExtremeOptions::default(), &AtomicBool::new(false));
    found.value.unwrap() * model.unit
}

fn area(design: &Design) -> f64 {
    let [a1, a2] = [design.lattice.a1, design.lattice.a2];
    (a1[0] * a2[1] - a1[1] * a2[0]).abs()
}

/// Core circle of the only ring of an element.
struct Core {
    center: Vec3,
    frame: [Vec3; 2],
    normal: Vec3,
    radius: f64,
}

fn cores(design: &Design) -> Vec<Core> {
    let core = |element: &maille::design::ElementSpec| {
        let ring = &element.rings[0];
        let normal = Vec3::from(ring.normal).normalize();
        let u = normal.cross(&if normal.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() }).normalize();
        Core { center: element.center.into(), frame: [u, normal.cross(&u)], normal, radius: ring.major_radius }
    };
    design.elements.iter().map(core).collect()
}

/// Distance of a point from a circle.
fn distance(p: Vec3, circle: &Core) -> f64 {
    let q = p - circle.center;
    let height = q.dot(&circle.normal);
    height.hypot((q - circle.normal * height).norm() - circle.radius)
}

/// Least distance of two core circles by points on the one, with the best of them refined.
fn least(a: &Core, b: &Core) -> f64 {
    let at = |t: f64| distance(a.center + (a.frame[0] * t.cos() + a.frame[1] * t.sin()) * a.radius, b);
    let n = 720;
    let step = std::f64::consts::TAU / n as f64;
    let coarse = (0..n).map(|k| (at(k as f64 * step), k)).min_by(|x, y| x.0.total_cmp(&y.0)).unwrap().1;
    let (mut low, mut high) = ((coarse as f64 - 1.0) * step, (coarse as f64 + 1.0) * step);
    for _ in 0..100 {
        let (x, y) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(x) < at(y) { high = y } else { low = x }
    }
    at(0.5 * (low + high))
}

/// Smallest gap of a design of single rings, over all images within seven cells.
fn smallest_gap(design: &Design) -> f64 {
    let cores = cores(design);
    let [a1, a2] = [Vec3::from(design.lattice.a1), Vec3::from(design.lattice.a2)];
    let mut smallest = f64::INFINITY;
    for (i, a) in cores.iter().enumerate() {
        for (j, b) in cores.iter().enumerate() {
            for (s, t) in (-7..=7).flat_map(|s| (-7..=7).map(move |t| (s, t))) {
                if i == j && (s, t) == (0, 0) {
                    continue;
                }
                let b = Core { center: b.center + a1 * f64::from(s) + a2 * f64::from(t), ..*b };
                if (a.center - b.center).norm() < a.radius + b.radius + 4.0 * design.minor_radius.unwrap() {
                    smallest = smallest.min(least(a, &b) - 2.0 * design.minor_radius.unwrap());
                }
            }
        }
    }
    smallest
}

/// Rings that nothing links stand upright and touch as stadiums of half width s/2 do: s (2 R + s √3/2), s = 2 r + g.
#[test]
fn one_ring_stands_as_close_as_stadiums() {
    let text = "schema = 1\nname = \"one\"\nsource = \"own\"\nminor_radius = 0.1\nreference_radius = 1.0\n\
        [lattice]\na1 = [2.6, 0.0, 0.0]\na2 = [0.2, 2.5, 0.0]\n\
        [[elements]]\nname = \"ring\"\ncenter = [0.0, 0.0, 0.0]\nrings = [{ major_radius = 1.0, normal = [0.0, 0.3, 1.0] }]\n";
    let design = maille_io::read_design("one", text).unwrap();
    for gap in [0.0, 0.1, 0.3] {
        let (found, posed) = closest(&design, gap);
        let s: f64 = 0.2 + gap;
        let right = s * (2.0 + s * 3.0_f64.sqrt() / 2.0);
        assert!((area(&posed) - right).abs() < 1e-8, "{gap}: {} for {right}, {:?}", area(&posed), found.status);
        assert!((found.value.unwrap() * area(&design) - right).abs() < 1e-8);
    }
}

/// Gaps are those asked for, the area is that of the answer, and more gap takes more area.
#[test]
fn gaps_are_kept() {
    for name in ["european-4-in-1", "1.1", "kings-mail"] {
        let design = builtin(name);
        let mut last = 0.0;
        for gap in [0.0, 0.5 * widest(&design)] {
            let (found, posed) = closest(&design, gap);
            let value = certified(&found);
            assert!((area(&posed) / area(&design) - value).abs() < 1e-9, "{name}");
            let measured = smallest_gap(&posed);
            let most = 1e-9 * design.reference_radius;
            assert!(measured >= gap - 1e-12 && measured < gap + most, "{name}: {measured} for {gap}");
            assert!(value > last, "{name}: {value} at {gap}, {last} before");
            last = value;
        }
    }
}

/// Beside the closest cell no lattice of less area has the gap: the largest clearance with it held, from the same state.
#[test]
fn lattices_beside_it_have_less_room() {
    for name in ["european-4-in-1", "1.1"] {
        let design = builtin(name);
        let gap = 0.5 * widest(&design);
        let (found, posed) = closest(&design, gap);
        certified(&found);
        for k in 0..12 {
            let turn = f64::from(k) * std::f64::consts::TAU / 12.0;
            // A stretch of −e in one direction and of e/2 to −e/2 in the other, and a shear: each of less area.
            let (e, shear) = (1e-4, 2e-4 * f64::from(k % 3 - 1));
            let f = [[1.0 - e, shear], [0.0, 1.0 + e * (0.5 * turn.cos())]];
            let moved = |a: [f64; 3]| [f[0][0] * a[0] + f[0][1] * a[1], f[1][0] * a[0] + f[1][1] * a[1], 0.0];
            let mut beside = posed.clone();
            (beside.lattice.a1, beside.lattice.a2) = (moved(posed.lattice.a1), moved(posed.lattice.a2));
            assert!(area(&beside) < area(&posed));
            let beside = Design { allow_initial_overlap: true, ..beside };
            let model = Model::compile(&beside, Cell::PRIMITIVE).unwrap();
            let options = ExtremeOptions { lattice_free: false, starts: Some(1), ..ExtremeOptions::default() };
            let room = extreme(&model, Extreme::LargestClearance, &options, &AtomicBool::new(false));
            let room = room.value.unwrap() * model.unit;
            assert!(room < gap - 1e-7 * design.reference_radius, "{name}, {k}: {room} for {gap}");
        }
    }
}

/// All lengths 7.3 times as long, and the mirror image: the same share of the area.
#[test]
fn scale_and_mirror_change_nothing() {
    let design = builtin("european-4-in-1");
    let gap = 0.5 * widest(&design);
    let value = certified(&closest(&design, gap).0);
    let scaled = certified(&closest(&design.scaled(7.3), 7.3 * gap).0);
    assert!((scaled - value).abs() < 1e-8, "{scaled} for {value}");
    let mut mirrored = design.clone();
    for v in [&mut mirrored.lattice.a1, &mut mirrored.lattice.a2] {
        v[0] = -v[0];
    }
    for element in &mut mirrored.elements {
        element.center[0] = -element.center[0];
        element.rings.iter_mut().for_each(|ring| ring.normal[0] = -ring.normal[0]);
    }
    let mirrored = certified(&closest(&mirrored, gap).0);
    assert!((mirrored - value).abs() < 1e-8, "{mirrored} for {value}");
}

/// Wider than the widest gap: no cell, and the answer has the widest. As wide as nearly that: a cell.
#[test]
fn a_gap_too_wide_names_the_widest() {
    let design = builtin("european-4-in-1");
    let (model, widest) = (Model::compile(&design, Cell::PRIMITIVE).unwrap(), widest(&design));
    let (found, _) = closest(&design, 1.01 * widest);
    assert_eq!((found.status, found.value), (Status::NotConverged, None));
    let what = Extreme::ClosestCell { gap: 1.01 * widest / model.unit };
    assert!((what.widest_instead(&found, &model).unwrap() - widest).abs() < 1e-8);
    let (found, _) = closest(&design, 0.99 * widest);
    assert!(found.value.is_some());
}

#[test]
fn questions_that_cannot_be_asked() {
    let sheet = Sheet::in_cells(&builtin("1.1"), Cell::PRIMITIVE.into()).unwrap();
    for (question, field) in [
        (Question::closest_cell(-0.1), "min_gap"),
        (Question::closest_cell(f64::NAN), "min_gap"),
        (Question { sense: maille::question::Sense::Largest, ..Question::closest_cell(0.1) }, "sense"),
    ] {
        assert_eq!(sheet.answer(&question).unwrap_err().field, field);
    }
}
