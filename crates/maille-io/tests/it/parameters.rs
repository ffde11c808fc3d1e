//! Named parameters of design files, and formulas over them.

use maille::{
    Question, Sheet,
    design::{Design, Parameter},
    record::LIMIT_COLUMNS,
    sensitivity::Sensitivity,
};
use maille_io::{DesignSource, NumberPath, read_design, sensitivity::ranked, set_parameters, write_design};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

const SQUARE: &str = include_str!("../../../../examples/parameters/square.toml");

fn square() -> Design {
    read_design("square", SQUARE).unwrap()
}

/// The numbers of a design without what they come from.
fn plain(design: &Design) -> Design {
    let mut out = Design { parameters: Vec::new(), formulas: Default::default(), ..design.clone() };
    out.varied.clear();
    out
}

/// The same design, written with numbers.
fn written(wire: f64, radius: f64, play: f64, tilt: f64) -> Design {
    let pitch = 2.5 * play * radius;
    let (c, s) = (tilt.to_radians().cos(), tilt.to_radians().sin());
    let text = format!(
        "name = \"square\"\ntitle = \"A square weave with three parameters\"\nunit = \"mm\"\nminor_radius = {:?}\n\
         reference_radius = {radius:?}\n[lattice]\na1 = [{pitch:?}, 0, 0]\na2 = [0, {pitch:?}, 0]\n\
         [[elements]]\nname = \"flat\"\ncenter = [0, 0, 0]\nrings = [{{ major_radius = {radius:?}, normal = [0, 0, 1] }}]\n\
         [[elements]]\nname = \"along-x\"\ncenter = [{:?}, 0, 0]\nrings = [{{ major_radius = {radius:?}, normal = [0, {c:?}, {s:?}] }}]\n\
         [[elements]]\nname = \"along-y\"\ncenter = [0, {:?}, 0]\nrings = [{{ major_radius = {radius:?}, normal = [{c:?}, 0, {s:?}] }}]\n",
        wire / 2.0,
        pitch / 2.0,
        pitch / 2.0,
    );
    read_design("plain", &text).unwrap()
}

#[test]
fn formulas_give_the_numbers_of_the_plain_file() {
    let design = square();
    assert_eq!(plain(&design), written(1.2, 6.0, 1.0, 0.0));
    let names: Vec<&str> = design.free_parameters().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["wire", "radius", "play", "tilt"], "in the order of the file");
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    for _ in 0..200 {
        let mut between = |a: f64, b: f64| a + (b - a) * rng.random::<f64>();
        let (wire, radius, play, tilt) =
            (between(0.4, 2.0), between(4.0, 8.0), between(0.92, 1.2), between(-30.0, 30.0));
        let values = [("wire", wire), ("radius", radius), ("play", play), ("tilt", tilt)];
        let set = design.with_parameters(&values).unwrap();
        assert_eq!(plain(&set), written(wire, radius, play, tilt), "{values:?}");
        // What is set can be set back.
        let back = set.with_parameters(&[("wire", 1.2), ("radius", 6.0), ("play", 1.0), ("tilt", 0.0)]).unwrap();
        assert_eq!(back, design);
    }
}

#[test]
fn parameters_survive_files_and_records() {
    let design = square().with_parameters(&[("radius", 5.123456789), ("tilt", 12.0)]).unwrap();
    assert_eq!(read_design("written", &write_design(&design)).unwrap(), design);
    let json = serde_json::to_string(&design).unwrap();
    assert_eq!(serde_json::from_str::<Design>(&json).unwrap(), design);
    // Records of designs without parameters are as they were.
    let json = serde_json::to_value(plain(&design)).unwrap();
    assert!(json.get("parameters").is_none() && json.get("formulas").is_none());
}

#[test]
fn formulas_that_hold_no_longer_go() {
    let design = square();
    let thin = design.with_minor_radius(0.3);
    assert!(!thin.formulas.contains_key("minor_radius"));
    assert_eq!(thin.with_parameters(&[("wire", 1.0)]).unwrap_err()[0].problem, "wire is no parameter of the design");
    let thicker = thin.with_parameters(&[("radius", 7.0)]).unwrap();
    assert_eq!((thicker.minor_radius, thicker.lattice.a1[0]), (Some(0.3), 17.5));
    // The same numbers leave all as it is.
    assert_eq!(design.with_minor_radius(0.6), design);
    // A number that was changed by hand is written as a number.
    let mut moved = design.clone();
    moved.lattice.a1[0] = 14.0;
    let read = read_design("moved", &write_design(&moved)).unwrap();
    assert_eq!((read.lattice.a1[0], read.formulas.contains_key("lattice.a1[0]")), (14.0, false));
    for changed in [design.spaced(0.9), design.scaled(2.0)] {
        assert!(!changed.formulas.contains_key("lattice.a1[0]"));
        let read = read_design("changed", &write_design(&changed)).unwrap();
        assert_eq!(plain(&read), plain(&changed));
    }
}

