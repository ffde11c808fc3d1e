//! The pixels: which points of the scene a pixel sees, and their mean.

use super::{
    bvh::{Bounds, Tree},
    camera::Camera,
    color::{self, Light},
    field::Field,
    ground::Ground,
    scene::Scene,
    shade::{Lights, Open},
    torus::Ray,
    tube::Tube,
};
use maille_geometry::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What a pixel sees.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pixel {
    /// Light from rings and arrows.
    pub(super) light: Light,
    /// Part of the pixel that they cover.
    pub(super) cover: f64,
    /// Shadow on the rest: the part of the background's light that it takes away.
    pub(super) shadow: f64,
}

impl Pixel {
    fn add(&mut self, other: Pixel, weight: f64) {
        self.light += other.light * weight;
        self.cover += other.cover * weight;
        self.shadow += other.shadow * weight;
    }
}

/// The scene with all that makes rays fast.
pub(super) struct Stage<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    lights: Lights,
    field: Field<'a>,
    rings: Tree,
    arrows: Tree,
    ground: Option<Ground>,
    /// Distance of the plane of an orthographic camera from its target.
    far: f64,
    /// Every pixel gets all samples: rings are too thin for a guess.
    thin: bool,
}

/// What a ray meets first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Thing {
    Ring(usize),
    Ground,
    Nothing,
}

#[derive(Clone, Copy)]
struct Sample {
    place: [f64; 2],
    ray: Ray,
    thing: Thing,
    point: Vec3,
    normal: Vec3,
    tangent: Vec3,
    /// Light and opacity of an arrow before it.
    arrow: Option<(Light, f64)>,
}

/// Opacity of an arrow behind a ring.
const THROUGH: f64 = 0.5;
/// How far the distance field reaches.
const REACH: f64 = 0.7;
/// Side of the blocks of pixels that are drawn at a time.
const BLOCK: usize = 32;
const GRID: usize = 4;

