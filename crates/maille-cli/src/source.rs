//! A state to show: of a design's start, of a record, or a series of frames from the one to the other.

use crate::{
    at::{At, Place, parse_place},
    exit::{self, wrong},
    extreme::{Lattice, as_design, word as extreme_word},
    input::{Input, Setting, file_name},
    numbers::positive,
    output::{counted, quoted},
    records::{self, holds_record, read_record},
};
use maille::{
    design::Design,
    error::InvalidInput,
    lattice::{Cell, Shift},
    model::{Model, RingPair},
    record::{ContactRecord, FrameRecord, StateRecord, Status},
    search::extreme::Extreme,
    state::State,
    survey::CellChoice,
    topology,
};
use maille_io::{
    Tile,
    record::{Record, SIMULATION, SimulationFiles, open_simulation},
    roll::{ROLL, Roll, open_rolls},
};
use miette::{Report, Result};
use std::{
    collections::BTreeSet,
    f64::consts::TAU,
    path::{Path, PathBuf},
};

/// Cells along a tube that are shown where nothing is said.
const TUBE_LENGTH: u32 = 8;

/// Which state is shown.
#[derive(clap::Args)]
pub struct SourceArgs {
    /// A built-in design (see `maille designs`), a TOML file, or - for standard input; may be left out with --from
    #[arg(required_unless_present = "from")]
    pub design: Option<String>,
    /// Folder of a record, of a simulation or of rolls: take one of its states [default with --at: maille-out/DESIGN]
    #[arg(long, value_name = "RECORD")]
    pub from: Option<PathBuf>,
    /// Which state of the record, as direction=30,l2=-0.125; what only one state fits may be left out. Of a simulation:
    /// frame=12 [default: the last]. Of rolls: direction=0,axis=below; of tubes wrap=12,sought=longest, too, and at a given curvature curvature=0.05 [default: roomiest]. Or roomiest, the state of the design with the widest gaps, and tightest, that with the
    /// thickest wire: found now, as `maille roomiest` and `maille tightest` do
    #[arg(long, value_parser = parse_place, allow_hyphen_values = true)]
    pub at: Option<Place>,
    /// With --at roomiest or tightest: whether the lattice may change [default: fixed for roomiest, free for tightest]
    #[arg(long, value_enum)]
    pub lattice: Option<Lattice>,
    /// Minor radius of every ring that gives none, in the file's unit
    #[arg(long, value_parser = positive, conflicts_with = "from")]
    pub minor_radius: Option<f64>,
    /// A value for a parameter of the design's file, as radius=5.0; several with commas
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', conflicts_with = "from")]
    pub set: Vec<Setting>,
}

/// A design, compiled, and perhaps a state of a record.
pub struct Source {
    /// The design as read, or as the record holds it.
    pub design: Design,
    /// Compiled for the cell of the state.
    pub model: Model,
    /// The state of the record, as recorded and as poses.
    pub locked: Option<(StateRecord, State)>,
    /// The states of a simulation and which of them is shown; the model is a finite sheet.
    pub simulated: Option<(Vec<State>, usize)>,
    /// The extreme state that the design now starts from: for the names of files, and in words.
    pub extreme: Option<(&'static str, String)>,
    /// The roll that the state is of.
    pub rolled: Option<Roll>,
}

/// What else a command asks of its source.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// A state of a record, even without --at.
    pub locked: bool,
    /// A start with overlaps is shown, not refused.
    pub overlaps: bool,
    /// Threads of a search [default: all cores].
    pub threads: Option<u16>,
}

impl SourceArgs {
    fn input(&self) -> Result<Option<Input>> {
        self.design.as_deref().map(|name| Input::read_with(name, &self.set, self.minor_radius)).transpose()
    }

