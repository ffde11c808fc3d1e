//! The summary of a record: least and largest limit of each l2, what has no limit, and where the files are.

use crate::output::{self, counted};
use maille::record::{LimitRow, Status};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::Duration,
};

/// What `characterize` says at its end; docs/json.md describes the keys.
#[derive(Serialize)]
pub struct Summary {
    design: String,
    record: PathBuf,
    lateral_free: bool,
    limits: Vec<OfL2>,
    statuses: BTreeMap<&'static str, usize>,
    images: usize,
    between: usize,
    grows_with_cell: usize,
    below_bound: Option<f64>,
    better_chance: Option<f64>,
    unstable_waves: usize,
    solved: usize,
    wall_s: f64,
    interrupted: bool,
}

/// Limits of one l2.
#[derive(Serialize)]
struct OfL2 {
    l2: f64,
    least: Option<Extreme>,
    largest: Option<Extreme>,
    found: usize,
    asked: usize,
}

#[derive(Clone, Copy, Serialize)]
struct Extreme {
    l1: f64,
    direction_deg: f64,
}

/// Proofs that there is no limit.
const PROVED: [Status; 2] = [Status::L2Unreachable, Status::Unbounded];

/// What a status without a limit means for what to do next.
fn advice(status: Status, lateral_free: bool) -> Option<&'static str> {
    Some(match status {
        Status::L2Unreachable => "proved that no state has this l2",
        Status::Unbounded => "proved that nothing stops the pull",
        Status::L2NotReached if lateral_free => {
            "nothing is proved; hold the width with --l2, or try --effort thorough with --overwrite"
        }
        Status::L2NotReached => "nothing is proved; try l2 in smaller steps or --effort thorough, with --overwrite",
        Status::Uncertified => {
            "the certificate is incomplete; try --effort thorough with --overwrite, or a direction slightly to one side"
        }
        Status::InfeasibleStart => {
            "the rings of the design overlap; `maille roomiest DESIGN --lattice free --save NEW.toml` looks for a state without overlap"
        }
        Status::NotConverged => "raise --max-iterations, or use --method exact",
        Status::Interrupted => "the same command computes them",
        Status::Global | Status::Local | Status::ThresholdReached => return None,
    })
}

impl Summary {
    /// Of `rows`, `solved` of them now in `took`.
    pub fn new(
        design: &str,
        rows: &[LimitRow],
        solved: usize,
        took: Duration,
        interrupted: bool,
        record: &Path,
    ) -> Summary {
        let mut l2: Vec<f64> = rows.iter().map(|r| r.l2).collect();
        l2.sort_by(f64::total_cmp);
        l2.dedup();
        let of = |l2: f64| {
            let all = rows.iter().filter(|r| r.l2 == l2);
            let found = all.clone().filter_map(|r| Some(Extreme { l1: r.l1?, direction_deg: r.direction_deg }));
            let asked = all.filter(|r| r.extreme.is_none());
            // Rounding decides nothing: of equal limits the first direction is named.
            let order = |a: &Extreme, b: &Extreme| (a.l1 * 1e9).round().total_cmp(&(b.l1 * 1e9).round());
            let largest = found.clone().reduce(|a, b| if order(&b, &a).is_gt() { b } else { a });
            OfL2 {
                l2,
                least: found.min_by(order),
                largest,
                found: asked.clone().filter(|r| r.l1.is_some()).count(),
                asked: asked.count(),
            }
        };
        let count = |status: Status| rows.iter().filter(|r| r.status == status).count();
        Summary {
            design: design.into(),
            record: record.into(),
            lateral_free: rows.iter().any(|r| r.lateral.as_deref() == Some("free")),
            limits: l2.into_iter().map(of).collect(),
            statuses: Status::ALL.iter().map(|s| (s.name(), count(*s))).filter(|(_, n)| *n > 0).collect(),
            between: rows.iter().filter(|r| r.extreme.is_some()).count(),
            images: rows.iter().filter(|r| r.image_of_deg.is_some()).count(),
            grows_with_cell: rows.iter().filter(|r| r.l1.is_some() && r.grows_with_cell == Some(true)).count(),
            below_bound: rows
                .iter()
                .filter(|r| r.status == Status::Local)
                .filter_map(|r| r.bound_gap)
                .max_by(f64::total_cmp),
            better_chance: rows.iter().filter_map(|r| r.better_chance).max_by(f64::total_cmp),
            unstable_waves: rows.iter().filter(|r| r.wave_curvature.is_some_and(|least| least < 0.0)).count(),
            solved,
            wall_s: took.as_secs_f64(),
            interrupted,
        }
    }