#[test]
fn studies_and_commands_set_parameters_by_name() {
    let path: NumberPath = "radius".parse().unwrap();
    let set = path.set(&square(), 5.0).unwrap();
    assert_eq!((set.reference_radius, set.lattice.a2[1], set.varied["radius"]), (5.0, 12.5, 5.0));
    assert_eq!(set, set_parameters(&square(), &[("radius", 5.0)]).unwrap());
    let error = |name: &str, x: f64| {
        let mut problems = set_parameters(&square(), &[(name, x)]).unwrap_err();
        let first = problems.remove(0);
        (first.problem, first.help)
    };
    assert_eq!(error("raduis", 5.0).1, "did you mean radius?");
    assert_eq!(error("radius", 9.0).0, "9 is above max = 8");
    assert_eq!(error("pitch", 9.0).0, "is computed as \"2.5 * play * radius\"");
    assert_eq!(error("tilt", f64::NAN).0, "its value NaN is not finite");
    let other = read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    assert_eq!(path.set(&other, 1.0).unwrap_err().problem, "1.1 has no parameter radius");
}

/// A design made in code, or a record that was edited, may say two things of one number.
#[test]
fn a_number_that_is_not_its_formulas_is_refused() {
    let mut design = square();
    assert_eq!(design.problems(), []);
    design.lattice.a1[0] *= 1.0 + 1e-12;
    assert_eq!(design.problems(), [], "sines of machines differ by less");
    design.lattice.a1[0] = 14.0;
    design.parameters[4].value = 3.0;
    let problems: Vec<String> = design.problems().iter().map(|p| format!("{}: {}", p.field, p.problem)).collect();
    let of_pitch = "parameters.pitch: is 3, but its formula \"2.5 * play * radius\" gives 15";
    assert_eq!(problems, [of_pitch, "lattice.a1[0]: is 14, but its formula \"pitch\" gives 15"]);
    let settled = design.settled();
    assert_eq!((settled.problems().len(), settled.lattice.a1[0], settled.parameters[4].value), (0, 14.0, 15.0));
}

/// Tables have a column for each parameter, beside their own.
#[test]
fn no_parameter_has_the_name_of_a_column() {
    for name in LIMIT_COLUMNS.iter().map(|column| column.name).chain(["record", "direction", "r", "spacing"]) {
        let parameter = Parameter { name: name.into(), value: 1.0, formula: None, min: None, max: None };
        let problems = Design { parameters: vec![parameter], ..plain(&square()) }.problems();
        assert!(problems.len() == 1 && problems[0].problem.contains("column of tables"), "{name}: {problems:?}");
    }
}

#[test]
fn a_parameter_is_set_once() {
    let problems = square().with_parameters(&[("radius", 5.0), ("radius", 6.0)]).unwrap_err();
    assert_eq!((problems[0].field.as_str(), problems[0].problem.as_str()), ("parameters.radius", "is set twice"));
}

/// Any text in place of a formula gives a design or an error with a place, and never a panic.
#[test]
fn any_text_is_read_or_refused() {
    const PIECES: [&str; 26] = [
        "(", ")", "+", "-", "*", "/", "^", ",", ".", " ", "1", "2.5", "1e3", "e", "radius", "pitch", "sin", "max(",
        "min", "deg(", "pi", "é", "'", "#", "\t", "nan",
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut read = 0;
    for _ in 0..3000 {
        let count = rng.random_range(0..9);
        let text: String = (0..count).map(|_| PIECES[rng.random_range(0..PIECES.len())]).collect();
        let file = SQUARE.replacen("\"wire / 2\"", &format!("\"{text}\""), 1);
        let other = SQUARE.replacen("\"2.5 * play * radius\"", &format!("\"{text}\""), 1);
        for file in [file, other] {
            match DesignSource::new("random", file).read() {
                Ok(design) => {
                    assert!(design.problems().is_empty());
                    read += 1;
                }
                Err(error) => assert!(!error.list().is_empty()),
            }
        }
    }
    assert!(read > 20, "{read}");
}

/// The limit along x is (4 R − 2 wire) / (2.5 play R) − 1 with R the radius: its derivatives by the parameters of the file.
#[test]
fn a_limit_changes_with_parameters_as_its_closed_form_does() {
    let (wire, radius, play) = (1.2, 6.0, 0.92);
    // On its bound, so its rate is one to one side.
    let design = square().with_parameters(&[("play", play)]).unwrap();
    let question = Question::stretch_along(0.0);
    let sheet = Sheet::compile(&design).unwrap();
    let answer = sheet.answer(&question).unwrap();
    let pitch = 2.5 * play * radius;
    assert!((answer.limit().unwrap() - ((4.0 * radius - 2.0 * wire) / pitch - 1.0)).abs() < 1e-9);
    let found = Sensitivity::of(&sheet.model_of(&answer), &question, &answer).unwrap();
    let numbers = ranked(&design, &found, None);
    for (name, slope) in [
        ("wire", -2.0 / pitch),
        ("radius", 2.0 * wire / (radius * pitch)),
        ("play", -(4.0 * radius - 2.0 * wire) / (pitch * play)),
        ("tilt", 0.0),
    ] {
        let line = numbers.iter().find(|line| line.number == format!("parameter {name}")).unwrap();
        let forward = line.slope.forward.finite().unwrap();
        assert!((forward - slope).abs() < 1e-5 * slope.abs().max(1e-3), "{name}: {forward}, expected {slope}");
    }
}
