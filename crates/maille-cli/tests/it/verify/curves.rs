//! Limits and rolls of elements with curves.

use super::specimen::{all_proved, said, verified};
use crate::common::{code, maille};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use serde_json::Value;
use std::fs;

/// Long links and rounded squares; what is planted is found.
#[test]
fn limits_of_curves_are_proved() {
    let dir = tempfile::tempdir().unwrap();
    for (name, rest) in [
        ("stadium-chain", ""),
        ("stadium-sheet", "--directions 0,30,45 --l2=-0.1,0"),
        // At 37.5° with l2 = −0.1 corners slide fast along sides: derivatives need short steps.
        ("squares", "--directions 0,37.5 --l2=-0.1,0.05"),
    ] {
        let line = format!("characterize {name} {rest} --cell 1x1 --out {name} --quiet");
        assert_eq!(code(&maille(dir.path(), &line)), 0, "{line}");
        all_proved(dir.path(), name);
    }
    // A longer link than that of the states: they overlap, or their contacts lie on no curve.
    let run = dir.path().join("stadium-sheet/run.json");
    let text = fs::read_to_string(&run).unwrap();
    assert!(text.contains("\"straight\":1.0") || text.contains("\"straight\": 1.0"), "{text}");
    let longer =
        text.replace("\"straight\":1.0", "\"straight\":1.01").replace("\"straight\": 1.0", "\"straight\": 1.01");
    fs::write(&run, longer).unwrap();
    let (_, found) = verified(dir.path(), "stadium-sheet");
    assert_eq!(said(&found, "balance", "false").len(), 6, "{found:#}");
    assert_eq!(said(&found, "overlap", "false").len(), 6, "{found:#}");
}

/// Curves that lie about no centre: their bounds have the smallest balls around them, here and in `verify`, and are reached.
#[test]
fn limits_of_random_splines_are_proved_and_some_are_global() {
    let dir = tempfile::tempdir().unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(54);
    let mut spline = |count: u32| {
        let mut points = Vec::new();
        for k in 0..count {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
            let [x, y, z] = [cos, sin, 0.0].map(|at| at + rng.random_range(-0.08..0.08));
            points.push(format!("[{x}, {y}, {z}]"));
        }
        format!("spline = {{ points = [{}] }}", points.join(", "))
    };
    let mut global = 0;
    for design in 0..4 {
        let text = format!(
            r#"schema = 1
name = "s{design}"
minor_radius = 0.1
reference_radius = 1.0
allow_initial_overlap = true
lattice = {{ a1 = [2.6, 0, 0], a2 = [0, 2.6, 0] }}
elements = [
    {{ name = "flat", center = [0, 0, 0], curves = [{{ {} }}] }},
    {{ name = "x", center = [1.3, 0, 0], rings = [{{ major_radius = 0.92, normal = [0, 1, 0] }}] }},
    {{ name = "y", center = [0, 1.3, 0], curves = [{{ {}, normal = [1, 0, 0], along = [0, 1, 0] }}] }},
]
"#,
            spline(6),
            spline(8)
        );
        fs::write(dir.path().join(format!("s{design}.toml")), text).unwrap();
        let rest = "--directions 0:90:45 --l2=-0.03,0 --starts 2 --cell 1x1 --quiet";
        let line = format!("characterize s{design}.toml {rest} --out s{design}");
        assert_eq!(code(&maille(dir.path(), &line)), 0, "{line}");
        all_proved(dir.path(), &format!("s{design}"));
        let rows = fs::read_to_string(dir.path().join(format!("s{design}/limits.csv"))).unwrap();
        global += rows.matches(",global,").count();
    }
    assert!(global >= 4, "{global}");
    let run = dir.path().join("s0/run.json");
    let text = fs::read_to_string(&run).unwrap();
    fs::write(&run, text.replace("\"curve_deviation\": ", "\"curve_deviation\": 1")).unwrap();
    let done = maille(dir.path(), "verify s0");
    assert_eq!(code(&done), 4);
    assert!(String::from_utf8_lossy(&done.stderr).contains("curve_deviation was edited"));
}

/// Rolls of squares and of cages, and a cage that is thicker than that of the states.
#[test]
fn rolls_of_curves_are_proved() {
    let dir = tempfile::tempdir().unwrap();
    let verdicts = |name: &str, checks: &[&str]| {
        let done = maille(dir.path(), &format!("verify {name} --json"));
        let found: Value = serde_json::from_slice(&done.stdout).unwrap();
        let of = |roll: &Value, check: &str| {
            let all = roll["findings"].as_array().unwrap();
            let one = all.iter().find(|finding| finding["check"] == check);
            one.map_or("none".into(), |finding| finding["verdict"].as_str().unwrap().to_owned())
        };
        let rolls = found["rolls"][0]["rolls"].as_array().unwrap();
        checks.iter().map(|check| rolls.iter().map(|roll| of(roll, check)).collect()).collect::<Vec<Vec<String>>>()
    };
    // Steps of the usual size leave the sign of a curvature of this one open.
    const FREE: &str = "--directions 15 --axis below --free width,shear";
    for (name, rest, rolls) in [("squares", FREE, 1), ("cages", "--directions 0,45", 4)] {
        let line = format!("roll {name} {rest} --effort low --out {name} --quiet");
        assert_eq!(code(&maille(dir.path(), &line)), 0, "{line}");
        let checks = ["overlap", "links", "balance", "curvature"];
        assert_eq!(verdicts(name, &checks), vec![vec!["proved"; rolls]; checks.len()], "{name}: {checks:?}");
    }
    let head = dir.path().join("cages/roll.json");
    let text = fs::read_to_string(&head).unwrap();
    let thicker = text.replace("\"minor_radius\":0.6", "\"minor_radius\":0.601");
    let thicker = thicker.replace("\"minor_radius\": 0.6", "\"minor_radius\": 0.601");
    let edited = "design or parameters of roll.json were edited";
    for forged in [text.replacen("\"seed\": 1", "\"seed\": 2", 1), thicker] {
        assert_ne!(forged, text);
        fs::write(&head, forged).unwrap();
        let done = maille(dir.path(), "verify cages --quiet");
        assert!(code(&done) == 4 && String::from_utf8_lossy(&done.stdout).contains(edited));
    }
    assert_eq!(verdicts("cages", &["overlap", "balance"]), [["false"; 4]; 2]);
}

/// What is known of rings alone says so.
#[test]
fn what_knows_rings_alone_refuses_curves() {
    let dir = tempfile::tempdir().unwrap();
    let design = "stadium-sheet";
    maille(dir.path(), &format!("characterize {design} --directions 0,30 --l2 0 --out record --quiet"));
    for line in [
        format!("prove {design} --direction 0 --l2 0"),
        format!("sensitivity {design} --direction 0"),
        format!("fit {design} --target record/limits.csv --free minor_radius=0.05:0.2"),
    ] {
        let refused = maille(dir.path(), &line);
        let words = String::from_utf8_lossy(&refused.stderr);
        assert!(code(&refused) != 0 && words.contains("curves"), "{line}: {words}");
    }
}
