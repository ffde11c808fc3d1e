//! Pictures: exact tori, the right things in front, and the same pixels on any number of threads.

use maille::{lattice::Cell, model::Model, record::ContactRecord};
use maille_geometry::{Circle, Torus, Vec3};
use maille_render::{
    Background, ColorBy, Extent, Forces, Picture, Ray, RenderError, RenderOptions, Subject, View, first_hit, render,
    render_frames,
};
use nalgebra::Unit;
use std::f64::consts::PI;

/// Numbers in [−1, 1) that are the same everywhere (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// (|p|² + R² − r²)² − 4 R² (|p|² − (p·N)²), over R⁴.
fn implicit(torus: &Torus, p: &Vec3) -> f64 {
    let (big, small) = (torus.circle.radius, torus.minor_radius);
    let d = p - torus.circle.center;
    let m = d.norm_squared() + big * big - small * small;
    let z = d.dot(&torus.circle.normal);
    (m * m - 4.0 * big * big * (d.norm_squared() - z * z)) / big.powi(4)
}

#[test]
fn rays_meet_tori_where_the_implicit_equation_says() {
    let mut numbers = Numbers(7);
    let (mut hits, mut worst) = (0, 0.0_f64);
    for k in 0..4000 {
        let big = [1.0, 0.5, 4.9, 1e-3][k % 4];
        let small = big * (0.03 + 0.45 * (0.5 + 0.5 * numbers.next()));
        let center = numbers.vector() * big;
        let normal = Unit::new_normalize(numbers.vector());
        let torus = Torus { circle: Circle::new(center, normal, big), minor_radius: small };
        // Towards a point near the ring, from outside; some rays lie in the ring's plane or run along its axis.
        let aim = center + numbers.vector() * (big + small);
        let mut direction = numbers.vector().normalize();
        let mut origin = aim - direction * (6.0 * big);
        if k % 7 == 0 {
            direction = (direction - normal.into_inner() * direction.dot(&normal)).normalize();
            origin = center + (aim - center) * 0.2 - direction * (6.0 * big);
        } else if k % 7 == 1 {
            direction = normal.into_inner();
            origin = aim - direction * (6.0 * big);
        }
        let ray = Ray { origin, direction };
        let step = 12.0 * big / 20_000.0;
        let found = (0..20_000).map(|i| f64::from(i) * step).find(|t| implicit(&torus, &ray.at(*t)) <= 0.0);
        match (first_hit(&torus, &ray, f64::INFINITY), found) {
            (None, None) => {}
            (None, Some(t)) => panic!("ray {k} is inside at {t}, and no hit was found"),
            (Some(t), found) => {
                hits += 1;
                worst = worst.max(implicit(&torus, &ray.at(t)).abs());
                // A graze shorter than a step may stay unseen by the samples, an entry must not.
                if let Some(found) = found {
                    assert!(t <= found + 1e-9 * big, "ray {k}: hit at {t} after {found}");
                    let between = found - t > 1.01 * step;
                    let graze = between && implicit(&torus, &ray.at(t + 0.5 * step)).abs() < 1e-4;
                    assert!(!between || graze, "ray {k}: hit at {t}, inside from {found}");
                }
                assert_eq!(first_hit(&torus, &ray, t - 1e-6 * big), None, "ray {k}: nothing is nearer");
            }
        }
    }
    assert!(hits > 1500, "{hits}");
    assert!(worst < 1e-12, "{worst:e}");
}

fn builtin(name: &str) -> Model {
    let design = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap();
    Model::compile(&design, Cell::PRIMITIVE).unwrap()
}

fn one_ring(minor_radius: f64) -> Model {
    let text = format!(
        "name = \"ring\"\nminor_radius = {minor_radius}\nreference_radius = 2.0\n[lattice]\na1 = [9.0, 0.0, 0.0]\n\
         a2 = [0.0, 9.0, 0.0]\n[[elements]]\nname = \"ring\"\ncenter = [0.3, 0.1, 0.0]\n\
         rings = [{{ major_radius = 2.0, normal = [0.0, 0.0, 1.0] }}]\n"
    );
    Model::compile(&maille_io::read_design("ring.toml", &text).unwrap(), Cell::PRIMITIVE).unwrap()
}

fn subject(model: &Model) -> Subject<'_> {
    Subject { model, state: &model.start, contacts: &[], unit: None }
}

/// A small picture with nothing but rings.
fn plain(extent: Extent, view: View) -> RenderOptions {
    RenderOptions {
        size: [240, 180],
        view,
        background: Background::Transparent,
        scale_bar: false,
        shadow: false,
        ..RenderOptions::new(extent)
    }
}

/// Area that the picture covers, in the file's unit.
fn covered(picture: &Picture) -> f64 {
    picture.rgba().iter().map(|p| f64::from(p[3]) / 255.0).sum::<f64>() * picture.pixel.powi(2)
}

