//! Images of a state's elements: rigid motions, which in a flat sheet are translations. The formulas of a rolled sheet are in
//! [`Roll`].

use super::{
    Pose, State,
    roll::{Carried, NeutralSurface, Roll, moments},
};
use crate::lattice::Shift;
use maille_geometry::{Circle, Vec3};
use nalgebra::{Matrix2, Unit, UnitQuaternion};

/// A rigid motion of a point: that of an image, which in a flat sheet is a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Its turn, of a rolled sheet.
    turn: Option<UnitQuaternion<f64>>,
    /// Where it takes the origin.
    translation: Vec3,
}

impl Image {
    /// The image of a point.
    pub fn point(&self, point: &Vec3) -> Vec3 {
        self.vector(point) + self.translation
    }

    /// The image of a difference of points.
    pub fn vector(&self, vector: &Vec3) -> Vec3 {
        self.turn.map_or(*vector, |turn| turn * vector)
    }

    /// The image of a pose.
    pub fn pose(&self, pose: &Pose) -> Pose {
        let turned = |turn: UnitQuaternion<f64>| UnitQuaternion::new_normalize((turn * pose.rotation).into_inner());
        Pose { position: self.point(&pose.position), rotation: self.turn.map_or(pose.rotation, turned) }
    }

    /// The image of a circle.
    pub fn circle(&self, circle: &Circle) -> Circle {
        let normal = self.turn.map_or(circle.normal, |turn| Unit::new_normalize(turn * circle.normal.into_inner()));
        Circle { center: self.point(&circle.center), normal, ..*circle }
    }

    /// The way from a point to the image of another.
    pub(crate) fn way(&self, from: &Vec3, to: &Vec3) -> Vec3 {
        self.vector(to) - from + self.translation
    }

    /// The way to a point from the image of another.
    pub(crate) fn way_from(&self, from: &Vec3, to: &Vec3) -> Vec3 {
        to - self.vector(from) - self.translation
    }

    /// The point whose image is `point`.
    pub fn back(&self, point: &Vec3) -> Vec3 {
        let from = point - self.translation;
        self.turn.map_or(from, |turn| turn.inverse() * from)
    }

    /// The pose whose image is `pose`.
    pub(crate) fn back_pose(&self, pose: &Pose) -> Pose {
        let back =
            |turn: UnitQuaternion<f64>| UnitQuaternion::new_normalize((turn.inverse() * pose.rotation).into_inner());
        Pose { position: self.back(&pose.position), rotation: self.turn.map_or(pose.rotation, back) }
    }

    /// This motion after the way back of `other`.
    pub(crate) fn after_back(&self, other: &Image) -> Image {
        let turn = self.turn.zip(other.turn).map(|(turn, back)| turn * back.inverse());
        let rest = Image { turn, translation: Vec3::zeros() };
        Image { turn, translation: self.translation - rest.vector(&other.translation) }
    }
}

/// Rigid motions of images.
impl State {
    /// The lattice vector with these coordinates.
    fn lattice_vector(&self, at: [f64; 2]) -> Vec3 {
        self.a1 * at[0] + self.a2 * at[1]
    }

    /// The motion to the place in the lattice with these coordinates.
    pub(crate) fn motion_to(&self, at: [f64; 2]) -> Image {
        let a = self.lattice_vector(at);
        match &self.roll {
            None => Image { turn: None, translation: a },
            Some(_) if at == [0.0; 2] => Image { turn: Some(UnitQuaternion::identity()), translation: a },
            Some(roll) => Self::screw(roll, at, a),
        }
    }