impl<'a> Stage<'a> {
    pub(super) fn new(scene: &'a Scene, camera: &'a Camera, ground: bool) -> Self {
        let bounds: Vec<Bounds> = scene
            .tori
            .iter()
            .map(|tube| {
                let ends = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| tube.extent(&axis));
                let (low, high) = (Vec3::from(ends.map(|end| end.0)), Vec3::from(ends.map(|end| end.1)));
                Bounds::around((low + high) * 0.5, (high - low) * 0.5)
            })
            .collect();
        let all = bounds.iter().copied().fold(Bounds::EMPTY, Bounds::join);
        let arrow_bounds: Vec<Bounds> = scene.arrows.iter().map(|a| a.bounds()).collect();
        let least_wire = scene.tori.iter().map(Tube::minor_radius).fold(f64::INFINITY, f64::min);
        let lights = Lights::new(camera.right, camera.up, camera.back);
        let field = Field::new(&scene.tori, all, REACH);
        let seen = ground && camera.back.z > 0.05;
        Self {
            ground: seen.then(|| Ground::new(&field, &lights, all, (2.0 * camera.pixel).max(0.005))),
            scene,
            camera,
            lights,
            field,
            rings: Tree::new(&bounds),
            arrows: Tree::new(&arrow_bounds),
            far: (all.high - all.low).norm() + 4.0,
            thin: 2.0 * least_wire < 3.0 * camera.pixel,
        }
    }

    /// All pixels, row by row. Each is a function of the scene alone: threads share work, not numbers. `told` hears what part
    /// is done.
    pub(super) fn draw(&self, width: usize, height: usize, told: &(dyn Fn(f64) + Sync)) -> Vec<Pixel> {
        let columns = width.div_ceil(BLOCK);
        let blocks = columns * height.div_ceil(BLOCK);
        let done = AtomicUsize::new(0);
        let block = |k: usize| {
            let pixels = self.block([k % columns * BLOCK, k / columns * BLOCK], width, height);
            told((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / blocks as f64);
            pixels
        };
        let drawn: Vec<Vec<Pixel>> = (0..blocks).into_par_iter().map(block).collect();
        let mut out = vec![Pixel::default(); width * height];
        for (k, block) in drawn.iter().enumerate() {
            let (x, y) = (k % columns * BLOCK, k / columns * BLOCK);
            let wide = BLOCK.min(width - x);
            for (row, pixels) in block.chunks(wide).enumerate() {
                let start = (y + row) * width + x;
                out[start..start + wide].copy_from_slice(pixels);
            }
        }
        out
    }

    /// The pixels of one block. Where the corners and the middle of a pixel see the same surface from nearly the same
    /// side, they stand for all of it; elsewhere sixteen samples are taken.
    fn block(&self, [left, top]: [usize; 2], width: usize, height: usize) -> Vec<Pixel> {
        let (wide, high) = (BLOCK.min(width - left), BLOCK.min(height - top));
        let corners: Vec<Sample> = match self.thin {
            true => Vec::new(),
            false => (0..(wide + 1) * (high + 1))
                .map(|k| self.sample((left + k % (wide + 1)) as f64, (top + k / (wide + 1)) as f64))
                .collect(),
        };
        let mut out = Vec::with_capacity(wide * high);
        for j in 0..high {
            for i in 0..wide {
                let (x, y) = ((left + i) as f64, (top + j) as f64);
                if !self.thin {
                    let k = j * (wide + 1) + i;
                    let at = |k: usize| corners[k];
                    let five = [self.sample(x + 0.5, y + 0.5), at(k), at(k + 1), at(k + wide + 1), at(k + wide + 2)];
                    if let Some(pixel) = self.smooth(&five) {
                        out.push(pixel);
                        continue;
                    }
                }
                out.push(self.rough(x, y));
            }
        }
        out
    }

    fn smooth(&self, five: &[Sample; 5]) -> Option<Pixel> {
        let [middle, others @ ..] = five;
        let alike = |s: &Sample| s.thing == middle.thing && s.arrow.is_none() && s.normal.dot(&middle.normal) > 0.7;
        if middle.thing == Thing::Nothing {
            return others.iter().all(|s| s.thing == Thing::Nothing && s.arrow.is_none()).then(Pixel::default);
        }
        if middle.arrow.is_some() || !others.iter().all(alike) {
            return None;
        }
        let open = self.open(middle);
        let mut pixel = Pixel::default();
        for (sample, weight) in five.iter().zip([0.5, 0.125, 0.125, 0.125, 0.125]) {
            pixel.add(self.look(sample, open), weight);
        }
        Some(pixel)
    }

    fn rough(&self, x: f64, y: f64) -> Pixel {
        let n = GRID as f64;
        let mut samples: Vec<Sample> = (0..GRID * GRID)
            .map(|k| {
                let (i, j) = ((k % GRID) as f64, (k / GRID) as f64);
                self.sample(x + (i + (j + 0.5) / n) / n, y + (j + (i + 0.5) / n) / n)
            })
            .collect();
        samples.sort_by(|a, b| a.thing.cmp(&b.thing).then(a.place[0].total_cmp(&b.place[0])));
        let mut pixel = Pixel::default();
        for group in samples.chunk_by(|a, b| a.thing == b.thing) {
            let mean = |axis: usize| group.iter().map(|s| s.place[axis]).sum::<f64>() / group.len() as f64;
            let middle = [mean(0), mean(1)];
            let off = |s: &Sample| (s.place[0] - middle[0]).hypot(s.place[1] - middle[1]);
            let nearest = group.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a group has a sample");
            let open = self.open(nearest);
            for sample in group {
                let mut seen = Pixel::default();
                let opacity = sample.arrow.map_or(0.0, |arrow| arrow.1);
                seen.add(self.look(sample, open), 1.0 - opacity);
                if let Some((light, opacity)) = sample.arrow {
                    seen.add(Pixel { light, cover: 1.0, shadow: 0.0 }, opacity);
                }
                pixel.add(seen, 1.0 / (GRID * GRID) as f64);
            }
        }
        pixel
    }

    fn sample(&self, x: f64, y: f64) -> Sample {
        let ray = self.camera.ray(x, y, self.far);
        let hit = self.rings.nearest(&ray, |k, most| self.scene.tori[k].first_hit(&ray, most.min(1e9)));
        let mut sample = Sample {
            place: [x, y],
            ray,
            thing: Thing::Nothing,
            point: Vec3::zeros(),
            normal: Vec3::z(),
            tangent: Vec3::x(),
            arrow: None,
        };
        let mut depth = f64::INFINITY;
        if let Some((k, t)) = hit {
            depth = t;
            (sample.thing, sample.point) = (Thing::Ring(k), ray.at(t));
            (sample.normal, sample.tangent) = self.scene.tori[k].frame_at(&sample.point);
        } else if let Some(ground) = &self.ground
            && ray.direction.z < 0.0
        {
            (sample.thing, sample.point) = (Thing::Ground, ray.at((ground.height - ray.origin.z) / ray.direction.z));
        }
        let arrows = &self.scene.arrows;
        if let Some((k, t)) = self.arrows.nearest(&ray, |k, _| arrows[k].hit(&ray).map(|hit| hit.0)) {
            let normal = arrows[k].hit(&ray).map_or(Vec3::z(), |hit| hit.1);
            let light = self.lights.arrow(&color::light(color::FORCE), &normal, &-ray.direction);
            sample.arrow = Some((light, if t < depth { 1.0 } else { THROUGH }));
        }
        sample
    }

    fn open(&self, sample: &Sample) -> Open {
        match sample.thing {
            Thing::Ring(k) => {
                let wire = self.scene.tori[k].minor_radius();
                self.lights.open(&self.field, &sample.point, &sample.normal, &sample.tangent, wire)
            }
            Thing::Ground | Thing::Nothing => Open { around: 1.0, key: 1.0 },
        }
    }

    fn look(&self, sample: &Sample, open: Open) -> Pixel {
        match (sample.thing, &self.ground) {
            (Thing::Ring(k), _) => {
                let view = -sample.ray.direction;
                let light = self.lights.surface(&self.scene.colors[k], &sample.normal, &view, open);
                Pixel { light, cover: 1.0, shadow: 0.0 }
            }
            (Thing::Ground, Some(ground)) => Pixel { shadow: ground.at(&sample.point), ..Pixel::default() },
            _ => Pixel::default(),
        }
    }
}
