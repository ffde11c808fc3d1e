//! Weaves with a name: links, gaps, and placements that cannot be made wider.

use maille::{design::Design, lattice::Cell, model::Model, topology};
use maille_io::{
    builtin, read_design,
    weave::{Rings, Weave, WeaveError},
};
use rand::{RngExt, SeedableRng};

fn model(design: &Design) -> Model {
    Model::compile(design, Cell::PRIMITIVE).unwrap_or_else(|e| panic!("{}: {e:?}", design.name))
}

/// Links of each ring, sorted, and the smallest gap in units of R.
fn links_and_gap(design: &Design) -> (Vec<usize>, f64) {
    let model = model(design);
    let mut links = vec![0; model.rings.len()];
    for link in &model.links {
        assert_eq!(link.number.abs(), 1);
        links[link.pair.ring_a] += 1;
        links[link.pair.ring_b] += 1;
    }
    links.sort_unstable();
    (links, topology::smallest_gap(&model, &model.start).unwrap().0)
}

fn expected_links(weave: Weave) -> Vec<usize> {
    match weave {
        Weave::European4In1 => vec![4; 2],
        Weave::European6In1 => vec![6; 2],
        Weave::Japanese4In1 => vec![2, 2, 4],
        Weave::Japanese6In1 => vec![2, 2, 2, 6],
        Weave::Japanese8In2 => vec![4, 4, 4, 4, 8, 8],
        Weave::Japanese12In2 => vec![4, 4, 4, 4, 4, 4, 12, 12],
        Weave::KingsMail => vec![8; 4],
    }
}

fn of_unit_radius(weave: Weave, minor: f64) -> Result<Design, WeaveError> {
    weave.design("test", &Rings { major: 1.0, minor, unit: None })
}

#[test]
fn built_in_weaves_have_their_links_and_gaps() {
    for weave in Weave::ALL {
        let design = read_design(weave.name(), builtin(weave.name()).unwrap()).unwrap();
        assert_eq!(design.name, weave.name());
        assert_eq!(design.unit.as_deref(), Some("mm"));
        let (links, gap) = links_and_gap(&design);
        assert_eq!(links, expected_links(weave), "{}", weave.name());
        assert!(gap > 0.01, "{}: gap {gap} R", weave.name());
    }
}

/// European 4-in-1 has a rounded cell of its own; the others are what `maille new` writes for their rings.
#[test]
fn built_in_weaves_are_those_that_are_generated() {
    for weave in Weave::ALL.into_iter().filter(|w| *w != Weave::European4In1) {
        let built_in = read_design(weave.name(), builtin(weave.name()).unwrap()).unwrap();
        let minor = built_in.minor_radius.unwrap();
        let rings = Rings { major: built_in.reference_radius, minor, unit: Some("mm".into()) };
        let generated = Design { source: built_in.source, ..weave.design(weave.name(), &rings).unwrap() };
        assert_eq!(built_in, generated);
    }
    let european = read_design("e", builtin("european-4-in-1").unwrap()).unwrap();
    assert_eq!((european.lattice.a1, european.lattice.a2), ([12.2, 0.0, 0.0], [0.0, 6.0, 0.0]));
    let [_, y, z] = european.elements[0].rings[0].normal;
    assert!((y.atan2(z).to_degrees() - 35.0).abs() < 1e-4);
}

#[test]
fn generated_weaves_have_their_links_at_every_proportion() {
    for weave in Weave::ALL {
        for minor in [0.01, 0.1, 0.16] {
            let (links, gap) = links_and_gap(&of_unit_radius(weave, minor).unwrap());
            assert_eq!(links, expected_links(weave), "{} at {minor}", weave.name());
            assert!(gap > 0.0);
        }
        // Scaled alike, the design is the same.
        let rings = Rings { major: 2500.0, minor: 250.0, unit: Some("um".into()) };
        let (scaled, unit) = (weave.design("x", &rings).unwrap(), of_unit_radius(weave, 0.1).unwrap());
        assert!((links_and_gap(&scaled).1 - links_and_gap(&unit).1).abs() < 2e-5);
    }
}

/// Japanese weaves in closed form: with spacing a, two flat rings are a − 2 apart and a flat ring crosses the disc of a
/// standing one 2 − a/2 from its circle; two standing rings of 4-in-1 are √2 (a/2 − 1) apart, those of 6-in-1 a/2 − 1.
#[test]
fn closed_forms() {
    for (weave, distance) in [(Weave::Japanese4In1, 2.0 - 2.0_f64.sqrt()), (Weave::Japanese6In1, 0.5)] {
        let (_, gap) = links_and_gap(&of_unit_radius(weave, 0.01).unwrap());
        assert!((gap + 0.02 - distance).abs() < 1e-5, "{}", weave.name());
    }
}

