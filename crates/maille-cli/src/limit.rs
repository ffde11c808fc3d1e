//! `maille limit`: one question in the space of in-plane strains, answered on the screen.

use crate::{
    certificate,
    exit::{self, wrong},
    input::Input,
    interrupt,
    numbers::{finite, parse_cell, positive},
    output::{self, say},
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use maille::{
    characterize::{CellChoice, Method},
    lattice::Cell,
    limit::{
        CellTrend,
        exact::ExactOptions,
        strain::{Strain, StrainMethod, StrainOptions, StrainOutcome, StrainQuery},
    },
    model::Model,
    record::{Status, pose_records},
};
use miette::Result;
use serde_json::json;
use std::{process::ExitCode, str::FromStr, time::Instant};

/// One strain as large or as small as can be, the others held or free
///
/// Strains are Green strains of the sheet, E = (C - 1)/2 with C = F^T F, relative to the spacing of the design: exx and eyy
/// along its axes, or with --direction along axes turned by an angle; exy is the tensor shear (half the engineering shear). exx = s + s^2/2 where lines along x are stretched by 1 + s.
/// What is named by neither --fix nor --free is held at 0. With --minimize all cells up to 3x3 are solved and listed with
/// their starts and the distinct limits that these led to; as a still larger cell can fold further, such an answer is the best
/// that was found, and never global.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille limit european-4-in-1 --maximize eyy --free exx,exy
  maille limit 1.1 --maximize exx --fix eyy=0.05 --free exy
  maille limit 1.1 --minimize exx --direction 30 --free eyy,exy      pushed together along 30 degrees
  maille limit european-4-in-1 --minimize eyy --free exx,exy --cell 1x5 --starts 64
  maille limit 3.1 --maximize exy --json

Exit codes: 0 certified, or proved that what is held cannot be; 5 no certified state was found, 130 interrupted.")]
pub struct Args {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input
    design: String,
    /// The strain to make as large as can be
    #[arg(long, value_name = "STRAIN", value_parser = strain(), conflicts_with = "minimize")]
    maximize: Option<Strain>,
    /// The strain to make as small as can be
    #[arg(long, value_name = "STRAIN", value_parser = strain())]
    minimize: Option<Strain>,
    /// Strains that are held, as eyy=0.05,exy=0
    #[arg(long, value_name = "STRAIN=VALUE", value_delimiter = ',', allow_hyphen_values = true)]
    fix: Vec<Held>,
    /// Strains that are left to the sheet, as eyy,exy
    #[arg(long, value_name = "STRAIN", value_parser = strain(), value_delimiter = ',')]
    free: Vec<Strain>,
    /// Direction of the strains' x axis, degrees counter-clockwise from that of the design
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    direction: f64,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive)]
    minor_radius: Option<f64>,
    /// Cell: 1x1, 2x1, …, an integer matrix as "1,0;-1,2", or auto: larger cells where an element presses on its own image, and all
    /// up to 3x3 with --minimize
    #[arg(long, default_value = "auto", value_parser = cell_choice)]
    cell: CellChoice,
    /// Starts of a query whose bound is not attained; with --minimize of each cell
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    starts: u32,
    /// Seed of the shaking
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON document; docs/json.md has its keys
    #[arg(long)]
    json: bool,
}

/// A strain with the value at which it is held.
#[derive(Clone, Copy, Debug)]
struct Held {
    strain: Strain,
    value: f64,
}

impl FromStr for Held {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("\"{text}\" is no strain with a value; write eyy=0.05");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let strain = Strain::ALL.into_iter().find(|strain| strain.name() == name.trim()).ok_or_else(wrong)?;
        let value = value.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong)?;
        Ok(Held { strain, value })
    }
}

/// One of the names of strains.
fn strain() -> impl clap::builder::TypedValueParser<Value = Strain> {
    let known = |name: String| Strain::ALL.into_iter().find(|strain| strain.name() == name).ok_or("no strain");
    PossibleValuesParser::new(Strain::ALL.map(Strain::name)).try_map(known)
}

fn cell_choice(text: &str) -> Result<CellChoice, String> {
    if text == "auto" { Ok(CellChoice::Auto) } else { parse_cell(text).map(CellChoice::One) }
}

/// The query, the wanted strain, and 1 or −1 for the largest or the least.
fn query(args: &Args) -> Result<(StrainQuery, Strain, f64)> {
    let Some((goal, sign)) = args.maximize.map(|s| (s, 1.0)).or(args.minimize.map(|s| (s, -1.0))) else {
        return Err(wrong(exit::USAGE, "no strain is named", "give --maximize exx, or --minimize exx"));
    };
    let fix: Vec<(Strain, f64)> = args.fix.iter().map(|held| (held.strain, held.value)).collect();
    let query = StrainQuery::of(goal, sign, &fix, &args.free, args.direction)
        .map_err(|e| wrong(exit::USAGE, e.problem, e.help))?;
    Ok((query, goal, sign))
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode> {
    let (query, goal, sign) = query(args)?;
    let input = Input::read(&args.design, args.minor_radius)?;
    let cells = args.cell.cells(&Method::Exact(ExactOptions::default()), input.design.elements.len());
    let models = cells.iter().map(|cell: &Cell| input.compile(&input.design, *cell)).collect::<Result<Vec<Model>>>()?;
    let cancel = interrupt::flag()?;
    let begun = Instant::now();
    let options = StrainOptions { starts: args.starts as usize, seed: args.seed, compression: args.minimize.is_some() };
    let found = StrainMethod::new(&models, options).solve(&query, &[], &cancel);
    let model = &models[found.cell];
    let answer = Answer { args, cells: &cells, input: &input, model, found: &found, goal, sign };
    let wall_s = begun.elapsed().as_secs_f64();
    match args.json {
        true => output::print_json(&answer.json(wall_s))?,
        false => answer.print(wall_s),
    }
    Ok(ExitCode::from(match found.status {
        Status::Global | Status::Local | Status::L2Unreachable => exit::DONE,
        Status::Interrupted => exit::INTERRUPTED,
        _ => exit::INCOMPLETE,
    }))
}

struct Answer<'a> {
    args: &'a Args,
    cells: &'a [Cell],
    input: &'a Input,
    model: &'a Model,
    found: &'a StrainOutcome,
    goal: Strain,
    sign: f64,
}