    /// Reads the design and its state, from the record where one is asked for.
    pub fn read(&self, wanted: Wanted) -> Result<Source> {
        let input = self.input()?;
        let at = match self.at {
            Some(Place::Extreme(what)) => return self.of_extreme(input.as_ref(), what, wanted),
            Some(Place::At(at)) => Some(at),
            None => None,
        };
        if self.lattice.is_some() {
            let help = "name one of them with --at, or leave out --lattice";
            return Err(wrong(exit::USAGE, "--lattice is for --at roomiest and --at tightest", help));
        }
        let folder = match (&self.from, &input) {
            (Some(folder), _) => records::folder(folder),
            (None, Some(input)) if at.is_some() || wanted.locked => usual_folder(&input.design),
            (None, Some(input)) => {
                let design = input.design.clone();
                let compiled = if wanted.overlaps { &tolerant(&design) } else { &design };
                let model = input.compile(compiled, Cell::PRIMITIVE)?;
                return Ok(Source { design, model, locked: None, simulated: None, extreme: None, rolled: None });
            }
            (None, None) => {
                return Err(wrong(exit::USAGE, "there is neither a design nor a record", "name one of them"));
            }
        };
        match () {
            () if folder.join(SIMULATION[0]).is_file() => self.of_simulation(at, &folder),
            () if folder.join(ROLL).is_file() => self.of_rolls(at.unwrap_or_default(), input.as_ref(), &folder),
            () => self.of_record(at.unwrap_or_default(), input.as_ref(), &folder),
        }
    }

    /// The closest cell of the design, whose gap the design and its unit tell.
    pub fn closest(&self, what: impl FnOnce(&Design) -> Result<Extreme>) -> Result<Source> {
        let Some(input) = self.input()? else {
            return Err(wrong(exit::USAGE, "there is no design to find the closest cell of", "name one"));
        };
        let what = what(&input.design)?;
        self.of_extreme(Some(&input), what, Wanted { locked: false, overlaps: false, threads: None })
    }

    /// The extreme state is a design of its own, and the start of that one is shown.
    fn of_extreme(&self, input: Option<&Input>, what: Extreme, wanted: Wanted) -> Result<Source> {
        let Some(input) = input.filter(|_| self.from.is_none()) else {
            let help = "name the design in place of --from: its state is found now, and no record holds it";
            return Err(wrong(exit::USAGE, "a record has no roomiest and no tightest state", help));
        };
        if wanted.locked {
            let help = "leave out --frames, or lead them to a limit with --at direction=30,l2=0";
            return Err(wrong(exit::USAGE, "frames lead to a limit, or are those of a simulation", help));
        }
        let (design, words) = as_design(input, what, self.lattice, wanted.threads)?;
        let design = Design { name: input.design.name.clone(), ..design };
        // Rings that touch may overlap by a rounding.
        let model = input.compile(&tolerant(&design), Cell::PRIMITIVE)?;
        Ok(Source {
            design,
            model,
            locked: None,
            simulated: None,
            extreme: Some((extreme_word(what), words)),
            rolled: None,
        })
    }

    fn of_simulation(&self, at: Option<At>, folder: &Path) -> Result<Source> {
        let SimulationFiles { record, frames, .. } = open_simulation(folder)?;
        let unusable = |problem: String| {
            let help = "its files were edited or do not belong together: simulate it again";
            wrong(exit::RECORD, format!("the simulation {} cannot be used: {problem}", folder.display()), help)
        };
        let tile: Cell = record.tile.parse().map_err(|e: InvalidInput| unusable(e.problem))?;
        let model = Model::compile_sheet(&tolerant(&record.design), tile)
            .map_err(|problems| unusable(problems.iter().map(|p| p.problem.clone()).collect::<Vec<_>>().join("; ")))?;
        let state = |frame: FrameRecord| {
            let [a1, a2] = [model.start.a1, model.start.a2].map(|a| (a * model.unit).into());
            maille_mesh::state_of(&model, &StateRecord { poses: frame.poses, a1, a2, ..StateRecord::default() })
        };
        let states: Vec<State> = frames.into_iter().map(state).collect::<Result<_, _>>()?;
        let last = states.len().checked_sub(1).ok_or_else(|| unusable("it has no frames".into()))?;
        let shown = match (at.unwrap_or_default().frame, at) {
            (Some(frame), _) if frame <= last => frame,
            (None, None) => last,
            _ => {
                let help = format!("name one of its frames, --at frame=0 to --at frame={last}");
                return Err(wrong(
                    exit::USAGE,
                    format!("{} has {}", folder.display(), counted(last + 1, "frame")),
                    help,
                ));
            }
        };
        Ok(Source {
            design: record.design,
            model,
            locked: None,
            simulated: Some((states, shown)),
            extreme: None,
            rolled: None,
        })
    }

