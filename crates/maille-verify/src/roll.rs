//! The rolls of a sheet, one by one: each state is derived anew from its texts.

use crate::{
    files::{RECORDS, checksum, inputs_of, say, sha256},
    gaps::gaps_and_links,
    record::{Contact, Design, Pose, Row, State, Unreadable, json},
    report::{Check, Finding, Verdict},
    roll_forces::{Objective, Rate, Written, roll_forces},
    rolled::{Motions, Rolled, joined},
    sheet::{self, Pair, Sheet, Vec3},
    start::{Start, names, start},
    strain::axes,
};
use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

const HEAD: &str = "roll.json";
const STATES: &str = "rolls.jsonl";
const TABLE: &str = "rolls.csv";
/// Figures of a roll are those of its state within this, relative.
const SAME: f64 = 1e-9;
/// Tolerance of the figures of a certificate.
const CERTIFIED: f64 = 1e-9;
/// Columns that a table of rolls has at least.
const COLUMNS: [&str; 10] = [
    "direction_deg",
    "axis",
    "cell",
    "status",
    "curvature",
    "neutral_radius",
    "neutral_stretch",
    "l2",
    "min_gap",
    "links_ok",
];
/// Version of the files.
const SCHEMA: u64 = 1;
/// Statuses of a roll.
const STATUSES: [&str; 3] = ["local", "uncertified", "not-converged"];

/// The files of rolls.
#[derive(Clone, Copy, Debug)]
pub struct RollTexts<'a> {
    /// `roll.json`.
    pub head: &'a str,
    /// `rolls.jsonl`.
    pub states: &'a str,
    /// `rolls.csv`.
    pub table: &'a str,
}

#[derive(Deserialize)]
struct Head {
    schema: u64,
    program_version: String,
    input_hash: String,
    design: Design,
    question: Question,
    complete: bool,
    files: BTreeMap<String, String>,
}

#[derive(Deserialize)]
struct Question {
    directions_deg: Vec<f64>,
    axes: Vec<String>,
    free: Free,
    #[serde(default)]
    l2: f64,
    #[serde(default)]
    gamma: f64,
    #[serde(default)]
    wrap: Vec<u32>,
    #[serde(default)]
    curvatures: Vec<f64>,
}

#[derive(Deserialize)]
struct Free {
    lateral_free: bool,
    shear_free: bool,
}

/// The first line of the states.
#[derive(Deserialize)]
struct FirstLine {
    program_version: String,
    input_hash: String,
    design: String,
}

#[derive(Deserialize)]
struct Certificate {
    smallest_gap: f64,
    dual_residual: f64,
    complementarity: f64,
    min_multiplier: Option<f64>,
    min_curvature: Option<f64>,
    zero_modes: u64,
}

#[derive(Deserialize)]
struct Turns {
    along: [f64; 2],
    turn_rad: [f64; 2],
}

#[derive(Deserialize)]
struct Roll {
    direction_deg: f64,
    axis: String,
    wrap: Option<u32>,
    at_curvature: Option<f64>,
    #[serde(default = "of_sheet")]
    sought: String,
    lateral: String,
    shear: String,
    status: String,
    curvature: Option<f64>,
    neutral_radius: Option<f64>,
    neutral_stretch: Option<f64>,
    l2: Option<f64>,
    gamma: Option<f64>,
    cell: String,
    a1: Option<[f64; 3]>,
    a2: Option<[f64; 3]>,
    roll: Option<Turns>,
    poses: Option<Vec<Pose>>,
    contacts: Vec<Contact>,
    min_gap: Option<f64>,
    certificate: Option<Certificate>,
    links_ok: Option<bool>,
}

fn of_sheet() -> String {
    "tightest".into()
}

/// What is sought where the turn is given; the last two, where the length along the axis is free.
const AT_TURN: [&str; 5] = ["roomiest", "narrowest", "widest", "shortest", "longest"];

/// The cells that go round and the bits of the curvature, where one of them is given.
type GivenTurn = (Option<u32>, Option<u64>);

/// What tells a roll from the others.
type Key = (u64, String, Option<u32>, Option<u64>, String);

impl Roll {
    fn key(&self) -> Key {
        let given = self.at_curvature.map(f64::to_bits);
        (self.direction_deg.to_bits(), self.axis.clone(), self.wrap, given, self.sought.clone())
    }
}