#[test]
fn the_silhouette_of_a_ring_has_the_area_of_its_annulus() {
    // 0.012 is thinner than a pixel: every pixel is sampled in full.
    for r in [0.6, 0.2, 0.012] {
        let model = one_ring(r);
        let picture = render(&subject(&model), &plain(Extent::Cells([1, 1]), View::TOP)).unwrap();
        let area = PI * ((2.0 + r).powi(2) - (2.0_f64 - r).powi(2));
        let outline = 2.0 * PI * 4.0;
        let error = (covered(&picture) - area).abs();
        assert!(error < 0.02 * outline * picture.pixel, "r = {r}: {} instead of {area}", covered(&picture));
    }
}

#[test]
fn a_ring_from_the_side_is_a_stadium() {
    let (model, r) = (one_ring(0.4), 0.4);
    let picture = render(&subject(&model), &plain(Extent::Cells([1, 1]), View::SIDE)).unwrap();
    let area = 4.0 * 2.0 * r + PI * r * r;
    assert!((covered(&picture) - area).abs() < 0.004 * area, "{} instead of {area}", covered(&picture));
}

/// One camera for the whole film: a ring that rises keeps its size, and all of its way is in view.
#[test]
fn a_film_has_one_camera_and_all_frames() {
    let model = one_ring(0.4);
    let states: Vec<_> = (0..3)
        .map(|k| {
            let mut state = model.start.clone();
            state.poses[0].position.z += 3.0 * f64::from(k);
            state
        })
        .collect();
    let subjects: Vec<_> = states.iter().map(|state| Subject { state, ..subject(&model) }).collect();
    let mut pictures = Vec::new();
    render_frames(&subjects, &plain(Extent::Cells([1, 1]), View::SIDE), |_, _| {}, |picture| pictures.push(picture))
        .unwrap();
    let area = 4.0 * 2.0 * 0.4 + PI * 0.4 * 0.4;
    for picture in &pictures {
        assert!((covered(picture) - area).abs() < 0.02 * area, "{} instead of {area}", covered(picture));
    }
    let bytes = maille_render::film(&pictures, 8).unwrap();
    let mut film = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let size = pictures[0].size().map(|side| side as u16);
    assert_eq!([film.width(), film.height()], size);
    let mut first_rows = Vec::new();
    while let Some(frame) = film.read_next_frame().unwrap() {
        let background = frame.buffer[0];
        first_rows.push(frame.buffer.iter().position(|index| *index != background).unwrap() / usize::from(size[0]));
    }
    assert_eq!(first_rows.len(), 3);
    assert!(first_rows[0] > first_rows[1] && first_rows[1] > first_rows[2], "it rises: {first_rows:?}");
    assert!(maille_render::film(&[], 8).is_err());
}

#[test]
fn what_is_above_hides_what_is_below() {
    let model = builtin("1.1");
    let options = plain(Extent::Patch([5.0, 5.0]), View::TOP);
    let picture = render(&subject(&model), &options).unwrap();
    // The first ring, flat and blue, is in the middle; standing rings cross over it, amber along x, green along y.
    let at = |x: f64, y: f64| {
        let [i, j] = [120.0 + x / picture.pixel, 90.0 - y / picture.pixel].map(|p| p.floor() as usize);
        picture.rgba()[j * 240 + i]
    };
    let diagonal = 0.5_f64.sqrt();
    let [flat, along_x, along_y] = [at(diagonal, diagonal), at(1.0, 0.0), at(0.0, 1.0)];
    assert!(flat[2] > flat[0] && flat[2] > flat[1], "blue: {flat:?}");
    assert!(along_x[0] > along_x[2] && along_x[1] > along_x[2], "amber: {along_x:?}");
    assert!(along_y[1] > along_y[0] && along_y[1] > along_y[2], "green: {along_y:?}");
    assert_eq!(at(0.0, 0.0)[3], 0, "the hole is empty");
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let model = builtin("3.4");
    let contacts = [contact(&model)];
    for options in [
        RenderOptions { size: [200, 150], cell: true, ..RenderOptions::new(Extent::Cells([3, 2])) },
        RenderOptions {
            size: [150, 200],
            perspective: true,
            forces: Forces::Arrows,
            ..RenderOptions::new(Extent::Patch([6.0, 6.0]))
        },
    ] {
        let draw = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let subject = Subject { contacts: &contacts, ..subject(&model) };
            pool.install(|| render(&subject, &options)).unwrap().to_png().unwrap()
        };
        assert_eq!(draw(1), draw(3));
    }
}

/// A contact of the first link, as a locked state would have it.
fn contact(model: &Model) -> ContactRecord {
    let pair = model.links[0].pair;
    let a = model.start.circle(model, pair.ring_a, [0, 0]);
    let b = model.start.circle(model, pair.ring_b, pair.shift);
    let minima = maille_geometry::circle_distance_minima(&a, &b);
    let minimum = minima.closest();
    let [on_a, on_b] = [minimum.point_a, minimum.point_b].map(|p| p * model.unit);
    ContactRecord {
        ring_a: pair.ring_a,
        ring_b: pair.ring_b,
        shift: pair.shift,
        point_a: on_a.into(),
        point_b: on_b.into(),
        normal: (on_b - on_a).normalize().into(),
        force: 0.4,
    }
}

