//! The raw numbers of a design as one vector: a change of them, or the derivatives by them.

use crate::symmetry::Image;
use maille_design::{Design, InvalidInput, RingSpec};
use maille_geometry::Vec3;
use nalgebra::{UnitQuaternion, Vector2};

/// Half of the step of [`DesignVector::by_number`], relative to the value or to 1.
const HALF_STEP: f64 = 1e-6;

/// One entry for each raw number of a design: as a change, lengths are in the design's unit and tilts in radians.
///
/// The elements' centres have no entry: a limit is sought over all positions, so they change nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignVector {
    /// Of the lattice vectors a1 and a2.
    pub lattice: [Vector2<f64>; 2],
    /// Of all rings, in the order of the file.
    pub rings: Vec<RingVector>,
}

/// The entries of one ring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RingVector {
    /// Of R.
    pub major_radius: f64,
    /// Of r.
    pub minor_radius: f64,
    /// Of its centre relative to that of its element, along the design's axes.
    pub offset: Vec3,
    /// Of its plane: a rotation vector about its own centre, along the design's axes. The part along its normal does nothing.
    pub tilt: Vec3,
}

impl RingVector {
    /// Sum of the products.
    pub fn dot(&self, other: &RingVector) -> f64 {
        self.major_radius * other.major_radius
            + self.minor_radius * other.minor_radius
            + self.offset.dot(&other.offset)
            + self.tilt.dot(&other.tilt)
    }

    /// Adds the multiple `factor` of `other`.
    pub(crate) fn add(&mut self, factor: f64, other: &RingVector) {
        self.major_radius += factor * other.major_radius;
        self.minor_radius += factor * other.minor_radius;
        self.offset += other.offset * factor;
        self.tilt += other.tilt * factor;
    }

    /// Its offset and its tilt mapped.
    pub(super) fn turned(&self, vector: impl Fn(&Vec3) -> Vec3, axial: impl Fn(&Vec3) -> Vec3) -> Self {
        RingVector { offset: vector(&self.offset), tilt: axial(&self.tilt), ..*self }
    }

    /// Lengths times `length`, the tilt times `angle`.
    pub(crate) fn times(&self, length: f64, angle: f64) -> RingVector {
        RingVector {
            major_radius: self.major_radius * length,
            minor_radius: self.minor_radius * length,
            offset: self.offset * length,
            tilt: self.tilt * angle,
        }
    }
}

impl DesignVector {
    /// Zeros for a design of so many rings.
    pub fn zeros(rings: usize) -> Self {
        DesignVector { lattice: [Vector2::zeros(); 2], rings: vec![RingVector::default(); rings] }
    }

    /// Sum of the products.
    pub fn dot(&self, other: &DesignVector) -> f64 {
        let lattice = self.lattice.iter().zip(&other.lattice).map(|(a, b)| a.dot(b)).sum::<f64>();
        lattice + self.rings.iter().zip(&other.rings).map(|(a, b)| a.dot(b)).sum::<f64>()
    }

    /// The design changed by `step` times this change, each ring with its own r. Centres of elements stay.
    ///
    /// # Panics
    /// For a change of a design with another number of rings.
    pub fn applied(&self, design: &Design, step: f64) -> Design {
        let mut out = design.clone();
        for (a, rate) in [&mut out.lattice.a1, &mut out.lattice.a2].into_iter().zip(&self.lattice) {
            (0..2).for_each(|k| a[k] += step * rate[k]);
        }
        let numbers = ring_numbers(design);
        assert_eq!(numbers.len(), self.rings.len(), "a change of a design with as many rings");
        let rings = out.elements.iter_mut().flat_map(|element| &mut element.rings);
        for ((ring, own), rate) in rings.zip(numbers).zip(&self.rings) {
            ring.major_radius += step * rate.major_radius;
            ring.minor_radius = Some(own.minor_radius + step * rate.minor_radius);
            ring.offset = (own.offset + rate.offset * step).into();
            ring.normal = (UnitQuaternion::from_scaled_axis(rate.tilt * step) * Vec3::from(ring.normal)).into();
        }
        out
    }

    /// Whether the two differ by at most `share` of this one.
    pub(super) fn is_close_to(&self, other: &DesignVector, share: f64) -> bool {
        let mut apart = self.clone();
        (0..2).for_each(|k| apart.lattice[k] -= other.lattice[k]);
        apart.rings.iter_mut().zip(&other.rings).for_each(|(ring, other)| ring.add(-1.0, other));
        apart.dot(&apart) <= share * share * self.dot(self)
    }

    /// What a symmetry of the design makes of a change of it: each ring's entries go to the ring that it goes to.
    pub(super) fn image(&self, image: &Image<'_>) -> Self {
        let mut out = Self::zeros(self.rings.len());
        for (ring, own) in self.rings.iter().enumerate() {
            let (there, _) = image.ring(ring, [0, 0]);
            out.rings[there] = own.turned(|v| image.vector(v), |v| image.axial(v));
        }
        let [a1, a2] = self.lattice.map(|a| a.push(0.0));
        out.lattice = image.lattice([&a1, &a2]).map(|a| a.xy());
        out
    }