/// What is known of one roll.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RollReport {
    /// Direction that is rolled.
    pub direction_deg: f64,
    /// `below` or `above`.
    pub axis: String,
    /// Cells of a tube that go round.
    pub wrap: Option<u32>,
    /// The curvature where it is given.
    pub at_curvature: Option<f64>,
    /// What is sought.
    pub sought: String,
    /// Its status.
    pub status: String,
    /// Whether it claims a certificate.
    pub certified: bool,
    /// The checks.
    pub findings: Vec<Finding>,
}

/// Rolls that were read, with the design.
pub struct RollVerifier {
    design: Design,
    /// l2 and γ where they are held.
    held: [f64; 2],
    rolls: Vec<Roll>,
    files: Vec<Finding>,
}

impl RollVerifier {
    /// Reads the files and checks that they fit together.
    ///
    /// # Errors
    /// Where one cannot be read as what it should be.
    pub fn new(texts: &RollTexts<'_>) -> Result<Self, Unreadable> {
        let head: Head = json(HEAD, 0, texts.head)?;
        let unreadable = |file, problem: String| Unreadable { file, line: 1, problem };
        if head.schema != SCHEMA {
            return Err(unreadable(HEAD, format!("schema {}; this program reads schema {SCHEMA}", head.schema)));
        }
        let sizes = head.design.elements.iter().flat_map(|e| &e.rings).map(|ring| ring.major_radius);
        if let Some(size) = sizes.chain([head.design.reference_radius]).find(|size| !(size.is_finite() && *size > 0.0))
        {
            return Err(unreadable(HEAD, format!("a radius of {size}")));
        }
        let mut lines = texts.states.lines();
        let first: FirstLine = json(STATES, 1, lines.next().unwrap_or_default())?;
        let read = |(k, line): (usize, &str)| Ok((json(STATES, k + 2, line)?, json(STATES, k + 2, line)?));
        let mut both: Vec<(Roll, Value)> = lines.enumerate().map(read).collect::<Result<_, _>>()?;
        // As the table: the axis below comes first.
        let place = |sought: &str| AT_TURN.iter().position(|of| *of == sought);
        let given = |roll: &Roll| roll.at_curvature.unwrap_or(0.0);
        both.sort_by(|(a, _), (b, _)| {
            let side = a.direction_deg.total_cmp(&b.direction_deg).then(b.axis.cmp(&a.axis));
            let turn = a.wrap.cmp(&b.wrap).then(given(a).total_cmp(&given(b)));
            side.then(turn).then(place(&a.sought).cmp(&place(&b.sought)))
        });
        let (rolls, values): (Vec<Roll>, Vec<Value>) = both.into_iter().unzip();
        let value: Value = json(HEAD, 0, texts.head)?;
        let hashed = inputs_of(HEAD, RECORDS, &value["design"], &parameters(&value["question"]), &head.input_hash);
        let mut files = vec![belongs(&head, &first, &rolls), hashed, line_sums(texts.states)];
        let sums = [(STATES, texts.states), (TABLE, texts.table)];
        files.extend(sums.map(|(name, text)| checksum(HEAD, &head.files, name, text)));
        files.push(table_fits(&values, texts.table)?);
        let held = [head.question.l2, head.question.gamma];
        Ok(RollVerifier { design: head.design, held, rolls, files })
    }

    /// What is known of the files.
    pub fn files(&self) -> &[Finding] {
        &self.files
    }

    /// Name of the design.
    pub fn design(&self) -> &str {
        &self.design.name
    }

    /// Rolls.
    pub fn len(&self) -> usize {
        self.rolls.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rolls.is_empty()
    }

    /// Verifies roll `k`, counted from 0 in the order of the table.
    pub fn roll(&self, k: usize) -> RollReport {
        let roll = &self.rolls[k];
        let certified = roll.status == "local";
        let mut findings = vec![status(roll, certified, self.design.reference_radius)];
        if roll.curvature.is_some() {
            findings.extend(self.of_state(roll, certified).unwrap_or_else(|words| vec![say(Verdict::False, words)]));
        }
        let (direction_deg, axis, status) = (roll.direction_deg, roll.axis.clone(), roll.status.clone());
        let (wrap, at_curvature, sought) = (roll.wrap, roll.at_curvature, roll.sought.clone());
        RollReport { direction_deg, axis, wrap, at_curvature, sought, status, certified, findings }
    }

