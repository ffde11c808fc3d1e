//! Studies: which maps of which designs, in one TOML file.

use crate::{
    design_toml::{NumberPath, set_parameters},
    numbers::{Numbers, parse, parse_l2},
    quantity::Quantity,
    run::Map,
    text_error::TextError,
};
use maille::{
    design::Design,
    error::InvalidInput,
    lattice::Across,
    question::Effort,
    search::ExactOptions,
    sheet::Sheet,
    survey::{CellChoice, MapQuestion, Method},
};
use serde::Deserialize;
use std::{collections::BTreeMap, ops::Range, path::PathBuf};
use toml::Spanned;

/// What `maille sweep` computes: each design, at each of its radii and spacings, over all directions and l2.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The designs.
    pub designs: Vec<StudyDesign>,
}

/// A design of a study, with the values that its parameters take.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyDesign {
    /// A built-in design, or a file, relative to the study's folder.
    pub design: String,
    /// Name of its records, before the parameters; `None`: that of the design.
    pub name: Option<String>,
    /// What is asked of it.
    pub question: MapQuestion,
    /// Minor radii in the design's unit; empty: the design's own.
    pub minor_radius: Vec<f64>,
    /// Factors of all distances between elements; empty: as designed.
    pub spacing: Vec<f64>,
    /// Other numbers of the design, by their places, with the values that they take.
    pub vary: Vec<(NumberPath, Vec<f64>)>,
    /// Whether values with which the links are not those of the design are left out.
    pub keep_links: bool,
}

/// A design of a study at one value of each parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// What it adds to the design's name, as `-r0.05-s0.95`.
    pub suffix: String,
    /// Minor radius in the design's unit; `None`: the design's own.
    pub minor_radius: Option<f64>,
    /// Factor of all distances between elements; `None`: as designed.
    pub spacing: Option<f64>,
    /// Other numbers of the design, in the order in which they are set, before the spacing.
    pub numbers: Vec<(NumberPath, f64)>,
    /// Whether it must have the links of the design.
    pub keep_links: bool,
}

impl Variant {
    /// The design with its parameters. Refused where it has no such number, or other links than it must have.
    pub fn of(&self, design: &Design) -> Result<Design, Vec<InvalidInput>> {
        let varied = self.varied(design)?;
        if self.keep_links {
            let links = |design: &Design| Ok::<_, Vec<InvalidInput>>(Sheet::compile(design)?.model().links.clone());
            let (own, wanted) = (links(&varied)?, links(design)?);
            if own != wanted {
                let problem = match (own.len(), wanted.len()) {
                    (own, wanted) if own == wanted => "rings are linked otherwise than in the file".to_owned(),
                    (own, wanted) => format!("there are {own} links per cell, {wanted} in the file"),
                };
                let help = "leave the value out, or leave out keep_links: the limits are then those of another weave";
                return Err(vec![InvalidInput::new("elements", problem, help)]);
            }
        }
        Ok(varied)
    }

    /// Its parameters are set first and at once: what the others set is no longer given by a formula.
    fn varied(&self, design: &Design) -> Result<Design, Vec<InvalidInput>> {
        let parameters = self.numbers.iter().filter_map(|(path, value)| Some((path.parameter()?, *value)));
        let parameters: Vec<_> = parameters.collect();
        let mut out = if parameters.is_empty() { design.clone() } else { set_parameters(design, &parameters)? };
        if let Some(r) = self.minor_radius {
            out = out.with_minor_radius(r);
        }
        for (path, value) in self.numbers.iter().filter(|(path, _)| path.parameter().is_none()) {
            out = path.set(&out, *value).map_err(|problem| vec![problem])?;
        }
        Ok(self.spacing.map_or(out.clone(), |factor| out.spaced(factor)))
    }

    /// The parameters in words, as `minor_radius = 0.05, spacing = 0.95`; `None` where nothing is changed.
    pub fn words(&self) -> Option<String> {
        let mut words: Vec<String> = self.minor_radius.map(|r| format!("minor_radius = {r}")).into_iter().collect();
        words.extend(self.numbers.iter().map(|(path, value)| format!("{path} = {value}")));
        words.extend(self.spacing.map(|s| format!("spacing = {s}")));
        (!words.is_empty()).then(|| words.join(", "))
    }
}