    /// The motion of a rolled sheet to the place with these coordinates, at `a` in its lattice. Apart, so that the translations of a
    /// flat sheet stay short code.
    #[inline(never)]
    fn screw(roll: &Roll, at: [f64; 2], a: Vec3) -> Image {
        let turn_rad = roll.turn(at);
        let [[_, _, _], [d0, d1, _]] = moments(turn_rad);
        let beside = -(roll.along * (turn_rad * (d0 - d1)) + Vec3::z() * d0);
        let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(roll.axis()), turn_rad);
        Image { turn: Some(turn), translation: a + beside * a.dot(&roll.along) }
    }

    /// The rigid motion from the main cell to the image `shift`.
    pub fn image(&self, shift: Shift) -> Image {
        self.motion_to(shift.map(f64::from))
    }

    /// Reference point of element `e` in the image `shift`.
    pub fn position(&self, e: usize, shift: Shift) -> Vec3 {
        match self.roll {
            None => self.poses[e].position + self.translation(shift),
            Some(_) => self.image(shift).point(&self.poses[e].position),
        }
    }

    /// The neutral surface of a rolled state, whose elements are anchored at `anchors` and whose reference lattice has this inverse; `None`
    /// where nothing turns.
    pub fn neutral_surface(&self, anchors: &[[f64; 2]], reference_inverse: &Matrix2<f64>) -> Option<NeutralSurface> {
        let away = anchors.iter().enumerate().map(|(e, anchor)| self.axis_distance(e, *anchor));
        let radius = away.sum::<Option<f64>>()? / self.poses.len() as f64;
        let stretch = self.roll?.curvature(reference_inverse).abs() * radius;
        Some(NeutralSurface { radius, stretch })
    }

    /// The z at which the axis lies; `None` where nothing turns.
    pub(crate) fn axis_height(&self, roll: &Roll) -> Option<f64> {
        let k = usize::from(roll.turn_rad[1].abs() > roll.turn_rad[0].abs());
        let turn = roll.turn_rad[k];
        // The axis goes through −(α/θ) e_z.
        (turn != 0.0).then(|| -[self.a1, self.a2][k].dot(&roll.along) / turn)
    }

    /// A rolled state turned about its axis and moved along it so that the first element lies over the origin; a flat one as it is.
    pub(crate) fn with_first_over_axis(mut self) -> Self {
        let Some((roll, height)) = self.roll.and_then(|roll| Some((roll, self.axis_height(&roll)?))) else {
            return self;
        };
        let (u, w) = (roll.along, roll.axis());
        let first = self.poses[0].position;
        // Towards the side of the axis on which the sheet is: above it where the axis is below.
        let side = if height > 0.0 { -1.0 } else { 1.0 };
        let angle = (side * first.dot(&u)).atan2(side * (first.z - height));
        let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(w), -angle);
        let axis = Vec3::z() * height;
        for pose in &mut self.poses {
            pose.position = axis + turn * (pose.position - axis) - w * first.dot(&w);
            pose.rotation = UnitQuaternion::new_normalize((turn * pose.rotation).into_inner());
        }
        self
    }

    /// Distance from the axis of element `e`, which is anchored at `anchor`; `None` where nothing turns.
    pub(crate) fn axis_distance(&self, e: usize, anchor: [f64; 2]) -> Option<f64> {
        let roll = self.roll?;
        let axis = Vec3::z() * self.axis_height(&roll)?;
        let own = self.motion_to(anchor).back(&self.poses[e].position);
        Some((own - axis).cross(&roll.axis()).norm())
    }

    /// Element `e`, which is anchored at `anchor`, in the image `shift`, as `roll` carries it.
    pub fn carried(&self, roll: &Roll, e: usize, anchor: [f64; 2], shift: Shift) -> Carried {
        let at = [0, 1].map(|k| f64::from(shift[k]) + anchor[k]);
        let own = self.motion_to(anchor).back(&self.poses[e].position);
        let here = self.motion_to(at);
        let (axis, turn_rad) = (roll.axis(), roll.turn(at));
        let [[_, c1, c2], [d0, d1, d2]] = moments(turn_rad);
        let beside = -(roll.along * (turn_rad * (d0 - d1)) + Vec3::z() * d0);
        let first = -(roll.along * d1 + Vec3::z() * c1);
        let second = Vec3::z() * d2 - roll.along * c2;
        Carried {
            position: here.point(&own),
            along: roll.along,
            axis,
            cell: UnitQuaternion::from_axis_angle(&Unit::new_unchecked(axis), roll.turn(shift.map(f64::from))),
            length: self.lattice_vector(at).dot(&roll.along),
            arm: here.vector(&own),
            moments: [beside, first, second],
        }
    }
}