    fn of_state(&self, roll: &Roll, certified: bool) -> Result<Vec<Finding>, String> {
        let unit = self.design.reference_radius;
        let cell = sheet::cell(&roll.cell).ok_or_else(|| format!("\"{}\" is no cell", roll.cell))?;
        let (Some(poses), Some(turns), Some(a1), Some(a2)) = (&roll.poses, &roll.roll, roll.a1, roll.a2) else {
            return Err("a roll with a curvature has no state".into());
        };
        let state = State { a1, a2, poses: poses.clone(), ..State::default() };
        let start: Start = start(&self.design, &cell, &names(&state))?;
        let along = Vec3::new(turns.along[0], turns.along[1], 0.0);
        let links = start.links.as_ref().map_err(String::clone)?;
        let element = |ring: usize| start.sheet.rings[ring].element;
        let of = |&((a, b, shift), _): &(Pair, i32)| ([element(a), element(b)], shift);
        let (linked, joined) = joined(links.iter().map(of));
        let rolled = Rolled {
            motions: Motions { along, turn_rad: turns.turn_rad },
            places: start.sheet.places(),
            linked,
            joined,
        };
        let mut here = start.sheet.at(&state, unit)?;
        if let Some(words) = rolled.motions.contradiction(here.lattice) {
            return Err(words);
        }
        let positions: Vec<Vec3> = here.bodies.iter().map(|body| body.position).collect();
        if certified && rolled.has_axis_inside(here.lattice, &positions, &here.reaches()) {
            return Err("the axis has passed through the sheet".into());
        }
        here.roll = Some(rolled);
        if let Some(cells) = roll.wrap
            && let Err(words) = closes(roll, cells, &here, &start.sheet, sheet::primitive(&self.design))
        {
            return Err(words);
        }
        let mut out = vec![match deformation(roll, &here, &start.sheet, self.held, unit) {
            Ok(off) => {
                let words = format!("curvature, radius and stretch are those of the state, to {off:.1e}");
                Finding::new(Check::Deformation, Verdict::Proved, Some(off), words)
            }
            Err(words) => Finding::new(Check::Deformation, Verdict::False, None, words),
        }];
        let min_gap = roll.min_gap;
        let max_overlap = min_gap.map(|gap| (-gap).max(0.0));
        let row = Row { status: roll.status.clone(), links_ok: roll.links_ok, min_gap, max_overlap, ..Row::default() };
        let keeps = if roll.sought == "roomiest" { roll.min_gap.unwrap_or(0.0) / unit } else { 0.0 };
        out.extend(gaps_and_links(&row, &here, &start, keeps, unit));
        if certified {
            let written = roll.certificate.as_ref().map(|c| Written {
                min_multiplier: c.min_multiplier,
                min_curvature: c.min_curvature,
                zero_modes: c.zero_modes,
            });
            let objective = match roll.sought.as_str() {
                "roomiest" => Objective::Gap(keeps),
                "narrowest" => Objective::Radius(-1.0),
                "widest" => Objective::Radius(1.0),
                _ => Objective::FirstRate,
            };
            let rates = rates(roll, &start.sheet);
            out.extend(roll_forces(&here, &roll.contacts, (objective, &rates), unit, written.as_ref()));
        }
        Ok(out)
    }
}

/// What of a question decides where a roll ends, as the program hashes it.
fn parameters(question: &Value) -> Value {
    let some = |list: &str| question[list].as_array().is_some_and(|values| !values.is_empty());
    let tubes = some("wrap");
    let mut out = serde_json::json!({
        "tubes": tubes,
        "free": question["free"],
        "cells": question["cells"],
        "effort": question["effort"],
        "seed": question["seed"],
    });
    if !tubes && some("curvatures") {
        out["at_curvature"] = true.into();
    }
    let [l2, gamma] = ["l2", "gamma"].map(|name| question[name].as_f64().unwrap_or(0.0));
    if !tubes && (l2, gamma) != (0.0, 0.0) {
        (out["l2"], out["gamma"]) = (l2.into(), gamma.into());
    }
    out
}