impl StudyDesign {
    /// The map of each of its variants, with the record in `out`.
    pub fn map(&self, out: Option<PathBuf>, overwrite: bool) -> Map {
        Map { question: self.question.clone(), quantity: Quantity::Stretch, out, overwrite, sensitivities: false }
    }

    /// Every radius with every value of the other numbers and every spacing; a design without values of a parameter keeps its own.
    pub fn variants(&self) -> Vec<Variant> {
        let some = |values: &[f64]| match values {
            [] => vec![None],
            _ => values.iter().copied().map(Some).collect::<Vec<_>>(),
        };
        let mut out = Vec::new();
        for minor_radius in some(&self.minor_radius) {
            for numbers in self.combinations() {
                for spacing in some(&self.spacing) {
                    let mut suffix = minor_radius.map(|r| format!("-r{r}")).unwrap_or_default();
                    suffix.extend(numbers.iter().map(|(path, value)| format!("-{}{value}", path.label())));
                    suffix.extend(spacing.map(|s| format!("-s{s}")));
                    let numbers = numbers.clone();
                    out.push(Variant { suffix, minor_radius, spacing, numbers, keep_links: self.keep_links });
                }
            }
        }
        out
    }

    /// Every value of each number with every value of the others, the last one changing fastest.
    fn combinations(&self) -> Vec<Vec<(NumberPath, f64)>> {
        let mut out = vec![Vec::new()];
        for (path, values) in &self.vary {
            let with = |numbers: &Vec<(NumberPath, f64)>| {
                let one = |value: &f64| numbers.iter().cloned().chain([(path.clone(), *value)]).collect();
                values.iter().map(one).collect::<Vec<Vec<_>>>()
            };
            out = out.iter().flat_map(with).collect();
        }
        out
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStudy {
    directions: Option<Spanned<List>>,
    l2: Option<Spanned<List>>,
    lateral: Option<Spanned<Held>>,
    shear: Option<Spanned<Held>>,
    compression: Option<Spanned<bool>>,
    keep_links: Option<bool>,
    cell: Option<Spanned<String>>,
    effort: Option<Spanned<String>>,
    starts: Option<Spanned<i64>>,
    seed: Option<Spanned<i64>>,
    designs: Spanned<Vec<RawDesign>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDesign {
    design: Spanned<String>,
    name: Option<String>,
    directions: Option<Spanned<List>>,
    l2: Option<Spanned<List>>,
    lateral: Option<Spanned<Held>>,
    shear: Option<Spanned<Held>>,
    compression: Option<Spanned<bool>>,
    keep_links: Option<bool>,
    minor_radius: Option<Spanned<List>>,
    spacing: Option<Spanned<List>>,
    #[serde(default)]
    vary: BTreeMap<String, Spanned<List>>,
}

/// Whether a strain is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Held {
    Fixed,
    Free,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "this is neither a number, nor a list such as [0.05, 0.1], nor a range such as \"0:180:15\""
)]
enum List {
    One(f64),
    Several(Vec<f64>),
    Text(String),
}

impl List {
    /// As it would stand on the command line, where the rules of lists are kept.
    fn text(&self) -> String {
        match self {
            List::One(x) => x.to_string(),
            List::Several(list) => list.iter().map(f64::to_string).collect::<Vec<_>>().join(","),
            List::Text(text) => text.clone(),
        }
    }
}

const HELP: &str = "a study has cell, effort, starts, seed, and [[designs]] with design, name, minor_radius, spacing, vary; directions, l2, \
                    lateral, shear, compression and keep_links stand in either; `maille sweep --example` prints one";

impl Study {
    /// Reads a study; `source_name` is what errors show.
    ///
    /// ```
    /// let study = maille_io::study::Study::read(
    ///     "radius.toml",
    ///     "directions = [0, 45]\n[[designs]]\ndesign = \"1.1\"\nminor_radius = \"0.05:0.1:0.05\"\n",
    /// ).unwrap();
    /// assert_eq!(study.designs[0].minor_radius, [0.05, 0.1]);
    /// ```
    pub fn read(source_name: &str, text: &str) -> Result<Study, TextError> {
        let wrong = |Wrong { problem, help, span }| TextError::new(source_name, text, span, problem, help);
        Self::parsed(text).map_err(wrong)
    }

