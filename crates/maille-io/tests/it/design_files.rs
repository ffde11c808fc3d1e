//! Design files: the built-in ones, the round trip, and what the reader accepts.

use maille::{
    Model,
    design::{Design, Source},
    lattice::Cell,
};
use maille_io::{builtin, builtin_designs, read_design, write_design};

fn design(name: &str) -> Design {
    read_design(name, builtin(name).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn every_builtin_design_is_read_and_survives_the_round_trip() {
    for builtin in builtin_designs() {
        let design = design(builtin.name);
        assert_eq!(design.name, builtin.name);
        let round = design.elements.iter().all(|element| element.curves.is_empty());
        if design.unit.is_none() && round {
            assert_eq!((design.minor_radius, design.reference_radius), (Some(0.1), 1.0));
        }
        assert!(!design.title.is_empty() && builtin.toml.starts_with("# "), "{}", builtin.name);
        assert_eq!(design.allow_initial_overlap, builtin.name.ends_with("-chapter6"));
        assert_eq!(read_design("written", &write_design(&design)).unwrap(), design);
    }
    assert!(builtin("9.9").is_none());
}

#[test]
fn the_embedded_designs_are_all_those_of_the_folder() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/designs");
    let stems = |folder: &str| -> Vec<String> {
        let files = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        files.filter_map(|name| Some(name.strip_suffix(".toml")?.to_owned())).collect()
    };
    let starts = stems(&format!("{folder}/chapter6")).into_iter().map(|name| name + "-chapter6");
    let mut files: Vec<String> = stems(folder).into_iter().chain(starts).collect();
    files.sort();
    let mut names: Vec<_> = builtin_designs().iter().map(|d| d.name.to_owned()).collect();
    names.sort();
    assert_eq!(files, names);
}

/// Only smooth curves are not their own segments and arcs.
#[test]
fn smooth_curves_deviate_by_less_than_their_tolerance() {
    for builtin in builtin_designs() {
        let design = design(builtin.name);
        match design.curve_deviation() {
            Some(deviation) => assert!(
                ["ellipses", "torus-knots"].contains(&builtin.name)
                    && deviation > 0.0
                    && deviation <= 1e-6 * design.reference_radius,
                "{}: {deviation}",
                builtin.name
            ),
            None => assert!(!["ellipses", "torus-knots"].contains(&builtin.name), "{}", builtin.name),
        }
    }
}

/// In reference radii a design that is scaled by a power of two is the same bit for bit: no length is left out.
#[test]
fn every_length_of_a_design_is_scaled() {
    for builtin in builtin_designs() {
        let design = design(builtin.name);
        let model = |design: &Design| {
            let Model { rings, start, .. } = Model::compile(design, Cell::PRIMITIVE).unwrap();
            format!("{rings:?} {start:?}")
        };
        assert!(model(&design) == model(&design.scaled(4.0)), "{}", builtin.name);
    }
}

#[test]
fn elements_and_rings_are_counted() {
    let counts = [
        ("1.1", 3, 3),
        ("1.3", 3, 5),
        ("2", 2, 2),
        ("3.1", 4, 4),
        ("3.3", 9, 9),
        ("3.4", 4, 9),
        ("4.1", 2, 3),
        ("4.2", 3, 5),
        ("4.3", 3, 6),
        ("5.1", 6, 6),
        ("5.2", 8, 8),
    ];
    for (name, elements, rings) in counts {
        let design = design(name);
        let found = (design.elements.len(), design.elements.iter().map(|e| e.rings.len()).sum::<usize>());
        assert_eq!(found, (elements, rings), "{name}");
    }
}

#[test]
fn sources_say_what_the_text_fixes() {
    for builtin in builtin_designs() {
        let named = builtin.name.starts_with(char::is_alphabetic);
        let reconstructed = named || ["3.3", "3.4", "4.", "5."].iter().any(|design| builtin.name.starts_with(design));
        let expected = match reconstructed {
            _ if ["torus-knots", "cages", "octahedra"].contains(&builtin.name) => Source::Literature,
            true => Source::Reconstruction,
            false => Source::ThesisText,
        };
        assert_eq!(design(builtin.name).source, expected, "{}", builtin.name);
    }
}

#[test]
fn whole_numbers_and_every_spelling_of_tables_are_read() {
    let text = r#"
        name = 'odd'
        reference_radius = 1_0
        lattice = { a1 = [30, 0, 0], a2 = [0, 0x1e, 0] }
        [[elements]]
        name = "ring"
        center = [0, 0, 0]
        [[elements.rings]]
        major_radius = 1e1
        normal = [0, 0, -2]
        minor_radius = 0.5
    "#;
    let design = read_design("odd", text).unwrap();
    assert_eq!(design.lattice.a2, [0.0, 30.0, 0.0]);
    assert_eq!(design.source, Source::Own);
    let ring = &design.elements[0].rings[0];
    assert_eq!(
        (ring.major_radius, ring.normal, ring.offset, ring.minor_radius),
        (10.0, [0.0, 0.0, -2.0], [0.0; 3], Some(0.5))
    );
}

#[test]
fn numbers_and_odd_names_survive_the_round_trip_bit_for_bit() {
    let mut design = design("3.4");
    design.name = "a \"quoted\" \\ name\u{7}".into();
    design.title = "two\nlines, \ttab, λ − ö".into();
    design.unit = Some("mm".into());
    design.minor_radius = None;
    design.reference_radius = 0.1 + 0.2;
    design.lattice.a1 = [1e300, -5e-324, 0.0];
    design.lattice.a2 = [1.0 / 3.0, 1e22, 0.0];
    for (i, ring) in design.elements.iter_mut().flat_map(|e| &mut e.rings).enumerate() {
        ring.minor_radius = Some(0.01 * std::f64::consts::PI / (i as f64 + 1.0));
    }
    assert_eq!(read_design("written", &write_design(&design)).unwrap(), design);
}

/// A chain has a1 alone in its file; the second vector stands across it, too far to touch.
#[test]
fn a_chain_is_read_and_written_without_a2() {
    let chain = design("cable");
    assert!(chain.lattice.single && chain.lattice.a2[0] == 0.0 && chain.lattice.a2[1] > 10.0 * chain.reference_radius);
    let written = write_design(&chain);
    assert!(written.contains("a1 = ") && !written.contains("a2"), "{written}");
    assert_eq!(read_design("written", &written).unwrap(), chain);
    let turned = written.replace("a1 = [13.2, 0.0, 0.0]", "a1 = [0.0, 13.2, 0.0]");
    let turned = read_design("turned", &turned).unwrap().lattice;
    assert!(turned.a2[0] < -10.0 && turned.a2[1] == 0.0 && turned.direction_deg() == 90.0);
    assert!(!design("1.1").lattice.single);
    let json = serde_json::to_string(&chain).unwrap();
    assert_eq!(serde_json::from_str::<Design>(&json).unwrap(), chain);
}