/// Whether the rolls are those of the head: of its design and version, of what it holds, each once, and as many as it says.
fn belongs(head: &Head, first: &FirstLine, rolls: &[Roll]) -> Finding {
    let wrong = |words: String| say(Verdict::False, words);
    let of_first = [&first.program_version, &first.input_hash, &first.design];
    if of_first != [&head.program_version, &head.input_hash, &head.design.name] {
        return wrong(format!("the first line of {STATES} is not of the run of {HEAD}"));
    }
    let word = |free: bool| if free { "free" } else { "fixed" };
    let tubes = !head.question.wrap.is_empty();
    let bent = !tubes && !head.question.curvatures.is_empty();
    let free = match tubes {
        true => [!head.design.lattice.single, false],
        false => [head.question.free.lateral_free, head.question.free.shear_free],
    };
    let held = free.map(word);
    let ends = if free[0] { &AT_TURN[..] } else { &AT_TURN[..3] };
    let is_asked = |roll: &Roll| {
        let known = if tubes || bent { ends.contains(&roll.sought.as_str()) } else { roll.sought == of_sheet() };
        known && (roll.wrap.is_some(), roll.at_curvature.is_some()) == (tubes, bent)
    };
    if let Some(roll) = rolls.iter().find(|roll| !is_asked(roll)) {
        return wrong(format!("the {} roll along {}° is not asked by {HEAD}", roll.sought, roll.direction_deg));
    }
    if let Some(roll) = rolls.iter().find(|roll| [roll.lateral.as_str(), roll.shear.as_str()] != held) {
        return wrong(format!("width and shear of the roll along {}° are not held as {HEAD} says", roll.direction_deg));
    }
    if let Some(pair) = rolls.windows(2).find(|pair| pair[0].key() == pair[1].key()) {
        return wrong(format!("the roll along {}°, axis {}, is there twice", pair[0].direction_deg, pair[0].axis));
    }
    let all_ends = |turn: GivenTurn| ends.iter().map(move |sought| (turn, (*sought).to_owned()));
    let sought: Vec<(GivenTurn, String)> = match (tubes, bent) {
        (true, _) => head.question.wrap.iter().flat_map(|cells| all_ends((Some(*cells), None))).collect(),
        (_, true) => head.question.curvatures.iter().flat_map(|k| all_ends((None, Some(k.to_bits())))).collect(),
        _ => vec![((None, None), of_sheet())],
    };
    let sides =
        head.question.directions_deg.iter().flat_map(|d| head.question.axes.iter().map(|a| (d.to_bits(), a.clone())));
    let asked = sides.flat_map(|(d, a)| sought.iter().map(move |((w, k), s)| (d, a.clone(), *w, *k, s.clone())));
    let missing = asked.filter(|asked| !rolls.iter().any(|roll| roll.key() == *asked)).count();
    match (missing, head.complete) {
        (0, true) => say(Verdict::Proved, format!("all rolls that {HEAD} asks are there")),
        (0, false) => wrong(format!("{HEAD} says that rolls are missing, and none is")),
        (n, true) => wrong(format!("{HEAD} says that all rolls are there, and {n} are not")),
        (n, false) => say(Verdict::Open, format!("{n} of the rolls that {HEAD} asks are not there yet")),
    }
}

/// Whether each line of the states has its own checksum: the first digits of the SHA-256 of the object without it.
fn line_sums(states: &str) -> Finding {
    let fits = |line: &str| {
        let (open, sum) = line.rsplit_once(",\"sum\":\"")?;
        let sum = sum.strip_suffix("\"}")?;
        (!sum.is_empty() && sha256(format!("{open}}}").as_bytes()).starts_with(sum)).then_some(())
    };
    match states.lines().position(|line| fits(line).is_none()) {
        Some(k) => say(Verdict::False, format!("{STATES}:{}: the checksum of the line does not fit", k + 1)),
        None => say(Verdict::Proved, format!("each line of {STATES} has its checksum")),
    }
}

/// Whether the table's entries are those of the states, bit for bit; a value that is not there is an empty cell.
fn table_fits(rolls: &[Value], table: &str) -> Result<Finding, Unreadable> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let wrong = |line: usize, problem: String| Unreadable { file: TABLE, line, problem };
    let mut known = rolls.iter();
    for (k, row) in reader.deserialize::<BTreeMap<String, String>>().enumerate() {
        let row = row.map_err(|e| wrong(k + 2, e.to_string()))?;
        let Some(roll) = known.next() else {
            return Ok(say(Verdict::False, format!("{TABLE}:{}: {STATES} has no such roll", k + 2)));
        };
        if let Some(name) = COLUMNS.into_iter().find(|name| !row.contains_key(*name)) {
            return Ok(say(Verdict::False, format!("{TABLE} has no column {name}")));
        }
        let same = |(name, text): &(&String, &String)| match roll.get(*name).or_else(|| roll["certificate"].get(*name))
        {
            None | Some(Value::Null) => text.is_empty(),
            Some(Value::Number(number)) => number.as_f64().is_some_and(|x| text.parse() == Ok(x)),
            Some(Value::String(written)) => text == &written,
            Some(Value::Bool(written)) => text.parse() == Ok(*written),
            Some(_) => false,
        };
        if let Some((name, _)) = row.iter().find(|entry| !same(entry)) {
            return Ok(say(Verdict::False, format!("{TABLE}:{}: {name} is not that of {STATES}", k + 2)));
        }
    }
    Ok(match known.next() {
        Some(_) => say(Verdict::False, format!("{STATES} has rolls that {TABLE} lacks")),
        None => say(Verdict::Proved, format!("{TABLE} has the figures of {STATES}")),
    })
}

