//! Straight segments and circular arcs.

use crate::circle::{Circle, Vec3};
use nalgebra::{UnitQuaternion, UnitVector3};
use std::f64::consts::PI;

/// Points are on the axis of a circle if they are nearer to it than this part of the radius and their distance from the centre.
const ON_AXIS: f64 = 1e-15;

/// A straight segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    start: Vec3,
    end: Vec3,
    along: UnitVector3<f64>,
    length: f64,
}

impl Segment {
    /// The segment between two points, or none if they are one, or not finite.
    pub fn new(start: Vec3, end: Vec3) -> Option<Self> {
        let length = (end - start).norm();
        (length > 0.0 && length.is_finite()).then(|| {
            let along = UnitVector3::new_unchecked((end - start) / length);
            Self { start, end, along, length }
        })
    }

    /// The unit vector from the start to the end.
    pub fn along(&self) -> UnitVector3<f64> {
        self.along
    }
}

/// An arc of a circle, or the whole circle.
///
/// It runs counter-clockwise, seen from the side to which the circle's normal points. Its points are accurate to about
/// `1e-16` of the *radius*: an arc that is nearly straight loses digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    circle: Circle,
    /// Unit vector from the centre to the middle of the arc.
    middle: Vec3,
    /// Half of the angle, at most π, with its cosine and sine.
    half_angle_rad: f64,
    half_cos: f64,
    half_sin: f64,
}

impl Arc {
    /// The arc that starts at an angle of the circle's [frame](Circle::frame) and goes on by `sweep_rad`; the whole
    /// circle if that is 2π or more. None if the sweep is not positive.
    pub fn new(circle: Circle, start_rad: f64, sweep_rad: f64) -> Option<Self> {
        let half_angle_rad = (0.5 * sweep_rad).min(PI);
        (sweep_rad > 0.0 && start_rad.is_finite()).then(|| {
            let (u, v) = circle.frame();
            let (sin, cos) = (start_rad + half_angle_rad).sin_cos();
            let (half_sin, half_cos) = half_angle_rad.sin_cos();
            Self { circle, middle: u * cos + v * sin, half_angle_rad, half_cos, half_sin }
        })
    }

    /// The arc from `start` to `end` that leaves `start` along `tangent`. None if the points are one, if `tangent` is
    /// zero, or if it points along the line through them: then no circle does this.
    pub fn from_tangent(start: Vec3, tangent: Vec3, end: Vec3) -> Option<Self> {
        // Squares of tiny numbers have few digits: the largest is made 1 first.
        let (chord, tangent) = (end - start, (tangent / tangent.amax()).try_normalize(0.0)?);
        // The chord makes half of the arc's angle with the tangent.
        let normal = UnitVector3::try_new(tangent.cross(&chord), 0.0)?;
        let inward = normal.cross(&tangent);
        let (ahead, aside) = (chord.dot(&tangent), chord.dot(&inward));
        let radius = chord.norm_squared() / (2.0 * aside);
        if !radius.is_finite() {
            return None;
        }
        let half_angle_rad = aside.atan2(ahead);
        let (half_sin, half_cos) = half_angle_rad.sin_cos();
        let middle = tangent * half_sin - inward * half_cos;
        let circle = Circle { center: start + inward * radius, normal, radius };
        Some(Self { circle, middle, half_angle_rad, half_cos, half_sin })
    }

    /// The circle on which it lies.
    pub fn circle(&self) -> &Circle {
        &self.circle
    }

    /// Its angle, at most 2π.
    pub fn sweep_rad(&self) -> f64 {
        2.0 * self.half_angle_rad
    }

    /// Whether it is the whole circle.
    pub fn is_closed(&self) -> bool {
        self.half_angle_rad == PI
    }

    /// Unit vector in its plane, a quarter turn on from the middle.
    fn aside(&self) -> Vec3 {
        self.circle.normal.cross(&self.middle)
    }
}

/// A piece of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A straight one.
    Segment(Segment),
    /// A circular one, or a whole circle.
    Arc(Arc),
}

/// Where on a piece a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Between its ends, or anywhere on a whole circle.
    Inside,
    /// At its start.
    Start,
    /// At its end.
    End,
}

