//! One limit of a built-in design: how far it stretches, what proves it, and which contacts carry the load.
//!
//!     cargo run --release -p maille --example one_limit -- [DESIGN] [DIRECTION_DEG]

use maille::{Question, Sheet};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "1.1".into());
    let direction_deg: f64 = arguments.next().unwrap_or_else(|| "30".into()).parse()?;
    let text = maille_io::builtin(&name).ok_or_else(|| format!("there is no built-in design {name}"))?;
    let sheet = Sheet::compile(&maille_io::read_design(&name, text)?).map_err(|p| format!("{name}: {}", p[0]))?;

    let answer = sheet.answer(&Question::stretch_along(direction_deg))?;
    println!("{name} along {direction_deg}°: {}", answer.status.name());
    if let Some(l1) = answer.limit() {
        println!("  stretches by {:.4} %, l1 = {l1:.9}", 100.0 * l1);
    }
    if let Some(bound) = answer.bound {
        println!("  proven bound of l1: {bound:.9}");
    }
    let model = sheet.model_of(&answer);
    for contact in &answer.contacts {
        let [a, b] =
            [contact.pair.ring_a, contact.pair.ring_b].map(|ring| &model.elements[model.rings[ring].element].name);
        println!("  {a} presses on {b}: force {:.4} per unit of pull", contact.force);
    }

    // The same with the width and the shear left to the sheet.
    let free = maille::Across { lateral_free: true, shear_free: true };
    let answer = sheet.answer(&Question::stretch_along(direction_deg).with_free(free))?;
    println!("  width and shear free: {}, l1 = {:?}", answer.status.name(), answer.limit());
    Ok(())
}