impl Answer<'_> {
    fn status(&self) -> &'static str {
        match self.found.status {
            Status::L2Unreachable => "unreachable",
            Status::L2NotReached => "not-reached",
            status => status.name(),
        }
    }

    fn role(&self, strain: Strain) -> &'static str {
        let most = if self.sign > 0.0 { "largest" } else { "least" };
        match strain {
            goal if goal == self.goal => most,
            free if self.args.free.contains(&free) => "free",
            _ => "held",
        }
    }

    /// What each cell reached, with the sign of the strain.
    fn by_cell(&self) -> impl Iterator<Item = CellTrend> {
        self.found.trend.iter().map(|t| CellTrend { value: t.value.map(|p| self.sign * p), ..*t })
    }

    /// l1 of lines along a normal strain that was sought.
    fn stretch(&self) -> Option<f64> {
        let normal = self.goal != Strain::Exy;
        self.found.value.filter(|_| normal).map(|p| (1.0 + 2.0 * self.sign * p).max(0.0).sqrt() - 1.0)
    }

    fn print(&self, wall_s: f64) {
        let found = self.found;
        let most = if self.sign > 0.0 { "largest" } else { "least" };
        let turned = match self.args.direction {
            0.0 => String::new(),
            angle => format!(" with x along {angle}\u{b0}"),
        };
        say!("{}, {most} {}{turned}: {}", self.input.design.name, self.goal.name(), self.status());
        match found.status {
            Status::L2Unreachable => return say!("  proved: no state of the sheet has the strains that are held"),
            Status::L2NotReached => {
                return say!("  {} starts did not reach the strains that are held; nothing is proved", found.n_starts);
            }
            _ if found.value.is_none() => return,
            _ => {}
        }
        for strain in Strain::ALL {
            // Rounding shows no sign of a 0.
            let value = (strain.of(&found.strain, self.args.direction) * 1e9).round() / 1e9 + 0.0;
            say!("  {}   {value:>15.9}  {}", strain.name(), self.role(strain));
        }
        if let Some(l1) = self.stretch() {
            say!("  l1    {l1:>15.9}  of lines along {}", self.goal.name());
        }
        if let Some(bound) = found.bound {
            say!("  bound {:>15.9}  proved by the chains of links", self.sign * bound);
        }
        let kept = if found.links_ok { "kept" } else { "LOST" };
        let (starts, distinct) = (found.n_starts, found.n_distinct);
        say!(
            "  cell {}; {starts} starts led to {distinct} certified values; links {kept}; {wall_s:.2} s",
            self.model.cell
        );
        if found.trend.len() > 1 || self.args.minimize.is_some() {
            for cell in self.by_cell() {
                say!("    {}", cell.words(&self.cells[cell.cell].to_string()));
            }
        }
        if let Some(c) = &found.certificate {
            say!("  {}", certificate::line(c));
        }
    }

    fn json(&self, wall_s: f64) -> serde_json::Value {
        let found = self.found;
        let solved = found.value.is_some();
        let strain = |s: Strain| {
            let value = solved.then(|| s.of(&found.strain, self.args.direction));
            (s.name().to_owned(), json!({ "value": value, "is": self.role(s) }))
        };
        let cell = |t: CellTrend| {
            let name = self.cells[t.cell].to_string();
            json!({ "cell": name, "value": t.value, "n_starts": t.n_starts, "n_distinct": t.n_distinct })
        };
        let certificate = found.certificate.as_ref().map(|c| certificate::json(c, self.model.unit));
        let vector = |a: maille_geometry::Vec3| -> [f64; 3] { (a * self.model.unit).into() };
        json!({
            "design": self.input.design.name,
            "status": self.status(),
            "value": found.value.map(|p| self.sign * p),
            "bound": found.bound.map(|bound| self.sign * bound),
            "strains": Strain::ALL.map(strain).into_iter().collect::<serde_json::Map<_, _>>(),
            "cell": self.model.cell.to_string(),
            "by_cell": self.by_cell().map(cell).collect::<Vec<_>>(),
            "direction_deg": self.args.direction,
            "l1": self.stretch(),
            "a1": solved.then(|| vector(found.state.a1)),
            "a2": solved.then(|| vector(found.state.a2)),
            "poses": solved.then(|| pose_records(self.model, &found.state)),
            "certificate": certificate,
            "links_ok": solved.then_some(found.links_ok),
            "n_starts": found.n_starts,
            "n_distinct": found.n_distinct,
            "wall_s": wall_s,
        })
    }
}