impl Piece {
    /// The whole circle.
    pub fn circle(circle: Circle) -> Self {
        let middle = circle.frame().0;
        Piece::Arc(Arc { circle, middle, half_angle_rad: PI, half_cos: -1.0, half_sin: 0.0 })
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        match self {
            Piece::Segment(segment) => segment.length,
            Piece::Arc(arc) => arc.circle.radius * arc.sweep_rad(),
        }
    }

    /// The point at `t`, from 0 at the start to 1 at the end.
    pub fn point(&self, t: f64) -> Vec3 {
        match self {
            Piece::Segment(segment) => segment.start + (segment.end - segment.start) * t,
            Piece::Arc(arc) => {
                let (sin, cos) = (arc.half_angle_rad * (2.0 * t - 1.0)).sin_cos();
                arc.circle.center + (arc.middle * cos + arc.aside() * sin) * arc.circle.radius
            }
        }
    }

    /// The unit tangent at `t`, in the direction in which it runs.
    pub fn tangent(&self, t: f64) -> Vec3 {
        match self {
            Piece::Segment(segment) => *segment.along,
            Piece::Arc(arc) => {
                let (sin, cos) = (arc.half_angle_rad * (2.0 * t - 1.0)).sin_cos();
                arc.aside() * cos - arc.middle * sin
            }
        }
    }

    /// The derivative of the unit tangent by arc length at `t`: towards the centre, 1/R long, and zero on a segment.
    pub fn curvature(&self, t: f64) -> Vec3 {
        match self {
            Piece::Segment(_) => Vec3::zeros(),
            Piece::Arc(arc) => {
                let (sin, cos) = (arc.half_angle_rad * (2.0 * t - 1.0)).sin_cos();
                -(arc.middle * cos + arc.aside() * sin) / arc.circle.radius
            }
        }
    }

    /// The `t` of its point that is nearest to `p`: 0 or 1 at an end.
    ///
    /// # Examples
    ///
    /// ```
    /// use maille_geometry::{Circle, Piece, Vec3};
    ///
    /// let ring = Piece::circle(Circle::new(Vec3::zeros(), Vec3::z_axis(), 1.0));
    /// let p = ring.point(0.3);
    /// assert!((ring.nearest(&(p * 2.0 + Vec3::z())) - 0.3).abs() < 1e-15);
    /// ```
    pub fn nearest(&self, p: &Vec3) -> f64 {
        match self {
            Piece::Segment(segment) => ((p - segment.start).dot(&segment.along) / segment.length).clamp(0.0, 1.0),
            Piece::Arc(arc) => {
                let delta = p - arc.circle.center;
                let angle_rad = delta.dot(&arc.aside()).atan2(delta.dot(&arc.middle));
                (0.5 + 0.5 * angle_rad / arc.half_angle_rad).clamp(0.0, 1.0)
            }
        }
    }

    /// The `t` of its point that is farthest from `p`.
    pub fn farthest(&self, p: &Vec3) -> f64 {
        let end = if (self.point(0.0) - p).norm_squared() > (self.point(1.0) - p).norm_squared() { 0.0 } else { 1.0 };
        match self {
            Piece::Segment(_) => end,
            Piece::Arc(arc) => {
                // Across the centre, if the arc reaches there.
                let delta = arc.circle.center - p;
                let angle_rad = delta.dot(&arc.aside()).atan2(delta.dot(&arc.middle));
                if angle_rad.abs() < arc.half_angle_rad { 0.5 + 0.5 * angle_rad / arc.half_angle_rad } else { end }
            }
        }
    }

    /// The largest coordinate of its points along the unit vector `axis`.
    pub fn support(&self, axis: &Vec3) -> f64 {
        let ends = self.point(0.0).dot(axis).max(self.point(1.0).dot(axis));
        match self {
            Piece::Segment(_) => ends,
            Piece::Arc(arc) => {
                let (ahead, aside) = (axis.dot(&arc.middle), axis.dot(&arc.aside()));
                if aside.atan2(ahead).abs() < arc.half_angle_rad {
                    arc.circle.center.dot(axis) + arc.circle.radius * ahead.hypot(aside)
                } else {
                    ends
                }
            }
        }
    }