    fn of_record(&self, at: At, input: Option<&Input>, folder: &Path) -> Result<Source> {
        if at.frame.is_some() {
            let help = "frames are those of `maille simulate`; a limit is named as --at direction=30,l2=-0.125";
            return Err(wrong(
                exit::USAGE,
                format!("{} is not a simulation: it has no frames", folder.display()),
                help,
            ));
        }
        let record = match input {
            Some(input) if self.from.is_none() && !holds_record(folder) => {
                return Err(wrong(
                    exit::RECORD,
                    format!("{} holds no record to take a state from", folder.display()),
                    format!("compute it with\n  {}", self.characterize_line(&input.design, None, at, folder)),
                ));
            }
            _ => read_record(folder)?,
        };
        let design = &record.run.design;
        if let Some(input) = input.filter(|input| input.design != *design) {
            let line = self.characterize_line(&input.design, Some(&record), at, &another(folder, at));
            return Err(wrong(
                exit::RECORD,
                format!(
                    "the record {} is of another design: \"{}\"{}, not \"{}\"{} as in the file",
                    folder.display(),
                    design.name,
                    radius(design),
                    input.design.name,
                    radius(&input.design),
                ),
                format!("leave the design out to show what the record holds, or compute this one with\n  {line}"),
            ));
        }
        let state = self.pick(&record, at, folder)?;
        // The cell is that of the row: a run may solve several.
        let key = (state.direction_deg, state.l2, state.status);
        let row = record.rows.iter().find(|r| (r.direction_deg, r.l2, r.status) == key);
        let unusable = |problems: Vec<InvalidInput>| {
            let list: Vec<String> = problems.iter().map(|p| format!("  {}: {}", p.field, p.problem)).collect();
            let problem = format!("the record {} cannot be used:\n{}", folder.display(), list.join("\n"));
            wrong(
                exit::RECORD,
                problem,
                "its files were edited or do not belong together: compute it again with --overwrite",
            )
        };
        let cell: Cell = row.map_or("1x1", |r| &r.cell).parse().map_err(|problem| unusable(vec![problem]))?;
        let model = Model::compile(&tolerant(design), cell).map_err(unusable)?;
        let locked = maille_mesh::state_of(&model, state)?;
        Ok(Source {
            design: design.clone(),
            locked: Some((state.clone(), locked)),
            model,
            simulated: None,
            extreme: None,
            rolled: None,
        })
    }