/// Whether the roll has what its status says.
fn status(roll: &Roll, certified: bool, unit: f64) -> Finding {
    let of = |verdict, words: &str| Finding::new(Check::Status, verdict, None, words);
    if !STATUSES.contains(&roll.status.as_str()) {
        return of(Verdict::Open, "nothing is derived of this status");
    }
    let figures = [roll.neutral_radius, roll.neutral_stretch, roll.l2];
    // Elements that came apart have no gap.
    let lacks_gap = certified && roll.min_gap.is_none() || roll.min_gap.is_some() && roll.curvature.is_none();
    if lacks_gap || figures.iter().any(|figure| figure.is_some() != roll.curvature.is_some()) {
        return of(Verdict::False, "some of curvature, radius, stretch, l2 and min_gap are there, and others are not");
    }
    if !certified {
        return of(Verdict::Proved, "the roll has what its status says");
    }
    let (Some(c), Some(_), Some(true)) = (&roll.certificate, roll.curvature, roll.links_ok) else {
        return of(Verdict::False, "a certified roll lacks its certificate, its curvature or its links");
    };
    let small = [c.dual_residual, c.complementarity, (c.smallest_gap / unit).abs()];
    let within = |x: &f64| (0.0..=CERTIFIED).contains(x);
    let negative = c.min_multiplier.is_some_and(|x| x < -CERTIFIED) || c.min_curvature.is_some_and(|x| x <= 0.0);
    if !small.iter().all(within) || negative {
        return of(Verdict::False, "the figures of the certificate are out of their tolerance");
    }
    of(Verdict::Proved, "the roll has what its status says")
}

/// Whether so many of the shortest lattice vectors along the direction lead once round, to the same place.
fn closes(roll: &Roll, cells: u32, here: &Sheet, start: &Sheet, primitive: [Vec3; 2]) -> Result<(), String> {
    let (u, _) = axes(roll.direction_deg);
    let inverse = |lattice: [Vec3; 2]| sheet::columns(lattice).try_inverse().ok_or("the lattice vectors are parallel");
    // Along u one step is the same share of both coordinates: the least that makes both whole.
    let along = inverse(primitive)? * u;
    let larger = along.iamax();
    let whole = |x: f64| (x - x.round()).abs() < SHORTEST;
    let step =
        (1..=MOST_STEPS).map(|k| along * (f64::from(k) / along[larger].abs())).find(|v| whole(v[0]) && whole(v[1]));
    let step = step.ok_or_else(|| format!("no lattice vector lies along {}°", roll.direction_deg))?;
    let around = (primitive[0] * step[0].round() + primitive[1] * step[1].round()) * f64::from(cells);
    let shift = inverse(start.lattice)? * around.xy();
    if !(whole(shift[0]) && whole(shift[1])) {
        return Err(format!("{cells} cells are not whole cells of {}", roll.cell));
    }
    let rolled = here.roll.as_ref().ok_or("the sheet is flat")?;
    let turn: f64 = (0..2).map(|k| rolled.motions.turn_rad[k] * shift[k].round()).sum();
    let beside: f64 = (0..2).map(|k| here.lattice[k].dot(&rolled.motions.axis()) * shift[k].round()).sum();
    let off = (turn.abs() - TAU).abs().max(beside.abs());
    if off <= SAME { Ok(()) } else { Err(format!("{cells} cells do not close: {off:.1e} is left")) }
}

/// Steps along a lattice vector that are tried.
const MOST_STEPS: u32 = 64;
/// Coordinates within this of a whole number are one.
const SHORTEST: f64 = 1e-7;

