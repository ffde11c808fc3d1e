//! Symmetric directions of a design, from its rings alone.
//!
//! An isometry x → M x + t that maps the plane to itself, the lattice to itself, and the elements to elements takes each state
//! of the sheet to another one, and a pull along D to a pull along M D. So the largest l1 of the two directions is the
//! same number.

use serde_json::Value;

type Vec3 = [f64; 3];

/// Places and normals that differ by less, in reference radii, are the same.
const SAME: f64 = 1e-9;

/// A ring of an element.
struct Ring {
    center: Vec3,
    /// Unit vector; its sign is of no account.
    normal: Vec3,
    major: f64,
    minor: f64,
}

/// A design in units of its reference radius.
pub struct Sheet {
    lattice: [[f64; 2]; 2],
    elements: Vec<Vec<Ring>>,
}

/// The linear part of an isometry: a matrix of the plane, and the sign of z.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    rows: [[f64; 2]; 2],
    up: f64,
}

impl Turn {
    fn of(&self, v: Vec3) -> Vec3 {
        let [[a, b], [c, d]] = self.rows;
        [a * v[0] + b * v[1], c * v[0] + d * v[1], self.up * v[2]]
    }
}

impl Sheet {
    /// From a design as JSON; `None` where a key is missing.
    pub fn read(design: &Value) -> Option<Sheet> {
        let unit = design["reference_radius"].as_f64()?;
        let vector = |value: &Value| -> Option<Vec3> {
            Some([value[0].as_f64()? / unit, value[1].as_f64()? / unit, value[2].as_f64()? / unit])
        };
        let ring = |center: Vec3, ring: &Value| -> Option<Ring> {
            let normal = vector(&ring["normal"])?;
            let size = dot(normal, normal).sqrt();
            let minor = ring["minor_radius"].as_f64().or_else(|| design["minor_radius"].as_f64())?;
            Some(Ring {
                center: add(center, if ring["offset"].is_null() { [0.0; 3] } else { vector(&ring["offset"])? }, 1.0),
                normal: normal.map(|x| x / size),
                major: ring["major_radius"].as_f64()? / unit,
                minor: minor / unit,
            })
        };
        let element = |element: &Value| -> Option<Vec<Ring>> {
            let center = vector(&element["center"])?;
            element["rings"].as_array()?.iter().map(|value| ring(center, value)).collect()
        };
        let [a1, a2] = [vector(&design["lattice"]["a1"])?, vector(&design["lattice"]["a2"])?];
        let elements = design["elements"].as_array()?.iter().map(element).collect::<Option<_>>()?;
        Some(Sheet { lattice: [[a1[0], a1[1]], [a2[0], a2[1]]], elements })
    }

    /// Where each symmetry of the sheet takes a pull along `direction_deg`, in [0, 180).
    pub fn images(&self, direction_deg: f64) -> Vec<f64> {
        let (sin, cos) = direction_deg.to_radians().sin_cos();
        let image = |turn: &Turn| {
            let [x, y, _] = turn.of([cos, sin, 0.0]);
            y.atan2(x).to_degrees().rem_euclid(180.0)
        };
        self.turns().iter().map(image).collect()
    }

    /// Linear parts of all symmetries.
    fn turns(&self) -> Vec<Turn> {
        let [a1, a2] = self.lattice;
        let (long, det) = (norm(a1).max(norm(a2)), a1[0] * a2[1] - a1[1] * a2[0]);
        // Coordinates of a vector of length l are at most l |a| / |det|.
        let most = (long * long / det.abs()).ceil() as i32 + 1;
        let mut out = Vec::new();
        let vectors = |length: f64| {
            let at = move |m: i32, n: i32| {
                [f64::from(m) * a1[0] + f64::from(n) * a2[0], f64::from(m) * a1[1] + f64::from(n) * a2[1]]
            };
            let all = (-most..=most).flat_map(move |m| (-most..=most).map(move |n| at(m, n)));
            all.filter(move |v| (norm(*v) - length).abs() < SAME).collect::<Vec<_>>()
        };
        for b1 in vectors(norm(a1)) {
            for b2 in vectors(norm(a2)) {
                // [b1 b2] [a1 a2]⁻¹, orthogonal where lengths and angle are kept.
                let angle_kept = (b1[0] * b2[0] + b1[1] * b2[1] - a1[0] * a2[0] - a1[1] * a2[1]).abs() < SAME;
                let entry = |i: usize| [(b1[i] * a2[1] - b2[i] * a1[1]) / det, (b2[i] * a1[0] - b1[i] * a2[0]) / det];
                for up in [1.0, -1.0] {
                    let turn = Turn { rows: [entry(0), entry(1)], up };
                    if angle_kept && self.maps(&turn) {
                        out.push(turn);
                    }
                }
            }
        }
        out
    }

    /// Whether some translation after `turn` takes all elements to elements.
    fn maps(&self, turn: &Turn) -> bool {
        let Some(first) = self.elements.first().and_then(|rings| rings.first()) else { return false };
        let moved = turn.of(first.center);
        let targets = self.elements.iter().flatten().map(|ring| add(ring.center, moved, -1.0));
        targets.into_iter().any(|shift| {
            let onto = |rings: &[Ring]| self.elements.iter().any(|other| self.onto(turn, shift, rings, other));
            self.elements.iter().all(|rings| onto(rings))
        })
    }