    /// Prints it for people.
    pub fn print(&self) {
        output::say!("{:>8}  {:>20}  {:>20}  {:>7}", "l2", "smallest l1", "largest l1", "limits");
        let show = |x: &Option<Extreme>| {
            x.map_or("-".into(), |x| format!("{:.4} at {}°", x.l1, (x.direction_deg * 1e3).round() / 1e3))
        };
        for of in &self.limits {
            let (least, largest) = (show(&of.least), show(&of.largest));
            let l2 = if self.lateral_free { "free".into() } else { of.l2.to_string() };
            output::say!("{l2:>8}  {least:>20}  {largest:>20}  {:>3}/{:<3}", of.found, of.asked);
        }
        for status in Status::ALL {
            if let Some(count) = self.statuses.get(status.name()) {
                let more = match (status, self.below_bound) {
                    (Status::Global, _) => ": proved to be the largest".into(),
                    (Status::Local, Some(gap)) => format!(": up to {gap:.4} below a proven bound"),
                    (status, _) => {
                        advice(status, self.lateral_free).map(|words| format!(": {words}")).unwrap_or_default()
                    }
                };
                output::say!("{count} {}{more}", status.name());
            }
        }
        let not_found: usize = self.limits.iter().map(|of| of.asked - of.found).sum();
        let proved: usize = PROVED.iter().filter_map(|status| self.statuses.get(status.name())).sum();
        if not_found > proved {
            let record = output::quoted(&self.record.display().to_string());
            output::say!("`maille table {record} --where l1=none` shows the rows without a limit");
        }
        if let Some(chance) = self.better_chance {
            let percent = 100.0 * chance;
            output::say!(
                "estimated chance that one more start raises a limit: up to {percent:.1} %; a higher --effort searches further"
            );
        }
        match self.grows_with_cell {
            0 => {}
            1 => output::say!("1 limit still grows with the cell: a larger one may go further; see by_cell"),
            count => output::say!("{count} limits still grow with the cell: a larger one may go further; see by_cell"),
        }
        match self.unstable_waves {
            0 => {}
            1 => output::say!("1 limit has an unstable wave: a larger cell may go further; see wave_curvature"),
            count => {
                output::say!("{count} limits have an unstable wave: a larger cell may go further; see wave_curvature");
            }
        }
        match self.between {
            0 => {}
            1 => output::say!("1 extreme lies between the directions that were asked for; see extreme"),
            count => output::say!("{count} extremes lie between the directions that were asked for; see extreme"),
        }
        match self.images {
            0 => {}
            1 => output::say!("1 limit by symmetry, the image of another; see image_of_deg"),
            count => output::say!("{count} limits by symmetry, images of others; see image_of_deg"),
        }
        // A run that is stopped before it has found anything draws nothing.
        let picture = self.record.join("polar.png");
        let drawn = picture.is_file();
        output::say!(
            "{} in {:.1} s; {}, states.jsonl, run.json{}",
            counted(self.solved, "limit"),
            self.wall_s,
            self.record.join("limits.csv").display(),
            if drawn { ", polar.svg" } else { "" }
        );
        if drawn {
            output::say!("look at {}", picture.display());
        }
    }
}
