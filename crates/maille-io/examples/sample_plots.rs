//! Draws plots of made-up limits into a folder: `cargo run -p maille-io --example sample_plots -- FOLDER`.
//!
//! The limits are the chain bound of a square grid, with two directions left out.

#[path = "../tests/it/common/rows.rs"]
#[expect(dead_code, reason = "it uses a part")]
mod rows;

use maille::record::{LimitRow, Status};
use maille_io::{
    Quantity,
    plot::{Curve, CurveKind, Layout, PolarPlot, polar_svg},
};
use maille_svg::svg_to_png;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder")?;
    let mut design = rows::design();
    let few = [-0.25, -0.125, 0.0];
    let many = [-0.375, -0.25, -0.125, 0.0, 0.125, 0.25];
    let parameters = ["protocol strain".to_owned(), "τ = 0.005".to_owned(), "step 0.02".to_owned()];
    for (name, l2, quantity, step) in [
        ("default", &few[..], Quantity::Stretch, 15.0),
        ("many", &many[..], Quantity::Lambda1, 15.0),
        ("one", &few[2..], Quantity::L1, 5.0),
        ("negative", &[0.0, 0.4, 0.5, 0.55][..], Quantity::L1, 7.5),
        ("quarter", &few[..], Quantity::Stretch, 10.0),
    ] {
        let mut rows = limits(l2, step);
        if name == "default" {
            for row in rows
                .iter_mut()
                .filter(|row| row.l2 == -0.25 && (row.direction_deg == 30.0 || row.direction_deg == 45.0))
            {
                (row.l1, row.lambda1, row.status) = (None, None, Status::NotConverged);
            }
        }
        if name == "quarter" {
            rows.retain(|row| row.direction_deg <= 90.0);
            design.title = "A rather long title of a sheet whose maker did not know when to stop describing it".into();
            design.unit = Some("mm".into());
        }
        let mut plot = PolarPlot::from_rows(&design, &rows, quantity, &parameters);
        if name == "one" {
            let bound = |d: f64| (d, bound(d, 0.0).map(|b| b + 0.03), Status::Local);
            let dense: Vec<_> = (0..180).map(|d| bound(f64::from(d))).collect();
            plot.curves.push(Curve::new(0, 0.0, CurveKind::Bound, &dense));
        }
        let svg = polar_svg(&plot, Layout::Beside);
        std::fs::write(Path::new(&folder).join(format!("{name}.svg")), &svg)?;
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), svg_to_png(&svg, 2.0)?)?;
        std::fs::write(Path::new(&folder).join(format!("{name}-small.png")), svg_to_png(&svg, 0.35)?)?;
    }
    Ok(())
}

fn limits(l2: &[f64], step: f64) -> Vec<LimitRow> {
    let directions = (0..).map(|i| step * f64::from(i)).take_while(|d| *d <= 180.0);
    let all = directions.flat_map(|d| l2.iter().map(move |&l2| (d, l2)));
    all.map(|(direction_deg, l2)| rows::row(direction_deg, l2, bound(direction_deg, l2))).collect()
}

/// No chain of links from a ring to its image at `v` can be longer than `length`.
fn bound(direction_deg: f64, l2: f64) -> Option<f64> {
    let (sin, cos) = direction_deg.to_radians().sin_cos();
    let mut l1 = f64::INFINITY;
    for (v, length) in [([2.5, 0.0], 3.6), ([0.0, 2.5], 3.6), ([2.5, 2.5], 7.2), ([2.5, -2.5], 7.2)] {
        let [x, y]: [f64; 2] = v;
        let along = (x * cos + y * sin).abs();
        let across = (1.0 + l2) * (y * cos - x * sin);
        let left: f64 = length * length - across * across;
        if left < 0.0 {
            return None;
        }
        if along > 1e-9 {
            l1 = l1.min(left.sqrt() / along - 1.0);
        }
    }
    Some(l1)
}
