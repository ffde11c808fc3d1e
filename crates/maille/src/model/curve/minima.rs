//! All local minima of the distance of two curves.
//!
//! A minimum of the distance of two pieces is one of the curves, unless it lies at an end from which the distance falls into the piece that
//! follows. Pairs of runs of pieces are ruled out by their balls, and by their tangents: at a minimum the way between the
//! curves stands across both tangents, or, at a corner, across a direction between the two.

use super::{Core, Curve, CurvePoint, tree::Node};
use crate::state::Pose;
use maille_geometry::{Piece, PieceMinimum, Place, Vec3, circle_distance_lower_bound, piece_distance_minima};

/// A local minimum of the distance of two core curves.
#[derive(Clone, Copy, Debug)]
pub struct CurveMinimum {
    /// The distance.
    pub distance: f64,
    /// The point on A.
    pub a: CurvePoint,
    /// The point on B.
    pub b: CurvePoint,
}

/// Slopes below this count as none, and points nearer than this as one, in units of the reference radius.
const SAME: f64 = 1e-9;

/// Two curves, the second in the frame of the first.
struct Pair<'a> {
    a: &'a Curve,
    b: &'a Curve,
    /// From the frame of b to that of a.
    motion: Pose,
    /// Whether all pieces count, or those that belong to the curves.
    all: bool,
    /// Minima up to this distance are wanted, and the least one.
    far: f64,
    least: f64,
    found: Vec<CurveMinimum>,
}

/// All local minima of the distance of two core curves up to `far`, and the least one in any case; ascending. None of curves that are not finite.
pub fn curve_distance_minima(a: &Core, b: &Core, far: f64) -> Vec<CurveMinimum> {
    minima(a, b, far, true)
}

/// The same between what belongs to the curves: what two curves of a frame share counts on one.
pub(crate) fn owned_distance_minima(a: &Core, b: &Core, far: f64) -> Vec<CurveMinimum> {
    minima(a, b, far, false)
}

fn minima(a: &Core, b: &Core, far: f64, all: bool) -> Vec<CurveMinimum> {
    let ((own, at_a), (other, at_b)) = (a.curve(), b.curve());
    let motion = relative(&at_a, &at_b);
    let mut pair = Pair { a: &own, b: &other, motion, all, far, least: f64::INFINITY, found: Vec::new() };
    pair.visit(0, 0, &pair.moved(0));
    let mut out = pair.found;
    // A distance that is computed anew differs in its last digit.
    let most = far.max(pair.least) * (1.0 + SAME);
    out.retain(|m| m.distance <= most);
    out.sort_by(|x, y| x.distance.total_cmp(&y.distance));
    out.into_iter().map(|m| CurveMinimum { a: m.a.moved(&at_a), b: m.b.moved(&at_a), ..m }).collect()
}

/// The least distance of two core curves; NaN of such that are not finite.
pub(crate) fn curve_distance(a: &Core, b: &Core) -> f64 {
    curve_distance_minima(a, b, 0.0).first().map_or(f64::NAN, |minimum| minimum.distance)
}

/// The pose of b in the frame of a.
fn relative(a: &Pose, b: &Pose) -> Pose {
    let back = a.rotation.inverse();
    Pose { position: back * (b.position - a.position), rotation: back * b.rotation }
}

/// A lower bound of the distance of two core curves.
pub(crate) fn distance_lower_bound(a: &Core, b: &Core) -> f64 {
    if let (Core::Circle(a), Core::Circle(b)) = (a, b) {
        return circle_distance_lower_bound(a, b);
    }
    let ((own, at_a), (other, at_b)) = (a.curve(), b.curve());
    let motion = relative(&at_a, &at_b);
    apart(&own.nodes[0], &moved(&motion, &other.nodes[0]))
}

/// Least distance of the balls of two nodes.
fn apart(a: &Node, b: &Node) -> f64 {
    ((a.center - b.center).norm() - a.radius - b.radius).max(0.0)
}

fn moved(motion: &Pose, node: &Node) -> Node {
    Node { center: motion.rotation * node.center + motion.position, axis: motion.rotation * node.axis, ..*node }
}