    fn parsed(text: &str) -> Result<Study, Wrong> {
        let raw: RawStudy = toml::from_str(text).map_err(|error| Wrong {
            problem: error.message().to_owned(),
            help: HELP.into(),
            span: error.span().unwrap_or_default(),
        })?;
        if raw.designs.get_ref().is_empty() {
            return Err(wrong(&raw.designs, "the study has no design", "add [[designs]] with design = \"1.1\""));
        }
        let base = raw.options()?;
        let designs = raw.designs.get_ref().iter().map(|design| design.read(&raw, &base));
        Ok(Study { designs: designs.collect::<Result<_, _>>()? })
    }
}

impl RawStudy {
    /// What all designs share: cells, effort, starts and seed.
    fn options(&self) -> Result<(CellChoice, ExactOptions), Wrong> {
        let cell = match &self.cell {
            Some(cell) => cell.get_ref().parse().map_err(|e: InvalidInput| wrong(cell, e.problem, e.help))?,
            None => CellChoice::Auto,
        };
        let options = ExactOptions {
            effort: self.effort.as_ref().map(effort).transpose()?.unwrap_or_default(),
            starts: self.starts.as_ref().map(|n| whole(n, 1)).transpose()?.map(|n| n as usize),
            seed: self.seed.as_ref().map(|n| whole(n, 0)).transpose()?.unwrap_or(1),
            ..ExactOptions::default()
        };
        if let (Some(lateral), Some(l2)) = (&self.lateral, &self.l2) {
            held_and_free(lateral, l2)?;
        }
        Ok((cell, options))
    }
}

/// Refuses l2 beside a width that is left to the sheet.
fn held_and_free(lateral: &Spanned<Held>, l2: &Spanned<List>) -> Result<(), Wrong> {
    match lateral.get_ref() {
        Held::Free => {
            Err(wrong(l2, "l2 holds the width that lateral = \"free\" leaves to the sheet", "leave one of them out"))
        }
        Held::Fixed => Ok(()),
    }
}

impl RawDesign {
    /// The design with what is asked of it: what it does not say itself is that of the study.
    fn read(&self, study: &RawStudy, (cell, options): &(CellChoice, ExactOptions)) -> Result<StudyDesign, Wrong> {
        let mut vary = Vec::new();
        for (path, values) in &self.vary {
            let path = path.parse::<NumberPath>().map_err(|e| wrong(values, e.problem, e.help))?;
            vary.push((path, numbers(values, parse)?));
        }
        Ok(StudyDesign {
            design: self.design.get_ref().clone(),
            name: self.name.clone(),
            question: self.question(study, cell, options)?,
            minor_radius: self.minor_radius.as_ref().map(positive).transpose()?.unwrap_or_default(),
            spacing: self.spacing.as_ref().map(positive).transpose()?.unwrap_or_default(),
            vary,
            keep_links: self.keep_links.or(study.keep_links).unwrap_or(false),
        })
    }