    fn of_rolls(&self, at: At, input: Option<&Input>, folder: &Path) -> Result<Source> {
        let (record, rolls) = open_rolls(folder)?;
        let named = folder.display();
        if at.frame.is_some() || at.l2.is_some() {
            let help = "name one as --at direction=0,axis=below";
            return Err(wrong(exit::USAGE, format!("{named} holds rolls: they have no frame and no l2"), help));
        }
        if input.is_some_and(|input| input.design != record.design) {
            let problem = format!("the rolls in {named} are of another design: \"{}\"", record.design.name);
            return Err(wrong(exit::RECORD, problem, "leave the design out to show what the folder holds"));
        }
        let found: Vec<(&Roll, StateRecord)> = rolls
            .iter()
            .filter(|roll| at.fits_roll(&roll.key()))
            .filter_map(|roll| Some((roll, roll.state()?)))
            .collect();
        let [(roll, state)] = &found[..] else {
            let all = rolls.iter().map(|roll| format!("  --at {}", roll.key().place()));
            let problem = match found.len() {
                0 => format!("{named} has no roll with a state at {at}"),
                n => format!("{n} rolls of {named} fit"),
            };
            let help = format!("name one:\n{}", all.collect::<Vec<_>>().join("\n"));
            return Err(wrong(exit::USAGE, problem, help));
        };
        let unusable = |problem: String| {
            let help = "its files were edited or do not belong together: compute it again with --overwrite";
            wrong(exit::RECORD, format!("the rolls in {named} cannot be used: {problem}"), help)
        };
        let cell: Cell = roll.cell.parse().map_err(|e: InvalidInput| unusable(e.problem))?;
        let model = Model::compile(&tolerant(&record.design), cell)
            .map_err(|problems| unusable(problems.iter().map(|p| p.problem.clone()).collect::<Vec<_>>().join("; ")))?;
        let locked = maille_mesh::state_of(&model, state)?;
        Ok(Source {
            locked: Some((state.clone(), locked)),
            rolled: Some((*roll).clone()),
            design: record.design,
            model,
            simulated: None,
            extreme: None,
        })
    }

    /// The only state that fits.
    fn pick<'a>(&self, record: &'a Record, at: At, folder: &Path) -> Result<&'a StateRecord> {
        let all: Vec<&StateRecord> = record.states.iter().filter(|s| !s.poses.is_empty()).collect();
        let found: Vec<&StateRecord> = all.iter().copied().filter(|s| at.fits(s.direction_deg, s.l2)).collect();
        let list = |states: &[&StateRecord]| {
            let some = states.iter().take(6).map(|s| format!("  --at direction={},l2={}", s.direction_deg, s.l2));
            let more = states.len().saturating_sub(6);
            some.chain((more > 0).then(|| format!("  … and {more} more"))).collect::<Vec<_>>().join("\n")
        };
        match found[..] {
            [state] => Ok(state),
            [] => {
                let line = self.characterize_line(&record.run.design, Some(record), at, &another(folder, at));
                // The nearest first: a degree weighs as much as 0.01 of l2.
                let far = |s: &StateRecord| {
                    let of = |wanted: Option<f64>, x: f64| wanted.map_or(0.0, |w| (w - x).abs());
                    of(at.direction, s.direction_deg) + 100.0 * of(at.l2, s.l2)
                };
                let mut nearest = all;
                nearest.sort_by(|a, b| far(a).total_cmp(&far(b)));
                let has = match nearest.is_empty() {
                    true => "it has none with poses".into(),
                    false => format!("it has, the nearest first:\n{}", list(&nearest)),
                };
                Err(wrong(
                    exit::RECORD,
                    format!("the record {} has no state at {at}", folder.display()),
                    format!("{has}\ncompute the one asked for with\n  {line}\nand then give its folder with --from"),
                ))
            }
            _ => Err(wrong(
                exit::USAGE,
                format!("{} states of the record {} fit", found.len(), folder.display()),
                format!("name one:\n{}", list(&found)),
            )),
        }
    }

    /// The command that computes the state asked for.
    fn characterize_line(&self, design: &Design, record: Option<&Record>, at: At, folder: &Path) -> String {
        let mut line = format!("maille characterize {}", quoted(self.design.as_deref().unwrap_or(&design.name)));
        line += &self.set.iter().map(|set| format!(" --set {set}")).collect::<String>();
        if let Some(design) = record.map(|r| &r.run.design).filter(|_| self.design.is_none()) {
            let set = design.free_parameters().filter(|p| design.varied.contains_key(&p.name));
            line += &set.map(|p| format!(" --set {}={}", p.name, p.value)).collect::<String>();
        }
        line += &at.direction.map_or(String::new(), |d| format!(" --directions {d}"));
        line += &at.l2.map_or(String::new(), |l2| format!(" --l2 {l2}"));
        let of_record = record.and_then(|r| r.run.design.minor_radius).filter(|_| self.design.is_none());
        line += &self.minor_radius.or(of_record).map_or(String::new(), |r| format!(" --minor-radius {r}"));
        if let Some(question) = record.and_then(|r| r.run.question().ok()) {
            line += &format!(" --method {}", question.method.name());
            // Several cells are those of the default, auto.
            if let CellChoice::These(cells) = question.cells
                && let [cell] = cells[..]
            {
                line += &format!(" --cell {}", quoted(&cell.to_string()));
            }
        }
        line + &format!(" --out {}", quoted(&folder.display().to_string()))
    }

    /// Forces are asked for, and the state has none: how to get one that has.
    pub fn no_forces(&self, source: &Source) -> Report {
        let name = self.design.as_deref().unwrap_or(&source.design.name);
        let (what, direction, l2) = match &source.locked {
            Some((s, _)) => {
                (format!("the state at direction {}°, l2 {}", s.direction_deg, s.l2), s.direction_deg, s.l2)
            }
            None => ("the starting state".into(), 0.0, 0.0),
        };
        let folder = format!("maille-out/{}-exact", file_name(&source.design.name));
        wrong(
            exit::USAGE,
            format!("{what} has no contact forces"),
            format!(
                "limits of the exact method have them:\n  maille characterize {name} --method exact --directions {direction} \
                 --l2 {l2} --out {folder}\nthen take the state from there with\n  --from {folder} --at direction={direction},l2={l2}"
            ),
        )
    }
}