impl Pair<'_> {
    /// Node `k` of b in the frame of a.
    fn moved(&self, k: usize) -> Node {
        moved(&self.motion, &self.b.nodes[k])
    }

    /// Looks for minima between node `i` of a and node `j` of b, which stands at `there`.
    fn visit(&mut self, i: usize, j: usize, there: &Node) {
        let here = self.a.nodes[i];
        if apart(&here, there) > self.far.max(self.least) || !may_be_across(&here, there) {
            return;
        }
        if here.is_leaf() && there.is_leaf() {
            self.look(here.first, there.first);
        } else if there.is_leaf() || !here.is_leaf() && here.radius >= there.radius {
            let mut halves = [i + 1, here.second];
            let away = |k: &usize| apart(&self.a.nodes[*k], there);
            halves.sort_by(|x, y| away(x).total_cmp(&away(y)));
            halves.into_iter().for_each(|half| self.visit(half, j, there));
        } else {
            let mut halves = [j + 1, there.second].map(|k| (k, self.moved(k)));
            halves.sort_by(|x, y| apart(&here, &x.1).total_cmp(&apart(&here, &y.1)));
            halves.iter().for_each(|(half, node)| self.visit(i, *half, node));
        }
    }

    /// The minima between piece `i` of a and piece `j` of b.
    fn look(&mut self, i: usize, j: usize) {
        if !(self.all || self.a.owned[i].any() && self.b.owned[j].any()) {
            return;
        }
        if !self.a.middles[i].may_be_level(&self.b.middles[j].moved(&self.motion)) {
            return;
        }
        let (b, motion) = (self.b, self.motion);
        let of_b = |k: usize| b.pieces[k].moved(&motion.rotation, &motion.position);
        let (own, other) = (self.a.pieces[i], of_b(j));
        for m in piece_distance_minima(&own, &other).as_slice() {
            if m.distance > self.far.max(self.least) {
                break;
            }
            let owned = self.a.owned[i].at(m.place_a) && self.b.owned[j].at(m.place_b);
            if !(self.all || owned) {
                continue;
            }
            let way = m.point_b - m.point_a;
            let n = self.b.pieces.len();
            let on_a = match m.place_a {
                Place::Inside => None,
                Place::Start => self.a.pieces[(i + self.a.pieces.len() - 1) % self.a.pieces.len()].inward(Place::End),
                Place::End => self.a.pieces[(i + 1) % self.a.pieces.len()].inward(Place::Start),
            };
            let on_b = match m.place_b {
                Place::Inside => None,
                Place::Start => of_b((j + n - 1) % n).inward(Place::End),
                Place::End => of_b((j + 1) % n).inward(Place::Start),
            };
            if on_a.is_none_or(|inward| -inward.dot(&way) >= -SAME)
                && on_b.is_none_or(|inward| inward.dot(&way) >= -SAME)
            {
                let new = self.minimum((i, &own), (j, &other), m);
                self.least = self.least.min(new.distance);
                self.add(new);
            }
        }
    }

    /// The minimum in the frame of a.
    fn minimum(&self, (i, of_a): (usize, &Piece), (j, of_b): (usize, &Piece), m: &PieceMinimum) -> CurveMinimum {
        let t = |piece: &Piece, place: Place, point: &Vec3| match place {
            Place::Start => 0.0,
            Place::End => 1.0,
            Place::Inside => piece.nearest(point),
        };
        let mut a = self.a.at(i, t(of_a, m.place_a, &m.point_a));
        let mut b = self.b.at(j, t(of_b, m.place_b, &m.point_b));
        // Where pieces meet the second derivative jumps. The larger one along the curve keeps the contact nearer to where it is: no motion
        // then raises the distance by more than is counted.
        let way = m.point_b - m.point_a;
        if let Some(other) = self.a.beyond(i, m.place_a).filter(|other| (other - a.curvature).dot(&way) < 0.0) {
            a.curvature = other;
        }
        let back = self.motion.rotation.inverse() * way;
        if let Some(other) = self.b.beyond(j, m.place_b).filter(|other| (other - b.curvature).dot(&back) > 0.0) {
            b.curvature = other;
        }
        let b = b.moved(&self.motion);
        CurveMinimum { distance: (a.point - b.point).norm(), a, b }
    }

    /// Adds a minimum; one that is found on two pieces is kept once, as the nearer.
    fn add(&mut self, new: CurveMinimum) {
        let near = |x: &CurvePoint, y: &CurvePoint| (x.point - y.point).norm() < SAME;
        match self.found.iter_mut().find(|m| near(&m.a, &new.a) && near(&m.b, &new.b)) {
            None => self.found.push(new),
            Some(known) if new.distance < known.distance => *known = new,
            Some(_) => {}
        }
    }
}

/// Whether the way between points of two nodes may stand across a tangent of each.
fn may_be_across(a: &Node, b: &Node) -> bool {
    let way = b.center - a.center;
    let (apart, reach) = (way.norm(), a.radius + b.radius);
    if apart <= reach {
        return true;
    }
    let (e, sin) = (way / apart, reach / apart);
    let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
    a.may_be_across(&e, sin, cos) && b.may_be_across(&e, sin, cos)
}
