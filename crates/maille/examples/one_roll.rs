//! How tightly a design, built in or in a file, can be rolled along one direction, both ways, with its width held and left to it, in its
//! own cell; with the state.
//!
//!     cargo run --release -p maille --example one_roll -- [DESIGN] [DIRECTION_DEG]

use maille::{Across, Cell, Question, Sheet};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "european-4-in-1".into());
    let direction_deg: f64 = arguments.next().unwrap_or_else(|| "0".into()).parse()?;
    let text = match maille_io::builtin(&name) {
        Some(text) => text.to_owned(),
        None => std::fs::read_to_string(&name)?,
    };
    let design = maille_io::read_design(&name, &text)?;
    let sheet = Sheet::in_cells(&design, Cell::PRIMITIVE.into()).map_err(|p| format!("{name}: {}", p[0]))?;
    let free = Across { lateral_free: true, shear_free: true };
    for (across, words) in [(Across::HELD, "width and shear held"), (free, "width and shear free")] {
        for sign in [1.0, -1.0] {
            let begun = std::time::Instant::now();
            let answer = sheet.answer(&Question::curvature_along(direction_deg, sign).with_free(across))?;
            let (status, wall_s) = (answer.status.name(), begun.elapsed().as_secs_f64());
            let Some(curvature) = answer.value else {
                println!("{name} along {direction_deg}°, {words}: {status}");
                continue;
            };
            let model = sheet.model_of(&answer);
            println!("{name} along {direction_deg}°, {words}: {status}, cell {}, {wall_s:.2} s", answer.cell);
            println!(
                "  {curvature:.9} of a radian on a length of R: bent to a radius of {:.4} R",
                1.0 / curvature.abs()
            );
            if let Some(neutral) = answer.state.neutral_surface_of(&model) {
                println!(
                    "  neutral surface at {:.4} R from the axis, stretched {:.4} times",
                    neutral.radius, neutral.stretch
                );
            }
            let (starts, distinct) = (answer.n_starts.unwrap_or(0), answer.n_distinct.unwrap_or(0));
            println!("  {starts} starts led to {distinct} limits, with {} quadratic programs", answer.iterations);
            for trend in &answer.by_cell {
                println!("    {}", trend.label());
            }
            for (element, pose) in model.elements.iter().zip(&answer.state.poses) {
                let ring = &model.rings[element.rings.start];
                let (at, normal) = (pose.position, pose.rotation * ring.normal.into_inner());
                println!("    {:<12} at {:9.6?}, normal {:9.6?}", element.name, at.as_slice(), normal.as_slice());
            }
            for contact in &answer.contacts {
                println!("    {:?}: force {:.6}", contact.pair, contact.force);
            }
            if let Some(note) = &answer.note {
                println!("  {note}");
            }
        }
    }
    Ok(())
}