impl Source {
    /// Its contacts that carry force.
    pub fn contacts(&self) -> &[ContactRecord] {
        self.locked.as_ref().map_or(&[], |(record, _)| &record.contacts)
    }

    /// The cells that close the tube of the state, where it is one and a lattice vector of the cell goes round.
    pub fn tube_tile(&self) -> Option<Tile> {
        let roll = self.rolled.as_ref()?;
        let (_, state) = self.locked.as_ref()?;
        let turns = state.roll?.turn_rad.map(|turn| turn.abs() / TAU);
        let around = |turn: f64| (1.0 / turn).round();
        roll.wrap?;
        let whole = |k: usize| (turns[k] * around(turns[k]) - 1.0).abs() < 1e-9;
        match turns.map(|turn| turn > 1e-9) {
            [true, false] if whole(0) => {
                let long = if self.model.single { 1 } else { TUBE_LENGTH };
                Some(Tile([around(turns[0]) as u32, long]))
            }
            [false, true] if whole(1) => Some(Tile([TUBE_LENGTH, around(turns[1]) as u32])),
            _ => None,
        }
    }

    /// How files of this state are named; `film` is of all states of a simulation.
    pub fn stem(&self, film: bool) -> String {
        let name = file_name(&self.design.name);
        if let Some((_, shown)) = self.simulated {
            if film {
                return format!("{name}-simulate");
            }
            return format!("{name}-simulate_frame{shown}");
        }
        if let Some((word, _)) = self.extreme {
            return format!("{name}-{word}");
        }
        if let Some(roll) = &self.rolled {
            let what = match (roll.wrap, roll.at_curvature) {
                (Some(cells), _) => format!("tube-{cells}-{}", roll.sought.name()),
                (_, Some(curvature)) => format!("rolled-{curvature}-{}", roll.sought.name()),
                _ => "roll".to_owned(),
            };
            return format!("{name}-{what}_{}_{}", roll.direction_deg, roll.axis.name());
        }
        self.locked.as_ref().map_or(name.clone(), |(s, _)| name + &place(Some(s.direction_deg), Some(s.l2)))
    }