#[test]
fn forces_are_seen_as_arrows_and_as_loads() {
    let model = builtin("1.1");
    let contacts = [contact(&model)];
    let forced = Subject { contacts: &contacts, ..subject(&model) };
    let options = |forces, color| RenderOptions { forces, color, ..plain(Extent::Cells([2, 2]), View::TILTED) };
    let red = |picture: &Picture| {
        picture.rgba().iter().filter(|p| p[3] == 255 && p[0] > 150 && p[1] < 80 && p[2] < 120).count()
    };
    let without = render(&forced, &options(Forces::None, ColorBy::None)).unwrap();
    let with = render(&forced, &options(Forces::Arrows, ColorBy::None)).unwrap();
    assert_eq!(red(&without), 0);
    assert!(red(&with) > 20, "{}", red(&with));
    let loads = render(&forced, &options(Forces::None, ColorBy::Load)).unwrap();
    assert_ne!(loads.rgba(), without.rgba());
}

#[test]
fn backgrounds_and_words() {
    let model = builtin("2");
    let options = RenderOptions { size: [240, 180], ..RenderOptions::new(Extent::Cells([3, 3])) };
    let draw = |background, scale_bar| {
        render(&subject(&model), &RenderOptions { background, scale_bar, ..options.clone() }).unwrap().rgba()
    };
    let white = draw(Background::White, true);
    assert_eq!(white[0], [255, 255, 255, 255]);
    assert!(white.iter().all(|p| p[3] == 255));
    assert!(draw(Background::Dark, true)[0][0] < 40);
    assert_eq!(draw(Background::Transparent, true)[0], [0, 0, 0, 0]);
    let dark = |pixels: &[[u8; 4]]| pixels[150 * 240..].iter().filter(|p| p[..3].iter().all(|x| *x < 90)).count();
    assert!(dark(&white) > dark(&draw(Background::White, false)) + 20, "the scale bar is dark ink");
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let model = builtin("1.1");
    let options = RenderOptions { size: [64, 48], ..RenderOptions::new(Extent::Cells([2, 2])) };
    let error = |options: RenderOptions| render(&subject(&model), &options).unwrap_err();
    for size in [[0, 100], [100, 15], [20_000, 100], [8_000, 6_000]] {
        assert_eq!(
            error(RenderOptions { size, ..options.clone() }),
            RenderError::Size { width: size[0], height: size[1] }
        );
    }
    assert_eq!(error(RenderOptions { forces: Forces::Arrows, ..options.clone() }), RenderError::NoForces);
    assert_eq!(error(RenderOptions { color: ColorBy::Load, ..options.clone() }), RenderError::NoForces);
    assert_eq!(error(RenderOptions { extent: Extent::Cells([0, 3]), ..options.clone() }), RenderError::Nothing);
    for extent in [Extent::Cells([3000, 3000]), Extent::Patch([1e9, 1e9]), Extent::Patch([f64::NAN, 1.0])] {
        assert!(matches!(error(RenderOptions { extent, ..options.clone() }), RenderError::TooManyRings { .. }));
    }
    for (text, problem) in [
        ("above", "\"above\" is not a view: give top, tilted, side, or azimuth,elevation in degrees as 30,45"),
        ("30,x", "\"30,x\" is not a view: give top, tilted, side, or azimuth,elevation in degrees as 30,45"),
        ("30,91", "an elevation of 91 is not between -90 and 90 degrees"),
    ] {
        assert_eq!(text.parse::<View>().unwrap_err(), problem);
    }
    assert_eq!("-30, 45".parse::<View>().unwrap(), View { azimuth_deg: -30.0, elevation_deg: 45.0 });
}

/// A sheet that is seen from its edge fills the picture, though it is a narrow band.
#[test]
fn a_side_view_uses_its_picture() {
    let model = builtin("european-4-in-1");
    let size = [160, 60];
    let extent = Extent::filling(size, View::SIDE, model.unit);
    let options = RenderOptions { size, scale_bar: false, ..plain(extent, View::SIDE) };
    let picture = render(&subject(&model), &options).unwrap().rgba();
    let inked = picture.chunks(160).filter(|row| row.iter().any(|pixel| pixel[3] > 100)).count();
    assert!(inked > 24, "{inked} of 60 rows");
}

/// The part that is done grows to 1 for each frame.
#[test]
fn a_long_picture_tells_how_far_it_is() {
    let model = builtin("1.1");
    let subjects = [subject(&model), subject(&model)];
    let heard = std::sync::Mutex::new(Vec::new());
    let told = |frame: usize, part: f64| heard.lock().unwrap().push((frame, part));
    render_frames(&subjects, &plain(Extent::Cells([1, 1]), View::TOP), told, |_| {}).unwrap();
    let heard = heard.into_inner().unwrap();
    let most = |frame: usize| heard.iter().filter(|h| h.0 == frame).map(|h| h.1).fold(0.0, f64::max);
    assert!(heard.len() > 4 && most(0) == 1.0 && most(1) == 1.0, "{heard:?}");
}