    /// The piece turned by `rotation` about the origin, and then moved by `translation`.
    pub fn moved(&self, rotation: &UnitQuaternion<f64>, translation: &Vec3) -> Self {
        let point = |p: &Vec3| rotation * p + translation;
        let unit = |v: &UnitVector3<f64>| UnitVector3::new_normalize(rotation * v.into_inner());
        match self {
            Piece::Segment(segment) => Piece::Segment(Segment {
                start: point(&segment.start),
                end: point(&segment.end),
                along: unit(&segment.along),
                length: segment.length,
            }),
            Piece::Arc(arc) => {
                let circle =
                    Circle { center: point(&arc.circle.center), normal: unit(&arc.circle.normal), ..arc.circle };
                // Across the normal to the last digit.
                let middle = rotation * arc.middle;
                let middle = (middle - *circle.normal * circle.normal.dot(&middle)).normalize();
                Piece::Arc(Arc { circle, middle, ..*arc })
            }
        }
    }

    /// The same points, run through the other way.
    pub fn reversed(&self) -> Self {
        match self {
            Piece::Segment(segment) => Piece::Segment(Segment {
                start: segment.end,
                end: segment.start,
                along: -segment.along,
                length: segment.length,
            }),
            Piece::Arc(arc) => Piece::Arc(Arc { circle: Circle { normal: -arc.circle.normal, ..arc.circle }, ..*arc }),
        }
    }

    /// Its unit tangent at an end, into the piece.
    pub fn inward(&self, end: Place) -> Option<Vec3> {
        self.ends()?.into_iter().find(|(place, ..)| *place == end).map(|(.., inward)| inward)
    }

    /// Start and end with the unit tangents that point into the piece; none for a whole circle.
    pub(super) fn ends(&self) -> Option<[(Place, Vec3, Vec3); 2]> {
        match self {
            Piece::Segment(segment) => {
                let along = *segment.along;
                Some([(Place::Start, segment.start, along), (Place::End, segment.end, -along)])
            }
            Piece::Arc(arc) if arc.is_closed() => None,
            Piece::Arc(arc) => {
                let (middle, aside, radius) = (arc.middle, arc.aside(), arc.circle.radius);
                let (cos, sin) = (arc.half_cos, arc.half_sin);
                let end = |sign: f64| arc.circle.center + (middle * cos + aside * (sign * sin)) * radius;
                let inward = |sign: f64| middle * sin - aside * (sign * cos);
                Some([(Place::Start, end(-1.0), inward(-1.0)), (Place::End, end(1.0), inward(1.0))])
            }
        }
    }

    /// The point nearest to `p` on the whole line or circle, if it lies between the ends. From the axis of the circle,
    /// where all are equally near, it is the middle of the arc.
    pub(super) fn foot(&self, p: &Vec3) -> Option<Vec3> {
        match self {
            Piece::Segment(segment) => {
                let t = (p - segment.start).dot(&segment.along);
                (t > 0.0 && t < segment.length).then(|| segment.start + *segment.along * t)
            }
            Piece::Arc(arc) => {
                let (delta, normal) = (p - arc.circle.center, *arc.circle.normal);
                let flat = delta - normal * normal.dot(&delta);
                // Near the axis what rounding leaves across the plane counts: once more.
                let flat = flat - normal * normal.dot(&flat);
                let near = ON_AXIS * (delta.norm() + arc.circle.radius);
                let direction = flat.try_normalize(near).unwrap_or(arc.middle);
                // sin(half angle − angle): a cosine does not tell small angles.
                let (ahead, aside) = (direction.dot(&arc.middle), direction.dot(&arc.aside()));
                let inside = arc.is_closed() || arc.half_sin * ahead > arc.half_cos * aside.abs();
                inside.then(|| arc.circle.center + direction * arc.circle.radius)
            }
        }
    }

    /// A point of the piece, and its size: the longer of length and radius.
    pub(super) fn extent(&self) -> (Vec3, f64) {
        match self {
            Piece::Segment(segment) => (segment.start, segment.length),
            Piece::Arc(arc) => (arc.circle.center, arc.circle.radius),
        }
    }
}