    /// The wire: r of every ring that gives none, each by 1.
    pub fn common_minor_radius(design: &Design) -> Self {
        let rings = design.elements.iter().flat_map(|element| &element.rings);
        let of = |own: Option<f64>| RingVector {
            minor_radius: if own.is_none() { 1.0 } else { 0.0 },
            ..RingVector::default()
        };
        DesignVector { rings: rings.map(|ring| of(ring.minor_radius)).collect(), ..Self::zeros(0) }
    }

    /// The factor of [`Design::spaced`], by 1: the lattice vectors themselves.
    pub fn spacing(design: &Design) -> Self {
        let rings = design.elements.iter().map(|element| element.rings.len()).sum();
        let lattice = [design.lattice.a1, design.lattice.a2].map(|a| Vector2::new(a[0], a[1]));
        DesignVector { lattice, ..Self::zeros(rings) }
    }

    /// The factor of [`Design::scaled`], by 1: all lengths themselves.
    pub fn scale(design: &Design) -> Self {
        let of = |ring: RingNumbers| RingVector {
            major_radius: ring.major_radius,
            minor_radius: ring.minor_radius,
            offset: ring.offset,
            tilt: Vec3::zeros(),
        };
        DesignVector { rings: ring_numbers(design).into_iter().map(of).collect(), ..Self::spacing(design) }
    }

    /// Every entry times `factor`.
    pub(crate) fn times(&self, factor: f64) -> Self {
        let rings = self.rings.iter().map(|ring| ring.times(factor, factor)).collect();
        DesignVector { lattice: self.lattice.map(|a| a * factor), rings }
    }

    /// How the numbers of a design change with one that it is made from: from the designs with values beside `value`, and to one
    /// side where `make` refuses the other one. `None` where it refuses both.
    pub fn by_number(value: f64, make: &dyn Fn(f64) -> Option<Design>) -> Option<Self> {
        let half = HALF_STEP * value.abs().max(1.0);
        let at = |value: f64| Some((value, make(value)?));
        let (below, above) = (at(value - half), at(value + half));
        if below.is_none() && above.is_none() {
            return None;
        }
        let ((from, below), (to, above)) = (below.or_else(|| at(value))?, above.or_else(|| at(value))?);
        DesignVector::between(&below, &above, to - from).ok()
    }

    /// (`to` − `from`)/`step`: the rate of a family of designs from two members, `step` apart in its parameter. With the members
    /// at ± step/2 its error is of second order in the step. The tilt takes n from one normal to the other: n × dn.
    ///
    /// # Errors
    /// Where the designs have other numbers of elements or rings, a ring is turned by 90° or more, or the step is 0 or not finite.
    pub fn between(from: &Design, to: &Design, step: f64) -> Result<Self, InvalidInput> {
        if !step.is_finite() || step == 0.0 {
            return Err(InvalidInput::new("step", format!("{step} is no step"), "give a finite number other than 0"));
        }
        let counts = |design: &Design| design.elements.iter().map(|element| element.rings.len()).collect::<Vec<_>>();
        if counts(from) != counts(to) {
            let problem =
                format!("{:?} rings in the elements of one design, {:?} in the other", counts(from), counts(to));
            return Err(InvalidInput::new("elements", problem, "give two designs of the same elements and rings"));
        }
        let plane = |a: [f64; 3], b: [f64; 3]| Vector2::new(b[0] - a[0], b[1] - a[1]) / step;
        let lattice = [plane(from.lattice.a1, to.lattice.a1), plane(from.lattice.a2, to.lattice.a2)];
        let [before, after] = [from, to].map(ring_numbers);
        let half_turn = |(a, b): (&RingNumbers, &RingNumbers)| a.normal.dot(&b.normal) <= 0.0;
        if let Some(ring) = before.iter().zip(&after).position(half_turn) {
            let problem = format!("ring {ring} is turned by 90\u{b0} or more from one design to the other");
            return Err(InvalidInput::new("normal", problem, "give nearby designs, with normals of the same sign"));
        }
        let rate = |(a, b): (&RingNumbers, &RingNumbers)| RingVector {
            major_radius: (b.major_radius - a.major_radius) / step,
            minor_radius: (b.minor_radius - a.minor_radius) / step,
            offset: (b.offset - a.offset) / step,
            tilt: (a.normal + b.normal).normalize().cross(&(b.normal - a.normal)) / step,
        };
        Ok(DesignVector { lattice, rings: before.iter().zip(&after).map(rate).collect() })
    }
}

/// A ring as the file has it, with a normal of length 1.
struct RingNumbers {
    major_radius: f64,
    minor_radius: f64,
    offset: Vec3,
    normal: Vec3,
}

/// Of all rings, in the order of the file.
fn ring_numbers(design: &Design) -> Vec<RingNumbers> {
    let of = |ring: &RingSpec| RingNumbers {
        major_radius: ring.major_radius,
        minor_radius: ring.minor_radius.or(design.minor_radius).unwrap_or(0.0),
        offset: ring.offset.into(),
        normal: Vec3::from(ring.normal).normalize(),
    };
    design.elements.iter().flat_map(|element| &element.rings).map(of).collect()
}