    /// Whether one element is taken to an image of the other.
    fn onto(&self, turn: &Turn, shift: Vec3, rings: &[Ring], other: &[Ring]) -> bool {
        let places = |ring: &Ring| add(turn.of(ring.center), shift, 1.0);
        // All rings of an element go to the same cell: that of the first one's image.
        rings.len() == other.len()
            && other.iter().any(|target| {
                let [m, n] = self.cell_of(add(places(&rings[0]), target.center, -1.0));
                let cell =
                    std::array::from_fn(|k| if k < 2 { m * self.lattice[0][k] + n * self.lattice[1][k] } else { 0.0 });
                rings.iter().all(|ring| {
                    let (at, normal) = (add(places(ring), cell, -1.0), turn.of(ring.normal));
                    other.iter().any(|candidate| {
                        let apart = add(at, candidate.center, -1.0);
                        dot(apart, apart).sqrt() < SAME
                            && across(normal, candidate.normal) < SAME
                            && (ring.major - candidate.major).abs() < SAME
                            && (ring.minor - candidate.minor).abs() < SAME
                    })
                })
            })
    }

    /// The nearest lattice vector, in cells.
    fn cell_of(&self, v: Vec3) -> [f64; 2] {
        let [a1, a2] = self.lattice;
        let det = a1[0] * a2[1] - a1[1] * a2[0];
        [(v[0] * a2[1] - v[1] * a2[0]) / det, (a1[0] * v[1] - a1[1] * v[0]) / det].map(f64::round)
    }
}

fn add(a: Vec3, b: Vec3, times: f64) -> Vec3 {
    std::array::from_fn(|k| a[k] + times * b[k])
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Sine of the angle between two unit vectors.
fn across(a: Vec3, b: Vec3) -> f64 {
    let rejected = add(a, b, -dot(a, b));
    dot(rejected, rejected).sqrt()
}

fn norm([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn sheet(a2: [f64; 3], elements: Value) -> Sheet {
        let elements: Vec<Value> = elements
            .as_array()
            .unwrap()
            .iter()
            .map(|rings| json!({ "center": rings[0]["at"], "rings": rings }))
            .collect();
        let lattice = json!({ "a1": [5.0, 0.0, 0.0], "a2": a2 });
        let design = json!({ "reference_radius": 2.0, "minor_radius": 0.2, "lattice": lattice, "elements": elements });
        Sheet::read(&design).unwrap()
    }

    fn ring(at: [f64; 3], normal: [f64; 3]) -> Value {
        json!({ "at": at, "major_radius": 2.0, "normal": normal })
    }

    fn images(sheet: &Sheet, direction_deg: f64) -> Vec<i64> {
        let mut out: Vec<i64> = sheet.images(direction_deg).iter().map(|d| (d * 1e6).round() as i64).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    #[test]
    fn a_square_grid_has_its_quarter_turns_and_mirrors() {
        let flat = || json!([ring([0.0; 3], [0.0, 0.0, 1.0])]);
        let standing = |at: [f64; 3], normal: [f64; 3]| json!([ring(at, normal)]);
        let both = [standing([2.5, 0.0, 0.0], [0.0, 1.0, 0.0]), standing([0.0, 2.5, 0.0], [3.0, 0.0, 0.0])];
        let grid = sheet([0.0, 5.0, 0.0], json!([flat(), both[0], both[1]]));
        assert_eq!(grid.turns().len(), 16);
        assert_eq!(images(&grid, 10.0), [10_000_000, 80_000_000, 100_000_000, 170_000_000]);
        // One of the standing rings moved by a hair: no quarter turn, and one mirror line is left.
        let moved = standing([0.0, 2.5 + 1e-6, 0.0], [1.0, 0.0, 0.0]);
        let broken = sheet([0.0, 5.0, 0.0], json!([flat(), both[0], moved]));
        assert_eq!(images(&broken, 10.0), [10_000_000, 170_000_000]);
        // The same sheet by a badly reduced basis.
        let sheared = sheet([15.0, 5.0, 0.0], json!([flat(), both[0], both[1]]));
        assert_eq!(sheared.turns().len(), 16);
    }

    #[test]
    fn elements_go_to_elements_as_bodies() {
        // Two rings on a line: two elements, or one that is longer on the right.
        let [a, b] = [ring([0.0; 3], [0.0, 0.0, 1.0]), ring([2.5, 0.0, 0.0], [0.0, 0.0, 1.0])];
        let apart = sheet([0.0, 6.0, 0.0], json!([[a], [b]]));
        assert_eq!(images(&apart, 20.0), [20_000_000, 160_000_000]);
        let far = |x: f64| json!({ "at": [0.0, 0.0, 0.0], "major_radius": 2.0, "normal": [0.0, 0.0, 1.0], "offset": [x, 0.3, 0.0] });
        // A pair that leans and has no mirror image, only the half turn.
        let leaning = sheet([0.0, 6.0, 0.0], json!([[a, far(1.0)]]));
        assert_eq!(images(&leaning, 20.0), [20_000_000]);
    }

    #[test]
    fn an_oblique_cell_has_only_the_half_turn() {
        let oblique = sheet([1.3, 6.1, 0.0], json!([[ring([0.0; 3], [0.2, 0.3, 0.9])]]));
        assert_eq!(images(&oblique, 33.0), [33_000_000]);
        assert_eq!(oblique.turns().len(), 2);
    }
}
