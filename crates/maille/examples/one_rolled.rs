//! What closed tubes of a design, built in or in a file, have: gaps, radii and lengths.
//!
//!     cargo run --release -p maille --example one_rolled -- [DESIGN] [DIRECTION_DEG] [CELLS]

use maille::{
    Cell, Question, Sheet,
    question::{Goal, OfRolled, RollStrains, Sense, Turn},
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "european-4-in-1".into());
    let direction_deg: f64 = arguments.next().unwrap_or_else(|| "0".into()).parse()?;
    let cells: u32 = arguments.next().unwrap_or_else(|| "8".into()).parse()?;
    let design = maille_io::read_design(&name, maille_io::builtin(&name).ok_or("no such design")?)?;
    let sheet = Sheet::in_cells(&design, Cell::PRIMITIVE.into()).map_err(|p| format!("{name}: {}", p[0]))?;
    for (sought, sense) in [
        (OfRolled::Gap, Sense::Largest),
        (OfRolled::Radius, Sense::Least),
        (OfRolled::Radius, Sense::Largest),
        (OfRolled::Length, Sense::Least),
        (OfRolled::Length, Sense::Largest),
    ] {
        for above in [false, true] {
            let begun = std::time::Instant::now();
            let (turn, strains) = (Turn::Cells(cells), RollStrains::OF_TUBE);
            let goal = Goal::Rolled { direction_deg, above, turn, strains, sought };
            let answer =
                sheet.answer(&Question { effort: maille::question::Effort::Low, ..Question::new(goal, sense) })?;
            let radius = answer.state.neutral_surface_of(&sheet.model_of(&answer)).map(|n| n.radius);
            println!(
                "{sought:?} {sense:?} above {above}: {} {:?} radius {radius:?} gap {:?} starts {:?} distinct {:?} {:.3} s {:?}",
                answer.status.name(),
                answer.value,
                answer.gap,
                answer.n_starts,
                answer.n_distinct,
                begun.elapsed().as_secs_f64(),
                answer.note
            );
        }
    }
    Ok(())
}