    fn question(&self, study: &RawStudy, cell: &CellChoice, options: &ExactOptions) -> Result<MapQuestion, Wrong> {
        let free = |own: &Option<Spanned<Held>>, of_study: &Option<Spanned<Held>>| {
            own.as_ref().or(of_study.as_ref()).is_some_and(|held| *held.get_ref() == Held::Free)
        };
        let across =
            Across { lateral_free: free(&self.lateral, &study.lateral), shear_free: free(&self.shear, &study.shear) };
        if let (Some(lateral), Some(l2)) = (self.lateral.as_ref().or(study.lateral.as_ref()), &self.l2) {
            held_and_free(lateral, l2)?;
        }
        let compression = self.compression.as_ref().or(study.compression.as_ref()).is_some_and(|own| *own.get_ref());
        let directions = self.directions.as_ref().or(study.directions.as_ref());
        let directions_deg = directions.map(|list| numbers(list, parse)).transpose()?;
        let l2 = self.l2.as_ref().or(study.l2.as_ref()).filter(|_| !across.lateral_free);
        let l2 = l2.map(|list| numbers(list, parse_l2)).transpose()?;
        Ok(MapQuestion {
            method: Method::Exact(ExactOptions { across, compression, ..options.clone() }),
            cells: cell.clone(),
            directions_deg: directions_deg.unwrap_or_else(|| (0..=180).step_by(15).map(f64::from).collect()),
            l2: l2.unwrap_or_else(|| vec![0.0]),
            extremes: false,
        })
    }
}

fn effort(text: &Spanned<String>) -> Result<Effort, Wrong> {
    text.get_ref().parse().map_err(|e: InvalidInput| wrong(text, e.problem, e.help))
}

fn numbers(list: &Spanned<List>, read: fn(&str) -> Result<Numbers, String>) -> Result<Vec<f64>, Wrong> {
    read(&list.get_ref().text()).map(|numbers| numbers.0).map_err(|problem| wrong(list, problem, HELP))
}

fn positive(list: &Spanned<List>) -> Result<Vec<f64>, Wrong> {
    let values = numbers(list, parse)?;
    match values.iter().find(|x| **x <= 0.0) {
        Some(x) => Err(wrong(list, format!("{x} is not positive"), "give numbers above 0")),
        None => Ok(values),
    }
}

fn whole(number: &Spanned<i64>, least: u64) -> Result<u64, Wrong> {
    let n = *number.get_ref();
    let small = || wrong(number, format!("{n} is too small"), format!("give a whole number from {least}"));
    u64::try_from(n).ok().filter(|n| *n >= least).ok_or_else(small)
}

#[derive(Debug)]
struct Wrong {
    problem: String,
    help: String,
    span: Range<usize>,
}

fn wrong<T>(at: &Spanned<T>, problem: impl Into<String>, help: impl Into<String>) -> Wrong {
    Wrong { problem: problem.into(), help: help.into(), span: at.span() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_and_forms_of_lists() {
        let text =
            "l2 = \"-0.25:0:0.125\"\n[[designs]]\ndesign = \"1.1\"\nspacing = 1\n[[designs]]\ndesign = \"a.toml\"\n";
        let study = Study::read("s", text).unwrap();
        let MapQuestion { method, cells, directions_deg, l2, .. } = &study.designs[0].question;
        assert_eq!((directions_deg.len(), l2.len(), cells), (13, 3, &CellChoice::Auto));
        assert_eq!(*method, Method::Exact(ExactOptions::default()));
        assert_eq!(study.designs[0].spacing, [1.0]);
        assert!(study.designs[1].minor_radius.is_empty());
    }

    /// What a design says itself holds for it alone; a width that is left to the sheet needs no l2.
    #[test]
    fn designs_may_be_asked_different_things() {
        let text = "directions = [0, 45]\nl2 = [-0.1, 0]\nshear = \"free\"\nstarts = 3\n\
                    [[designs]]\ndesign = \"1.1\"\n\
                    [[designs]]\ndesign = \"1.1\"\nname = \"free\"\nlateral = \"free\"\ndirections = 30\n\
                    [[designs]]\ndesign = \"1.1\"\nname = \"pushed\"\ncompression = true\nshear = \"fixed\"\nl2 = 0.1\n";
        let found = Study::read("s", text).unwrap().designs;
        let asked = |k: usize| {
            let MapQuestion { method, directions_deg, l2, .. } = &found[k].question;
            let Method::Exact(options) = method else { panic!("studies use the exact method") };
            let Across { lateral_free, shear_free } = options.across;
            assert_eq!(options.starts, Some(3));
            (directions_deg.clone(), l2.clone(), [lateral_free, shear_free, options.compression])
        };
        assert_eq!(asked(0), (vec![0.0, 45.0], vec![-0.1, 0.0], [false, true, false]));
        assert_eq!(asked(1), (vec![30.0], vec![0.0], [true, true, false]));
        assert_eq!(asked(2), (vec![0.0, 45.0], vec![0.1], [false, false, true]));
        assert_eq!(found[1].name.as_deref(), Some("free"));
    }

    /// The radius of the standing rings, as in Figure 6.11, and a height: every value with every other.
    #[test]
    fn any_number_of_a_design_is_a_parameter() {
        let text = "[[designs]]\ndesign = \"1.1\"\nspacing = 2\n[designs.vary]\n\
                    \"elements.standing-*.rings.major_radius\" = \"0.5:1:0.25\"\n\"elements.flat.center.z\" = [-0.1, 0.1]\n";
        let study = Study::read("s", text).unwrap();
        let variants = study.designs[0].variants();
        assert_eq!(variants.len(), 6);
        assert_eq!(variants[0].suffix, "-flat-center-z-0.1-standing-major_radius0.5-s2");
        let design = crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap();
        let varied = variants[4].of(&design).unwrap();
        assert_eq!((varied.elements[2].rings[0].major_radius, varied.elements[0].center[2]), (0.75, 0.2));
        assert_eq!(varied.lattice.a1[0], 5.0);
        let words = "elements.flat.center.z = 0.1, elements.standing-*.rings.major_radius = 0.75, spacing = 2";
        assert_eq!(variants[4].words().as_deref(), Some(words));
    }

    /// Rings of 1.1 that are far apart are not linked.
    #[test]
    fn values_with_other_links_can_be_left_out() {
        let text = "keep_links = true\n[[designs]]\ndesign = \"1.1\"\nspacing = [0.95, 1.8]\n";
        let study = Study::read("s", text).unwrap();
        let design = crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap();
        let variants = study.designs[0].variants();
        assert_eq!(variants[0].of(&design).map(|_| ()), Ok(()));
        let problem = &variants[1].of(&design).unwrap_err()[0].problem;
        assert_eq!(problem, "there are 0 links per cell, 4 in the file");
        let free = Study::read("s", &text.replace("keep_links = true", "")).unwrap();
        assert!(free.designs[0].variants()[1].of(&design).is_ok());
    }

    #[test]
    fn what_is_wrong_is_shown_at_its_place() {
        let cases = [
            ("directions = [0]", "missing field `designs`", None),
            ("designs = []", "no design", Some("[]")),
            ("angle = 3\n[[designs]]\ndesign = \"1.1\"", "unknown field `angle`", Some("angle")),
            ("l2 = -1\n[[designs]]\ndesign = \"1.1\"", "press the sheet to nothing", Some("-1")),
            ("lateral = \"free\"\nl2 = 0\n[[designs]]\ndesign = \"1.1\"", "leaves to the sheet", Some("0")),
            ("lateral = \"free\"\n[[designs]]\ndesign = \"1.1\"\nl2 = 3", "leaves to the sheet", Some("3")),
            ("[[designs]]\ndesign = \"1.1\"\nshear = \"none\"", "unknown variant `none`", Some("\"none\"")),
            ("cell = \"0x1\"\n[[designs]]\ndesign = \"1.1\"", "", Some("\"0x1\"")),
            ("starts = 0\n[[designs]]\ndesign = \"1.1\"", "too small", Some("0")),
            ("[[designs]]\ndesign = \"1.1\"\nspacing = [1.0, -2.0]", "-2 is not positive", Some("[1.0, -2.0]")),
            ("[[designs]]\ndesign = \"1.1\"\nminor_radius = true", "nor a range", Some("true")),
            ("[[designs]]\ndesign = \"1.1\"\nvary = { 4radius = 3 }", "names no number", Some("3")),
        ];
        for (text, problem, place) in cases {
            let error = Study::read("s", text).unwrap_err();
            assert!(error.to_string().contains(problem), "{text}: {error}");
            if let Some(place) = place {
                assert_eq!(error.at(), place, "{text}");
                let line = text.lines().position(|line| line.contains(place));
                assert_eq!(Some(error.line_column().0), line.map(|k| k + 1), "{text}");
            }
        }
    }
}