    /// What a reader should know about the state, if it is no limit: of an extreme, its figures.
    pub fn caution(&self) -> Option<String> {
        if let Some((_, words)) = &self.extreme {
            return Some(words.clone());
        }
        let (record, _) = self.locked.as_ref()?;
        let limit = matches!(record.status, Status::Global | Status::Local | Status::ThresholdReached);
        (!limit).then(|| format!("the state is \"{}\": the last of its search, no limit", record.status.name()))
    }

    /// What a reader should know about elements of a roll, each with its cell: that rings of them overlap. Those that lie farther apart around
    /// the roll than half a turn are in no certificate.
    pub fn overlap_of(&self, state: &State, elements: &[(usize, Shift)]) -> Option<String> {
        let roll = state.roll.as_ref()?;
        let there: BTreeSet<(usize, Shift)> = elements.iter().copied().collect();
        let cells = [0, 1].map(|k| {
            let (least, most) =
                elements.iter().map(|e| e.1[k]).fold((0, 0), |(least, most), s| (least.min(s), most.max(s)));
            most.abs_diff(least) + 1
        });
        let element = |ring: usize| self.model.rings[ring].element;
        // Where a pair is.
        let cells_of = |pair: &RingPair| {
            let of_a = elements.iter().filter(|e| e.0 == element(pair.ring_a)).map(|e| e.1);
            let with_b = of_a.map(|a| (a, [0, 1].map(|k| a[k] + pair.shift[k])));
            with_b.into_iter().find(|(_, b)| there.contains(&(element(pair.ring_b), *b)))
        };
        let pairs = topology::close_pairs_within(&self.model, state, cells, 0.0);
        let gap = |pair: &RingPair| {
            let wires = self.model.contact_distance(pair.ring_a, pair.ring_b);
            topology::core_distance(&self.model, state, pair) - wires
        };
        let turn =
            |pair: &RingPair| (0..2).map(|k| f64::from(pair.shift[k]) * roll.turn_rad[k]).sum::<f64>().abs() / TAU;
        let measured = pairs.into_iter().map(|pair| (turn(&pair), gap(&pair), pair));
        let mut overlapping: Vec<_> = measured.filter(|found| found.1 < -OVERLAP).collect();
        // The pair that the shortest piece has.
        overlapping.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let at = |found: (f64, f64, RingPair)| Some((cells_of(&found.2)?, found));
        let ((here, beside), (turn, gap, pair)) = overlapping.into_iter().find_map(at)?;
        let [a, b] = [(pair.ring_a, here), (pair.ring_b, beside)].map(|(ring, cell)| self.model.ring_label(ring, cell));
        let (overlap, unit) = (-gap * self.model.unit, self.design.unit.as_deref().unwrap_or("of the file's unit"));
        let found = format!(
            "rings of this piece overlap: {a} and {b}, {turn:.2} of a turn apart around the roll, by {overlap:.4} {unit}"
        );
        let cure = "take a smaller --tile, or a tube that closes, of `maille roll --wrap`";
        Some(if turn > 0.5 { format!("{found}. A roll counts pairs up to half a turn; {cure}") } else { found })
    }
}

/// Rings that overlap by less touch, in reference radii.
const OVERLAP: f64 = 1e-7;

/// The design with overlaps of its start accepted.
pub fn tolerant(design: &Design) -> Design {
    Design { allow_initial_overlap: true, ..design.clone() }
}

/// Where `characterize` writes if it is not told.
pub fn usual_folder(design: &Design) -> PathBuf {
    PathBuf::from("maille-out").join(file_name(&design.name))
}

/// A folder for a record of other directions than those of `folder`.
fn another(folder: &Path, at: At) -> PathBuf {
    let mut name = folder.as_os_str().to_owned();
    name.push(place(at.direction, at.l2));
    name.into()
}

fn place(direction: Option<f64>, l2: Option<f64>) -> String {
    direction.map_or(String::new(), |d| format!("_dir{d}")) + &l2.map_or(String::new(), |l2| format!("_l2_{l2}"))
}

fn radius(design: &Design) -> String {
    design.minor_radius.map_or(String::new(), |r| format!(" with r = {r}"))
}