/// Compares the state with the roll's figures; gives the largest difference, or what does not fit.
///
/// With A the lattice vectors of the start and A′ of the state in columns, F = A′A⁻¹, θ the turns, u and w along and across the direction:
/// θ = κ A′ᵀu at the written length, uᵀFw = 0, l2 = wᵀFw − 1, γ = wᵀFu, and ρ is the mean distance of the elements from the axis.
fn deformation(roll: &Roll, here: &Sheet, start: &Sheet, held: [f64; 2], unit: f64) -> Result<f64, String> {
    let rolled = here.roll.as_ref().ok_or("the sheet is flat")?.motions;
    let inverse = sheet::columns(start.lattice).try_inverse().ok_or("the design's lattice vectors are parallel")?;
    let f: Matrix2<f64> = sheet::columns(here.lattice) * inverse;
    let (u, w) = axes(roll.direction_deg);
    let turning = inverse.transpose() * Vector2::from(rolled.turn_rad);
    let away = |position: &Vec3| {
        let from = position + Vec3::z() * rolled.axis_distance(here.lattice);
        from.cross(&rolled.axis()).norm()
    };
    let n = here.bodies.len() as f64;
    let radius = here.bodies.iter().map(|body| away(&body.position)).sum::<f64>() / n;
    let curvature = turning.dot(&u);
    let mut largest = 0.0_f64;
    let mut compare = |name: &str, written: Option<f64>, found: f64| {
        let Some(written) = written else { return Ok(()) };
        let off = (written - found).abs() / found.abs().max(1.0);
        largest = largest.max(off);
        if off <= SAME { Ok(()) } else { Err(format!("{name} is {written:?}, {found:?} in the state")) }
    };
    compare("the direction's x", Some(rolled.along.x), u.x)?;
    compare("the direction's y", Some(rolled.along.y), u.y)?;
    compare("the curvature times R", roll.curvature.map(|curvature| curvature * unit), curvature)?;
    compare("the turn along the axis", Some(0.0), turning.dot(&w))?;
    compare("the radius by R", roll.neutral_radius.map(|radius| radius / unit), radius)?;
    compare("the stretch", roll.neutral_stretch, curvature.abs() * radius)?;
    let given = roll.at_curvature.map(|curvature| curvature * unit);
    compare("the curvature that is given, times R,", given, curvature.abs())?;
    let (l2, gamma) = (w.dot(&(f * w)) - 1.0, w.dot(&(f * u)));
    compare("l2", roll.l2, l2)?;
    compare("gamma", roll.gamma, gamma)?;
    compare("the lean of lines along the axis", Some(0.0), u.dot(&(f * w)))?;
    if roll.lateral != "free" {
        compare("l2 that is held", Some(held[0]), l2)?;
    }
    if roll.shear != "free" {
        compare("gamma that is held", Some(held[1]), gamma)?;
    }
    if (curvature > 0.0) != (roll.axis == "below") {
        return Err(format!("the axis is {}, and the curvature {curvature:?}", roll.axis));
    }
    Ok(largest)
}

/// What may change of the lattice. Where κ is free: κ with the sign of the axis, then the length along u, and what is left to the sheet. Where κ
/// is given: the same without it; of a length along the axis, that comes first.
fn rates(roll: &Roll, start: &Sheet) -> Vec<Rate> {
    let (u, w) = axes(roll.direction_deg);
    let sign = if roll.axis == "below" { 1.0 } else { -1.0 };
    let rate = |to: Vector2<f64>, of: Vector2<f64>| Rate {
        lattice: start.lattice.map(|a| (to * of.dot(&a.xy())).push(0.0)),
        turn_rad: [0.0; 2],
    };
    let mut out = vec![rate(u, u)];
    out.extend((roll.lateral == "free").then(|| rate(w, w)));
    out.extend((roll.shear == "free").then(|| rate(w, u)));
    let sense = if roll.sought == "shortest" { -1.0 } else { 1.0 };
    match roll.sought.as_str() {
        "shortest" | "longest" if out.len() > 1 => {
            let length = out.remove(1);
            out.insert(0, Rate { lattice: length.lattice.map(|a| a * sense), ..length });
        }
        "roomiest" | "narrowest" | "widest" => {}
        _ => {
            let turn_rad = start.lattice.map(|a| sign * u.dot(&a.xy()));
            out.insert(0, Rate { lattice: [Vec3::zeros(); 2], turn_rad });
        }
    }
    out
}
