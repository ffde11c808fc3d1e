//! The image bound.

use crate::common;
use maille::{bound::ImageBound, model::Model};
use maille_geometry::{Circle, Vec3, linking_number};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

fn gyroscopes(minor_radius: f64) -> Model {
    common::model("1.3-small", minor_radius)
}

/// Core distance by dense sampling: never below the true one.
fn sampled_distance(a: &Circle, b: &Circle) -> f64 {
    let to_b = |p: Vec3| {
        let height = (p - b.center).dot(&b.normal);
        let across = (p - b.center - *b.normal * height).norm() - b.radius;
        height.hypot(across)
    };
    (0..360).map(|k| to_b(a.point(f64::from(k).to_radians()))).fold(f64::INFINITY, f64::min)
}

/// Nearer than 2/√3 two gyroscopes are linked, however thin their wire.
#[test]
fn gyroscopes_keep_their_distance() {
    let thin = ImageBound::new(&gyroscopes(0.02)).least(0);
    let thick = ImageBound::new(&gyroscopes(0.1)).least(0);
    assert!(thin > 2.0 / 3f64.sqrt(), "{thin}");
    assert!(thick > thin + 0.2, "{thick}");
}

/// Wire too thin for the cubes near 0 proves less, and nothing wrong.
#[test]
fn thin_wire_proves_less() {
    let [thin, thinnest] = [0.0015, 0.001].map(|r| ImageBound::new(&gyroscopes(r)).least(0));
    assert!(thin > 2.0 / 3f64.sqrt() && thin < 2f64.sqrt() + 0.02, "{thin}");
    assert_eq!(thinnest, 0.0);
}

/// Single rings can lie flat on each other.
#[test]
fn rings_can_be_stacked() {
    let model = gyroscopes(0.1);
    assert_eq!(ImageBound::new(&model).least(1), 0.2);
}

/// No translation below the bound is free of overlap and links, by trying.
#[test]
fn nothing_is_possible_below_the_bound() {
    let model = gyroscopes(0.1);
    let least = ImageBound::new(&model).least(0);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut beyond = 0;
    for _ in 0..6_000 {
        let w = Vec3::from_fn(|_, _| rng.random_range(-2.2..2.2));
        let possible = model.elements[0].rings.clone().all(|a| {
            model.elements[0].rings.clone().all(|b| {
                let mut image = model.start.circle(&model, b, [0, 0]);
                image.center += w;
                let circle = model.start.circle(&model, a, [0, 0]);
                sampled_distance(&circle, &image) >= model.contact_distance(a, b)
                    && linking_number(&circle, &image) == 0
            })
        });
        assert!(!possible || w.norm() >= least - 1e-9, "{w} is possible");
        beyond += usize::from(possible);
    }
    assert!(beyond > 30, "the test saw {beyond} possible translations");
}