/// Lattice, centres and normals moved a little, alike for all images: the smallest gap does not grow. The symmetry of
/// the weave is kept by moving only what `placement` has as a parameter: the lattice's two lengths and the lean.
#[test]
fn no_small_change_of_the_placement_widens_the_smallest_gap() {
    let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(1);
    for weave in Weave::ALL {
        let design = of_unit_radius(weave, 0.01).unwrap();
        let (_, best) = links_and_gap(&design);
        let triangular = matches!(weave, Weave::Japanese6In1 | Weave::Japanese12In2);
        let mut largest = f64::NEG_INFINITY;
        for _ in 0..300 {
            let mut factor = || 1.0 + 0.02 * (2.0 * rng.random::<f64>() - 1.0);
            let [x, y, lean, apart] = [factor(), factor(), factor(), factor()];
            let y = if triangular || weave == Weave::Japanese4In1 || weave == Weave::Japanese8In2 { x } else { y };
            let moved = moved(&design, x, y, lean, apart);
            largest = largest.max(links_and_gap(&moved).1);
        }
        assert!(largest < best + 4e-4, "{}: {largest} > {best}", weave.name());
        assert!(largest > best - 0.05, "{}: the changes are too large to say anything", weave.name());
    }
}

/// Rings of a pair (half the difference of two elements whose names begin alike) move apart by `apart`, what is left of
/// a centre goes with the lattice, a normal's slope is changed by `lean`.
fn moved(design: &Design, x: f64, y: f64, lean: f64, apart: f64) -> Design {
    let mut out = design.clone();
    let stem = |name: &str| {
        ["-upper", "-lower", "-left", "-right"].iter().find_map(|s| name.strip_suffix(s).map(str::to_owned))
    };
    for a in [&mut out.lattice.a1, &mut out.lattice.a2] {
        *a = [a[0] * x, a[1] * y, 0.0];
    }
    for e in &mut out.elements {
        let twins: Vec<_> =
            design.elements.iter().filter(|o| stem(&o.name).is_some() && stem(&o.name) == stem(&e.name)).collect();
        let mid: [f64; 3] = match twins[..] {
            [a, b] => std::array::from_fn(|k| (a.center[k] + b.center[k]) / 2.0),
            _ => e.center,
        };
        let half: [f64; 3] = std::array::from_fn(|k| e.center[k] - mid[k]);
        let normal = &mut e.rings[0].normal;
        let upright = normal[2].abs() > 1e-9 && normal[2] < 1.0;
        let (old, length) = (*normal, half.iter().map(|h| h * h).sum::<f64>().sqrt() * apart);
        if upright {
            *normal = [old[0] * lean, old[1] * lean, old[2]];
        }
        let size = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        let side: f64 = half.iter().zip(old).map(|(h, n)| h * n).sum::<f64>().signum();
        let along: [f64; 3] = std::array::from_fn(|k| side * length * normal[k] / size);
        e.center = [mid[0] * x + along[0], mid[1] * y + along[1], mid[2] + along[2]];
    }
    out
}

#[test]
fn wire_that_is_too_thick_is_refused_with_the_wire_that_does() {
    for weave in Weave::ALL {
        let Err(WeaveError::TooThick { thickest, smallest, overlap, .. }) = of_unit_radius(weave, 0.4) else {
            panic!("{} takes rings of r = 0.4 R", weave.name());
        };
        assert!(overlap > 0.0);
        assert!(of_unit_radius(weave, thickest - 1e-4).is_ok() && of_unit_radius(weave, thickest + 1e-3).is_err());
        let with = |major: f64| weave.design("x", &Rings { major, minor: 0.4, unit: Some("mm".into()) });
        assert!(with(smallest + 1e-3).is_ok() && with(smallest - 1e-2).is_err());
        assert!(with(1.0).unwrap_err().to_string().ends_with(" mm deep"));
    }
    for (major, minor) in [(1.0, 1.0), (1.0, 0.0), (0.0, 0.0), (f64::NAN, 0.1), (1.0, -0.1), (f64::INFINITY, 0.1)] {
        let rings = Rings { major, minor, unit: None };
        assert!(matches!(Weave::KingsMail.design("x", &rings), Err(WeaveError::NoRing { .. })));
    }
}

#[test]
fn files_are_read_back_and_have_comments() {
    for weave in Weave::ALL {
        let rings = Rings { major: 5.5753, minor: 0.8128, unit: Some("mm".into()) };
        let design = weave.design("mine", &rings).unwrap();
        let text = weave.file(&design, None, Some("maille.schema.json"));
        assert_eq!(read_design("mine", &text).unwrap(), design);
        assert!(text.starts_with("#:schema maille.schema.json\n# "));
    }
}
