//! The polar plot of rolls: R/ρ along each direction, ρ the radius of the neutral surface, for both sides of the axis.

use super::figure::Disc;
use crate::{
    plot::{
        compare::heading,
        curve::{Curve, CurveKind},
        frame::{Entry, Frame, Layout},
        look::{self, Look},
        outcome::Outcome,
        scale::Scale,
    },
    roll::{Axis, Roll},
};
use maille::design::Design;

/// The rolls of a design as SVG.
pub fn roll_svg(design: &Design, rolls: &[Roll], layout: Layout) -> String {
    let bend = |roll: &Roll| roll.neutral_radius.map(|radius| design.reference_radius / radius);
    let curve = |(k, axis): (usize, Axis)| {
        let of_axis = rolls.iter().filter(|roll| roll.axis == axis);
        let points: Vec<_> = of_axis.map(|roll| (roll.direction_deg, bend(roll), roll.status)).collect();
        (!points.is_empty()).then(|| (axis, Curve::new(k, 0.0, CurveKind::Limits, &points)))
    };
    let (axes, curves): (Vec<Axis>, Vec<Curve>) = Axis::BOTH.into_iter().enumerate().filter_map(curve).unzip();
    let looks = look::of_records(Axis::BOTH.len());
    let look = |curve: &Curve| &looks[curve.record];
    let scale = Scale::new(0.0, curves.iter().flat_map(Curve::values), 6);
    let statuses = curves.iter().flat_map(Curve::turn).map(|(_, value, status)| (value, status));
    let mut legend = vec![Entry::Heading("Axis of the roll".into())];
    let sample = |(axis, curve): (&Axis, &Curve)| Entry::sample(look(curve), true, true, &words(*axis));
    legend.extend(axes.iter().zip(&curves).map(sample));
    legend.extend(Outcome::legend(statuses, true));
    legend.push(Entry::Heading("Radius: R/ρ".into()));
    legend.push(Entry::Note("centre 0: flat".into()));
    let frame = Frame {
        title: heading(design),
        subtitle: "Largest curvature along each direction, before rings lock".into(),
        legend,
        caption: caption(design, rolls),
    };
    let disc = Disc::new(frame.area(layout), scale);
    frame.svg(layout, disc.center[1] + disc.radius + 22.0, |canvas| {
        disc.draw_grid(canvas, 0.0);
        curves.iter().for_each(|curve| disc.draw_line(canvas, curve, look(curve)));
        disc.draw_ticks(canvas, &curves);
        for (k, curve) in curves.iter().enumerate() {
            let look: &Look = look(curve);
            disc.draw_markers(canvas, curve, look, curves.len());
            disc.draw_gaps(canvas, curve, look, k);
        }
    })
}

fn words(axis: Axis) -> String {
    format!("{} the sheet", axis.name())
}

fn held(word: &str) -> &str {
    if word == "fixed" { "held" } else { word }
}

/// What the plot is of, and its tightest roll each way.
fn caption(design: &Design, rolls: &[Roll]) -> Vec<String> {
    let unit = design.unit.as_deref().map_or(String::new(), |unit| format!(" {unit}"));
    let held = rolls.first().map(|roll| format!("Width {}, shear {}.", held(&roll.lateral), held(&roll.shear)));
    let tightest = |axis: Axis| {
        let of_axis = rolls.iter().filter(|roll| roll.axis == axis && roll.is_certified());
        let radii = of_axis.filter_map(|roll| Some((roll.neutral_radius?, roll.direction_deg)));
        let (radius, direction_deg) = radii.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!("Axis {}: tightest along {direction_deg}°, ρ = {radius:.4}{unit}.", words(axis)))
    };
    let gauge = format!(
        "ρ: radius of the neutral surface, at the mean distance of the elements from the axis; R = {}{unit}. No bound is known: \
         that no state bends further is not proved. Opposite directions are one roll.",
        design.reference_radius
    );
    held.into_iter().chain(Axis::BOTH.into_iter().filter_map(tightest)).chain([gauge]).collect()
}
