//! The program of which an answer is the solution: its family of lattices, and the parameters there.

use super::{
    multistart::Target,
    room::{Room, Sought},
    stretch::Stretch,
};
use crate::{
    answer::Answer,
    lattice::Direction,
    model::Model,
    program::LatticeFamily,
    question::{Goal, Question},
};
use maille_design::InvalidInput;

/// The family of lattices in which the first parameter was maximised, and all parameters in the state of `answer`.
///
/// # Errors
/// Where no lattice has the strains that the question holds; for the area of a closest cell.
pub(crate) fn family_at(
    model: &Model,
    question: &Question,
    answer: &Answer,
) -> Result<(LatticeFamily, Vec<f64>), InvalidInput> {
    let (f, sign, value) = (answer.gradient, question.sense.sign(), answer.value.unwrap_or(f64::NAN));
    let lattice_free = match question.goal {
        Goal::Stretch { direction_deg, l2, across } => {
            let direction = Direction::of_degrees(direction_deg);
            let stretch = Stretch { direction, l2, across, sign };
            let (d, side) = (direction.along(), direction.across());
            let lateral = across.lateral_free.then(|| side.dot(&(f * side)) - 1.0);
            let shear = across.shear_free.then(|| d.dot(&(f * side)));
            let along = sign * (d.dot(&(f * d)) - 1.0);
            return Ok((stretch.family(model), [Some(along), lateral, shear].into_iter().flatten().collect()));
        }
        Goal::Strain { .. } | Goal::Ray { .. } => {
            let Some(query) = question.strain_query()? else { unreachable!("a strain or a ray is asked for") };
            let strain = answer.green_strain() - query.held;
            let p = query.free.iter().map(|rate| strain.dot(rate) / rate.norm_squared()).collect();
            return Ok((query.family(model), p));
        }
        Goal::Wire { lattice_free } | Goal::Clearance { lattice_free } => lattice_free,
        Goal::Area { .. } | Goal::Curvature { .. } | Goal::Rolled { .. } => {
            let help = "ask for a stretch, a strain, the thickest wire or the largest clearance";
            let what = if matches!(question.goal, Goal::Area { .. }) { "the area of a closest cell" } else { "a roll" };
            return Err(InvalidInput::new("goal", format!("{what} has no derivatives yet"), help));
        }
    };
    let wire = matches!(question.goal, Goal::Wire { .. });
    let what = if wire { Room::Wire } else { Room::Clearance };
    let mut p = vec![if wire { value - 1.0 } else { value }];
    if lattice_free {
        let [first, second] = [answer.state.a1 - model.start.a1, answer.state.a2 - model.start.a2];
        p.extend([first.dot(&model.start.a1.normalize()), second.x, second.y]);
    }
    Ok((Sought { what, lattice_free }.family(model), p))
}
