//! Named parameters of a design, and the formulas that give its numbers.

use super::{Design, SPACING};
use crate::{
    error::{InvalidInput, nearest},
    formula::{Formula, NoFormula, is_name, is_reserved},
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Most parameters of a design: it bounds how long a chain of them can be.
const MOST: usize = 500;

/// Names of columns of tables, and of the numbers that studies vary: no parameter can have one of these.
pub const TAKEN: [&str; 53] = [
    SPACING,
    "a1_x",
    "a1_y",
    "a2_x",
    "a2_y",
    "better_chance",
    "bound_gap",
    "bound_kind",
    "bound_l1",
    "by_cell",
    "cell",
    "complementarity",
    "design",
    "direction",
    "direction_deg",
    "dual_residual",
    "end",
    "grows_with_cell",
    "image_of_deg",
    "iterations",
    "l1",
    "l1_uncertified",
    "l2",
    "l2_max",
    "l2_min",
    "lambda1",
    "lambda2",
    "lateral",
    "links_ok",
    "max_overlap",
    "method",
    "min_curvature",
    "min_gap",
    "min_multiplier",
    "minor_radius",
    "n_distinct",
    "n_starts",
    "own_image_force",
    "r",
    "record",
    "reference_radius",
    "runs",
    "shear",
    "shear_max",
    "shear_min",
    "status",
    "stretch1",
    "stretch2",
    "wall_s",
    "wave_curvature",
    "wave_q1",
    "wave_q2",
    "zero_modes",
];
/// How far a number may be from its formula's, as a part of it or of the reference radius: sines differ between machines.
const AGREE: f64 = 1e-9;

/// A named number of a design: given, and then free to change between its bounds, or computed from others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Unique in the design: letters, digits and `_`.
    pub name: String,
    /// Its value, in the unit of whatever it is used for; a computed one's is that of its formula.
    pub value: f64,
    /// How it is computed from others; such a parameter is not free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// Least value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
}

impl Parameter {
    /// Whether it can be set.
    pub fn is_free(&self) -> bool {
        self.formula.is_none()
    }

    fn field(&self) -> String {
        format!("parameters.{}", self.name)
    }

    /// What is wrong with its value or its bounds.
    fn problem(&self) -> Option<InvalidInput> {
        let wrong = |problem: String, help: &str| Some(InvalidInput::new(self.field(), problem, help));
        if let (Some(min), Some(max)) = (self.min, self.max)
            && min >= max
        {
            return wrong(format!("min = {min} is not below max = {max}"), "give a smaller min");
        }
        if [self.min, self.max].into_iter().flatten().any(|x| x.is_nan()) {
            return wrong("a bound is not a number".into(), "give a number, or leave the bound out");
        }
        if !self.value.is_finite() {
            return wrong(format!("its value {} is not finite", self.value), "give finite numbers");
        }
        let below = self.min.filter(|min| self.value < *min).map(|min| format!("below min = {min}"));
        let above = self.max.filter(|max| self.value > *max).map(|max| format!("above max = {max}"));
        let of = if self.is_free() { "give a value between the bounds" } else { "change what it is computed from" };
        wrong(format!("{} is {}", self.value, below.or(above)?), &format!("{of}, or widen them"))
    }
}

/// A parameter on the way to its value.
enum Step {
    Waiting,
    Begun,
    Done(Option<f64>),
}

/// Values of parameters while they are computed from each other.
struct Computation<'a> {
    parameters: &'a [Parameter],
    steps: Vec<Step>,
    /// Names on the way from the one that was asked for.
    path: Vec<&'a str>,
    problems: Vec<InvalidInput>,
}

impl<'a> Computation<'a> {
    /// The value of parameter `i`; `None` once something is wrong with it.
    fn value(&mut self, i: usize) -> Option<f64> {
        let parameter = &self.parameters[i];
        match self.steps[i] {
            Step::Done(value) => return value,
            Step::Begun => {
                let from = self.path.iter().position(|name| *name == parameter.name).unwrap_or(0);
                let round = [&self.path[from..], &[&parameter.name]].concat().join(" → ");
                let problem = format!("is computed from itself: {round}");
                self.problems.push(InvalidInput::new(parameter.field(), problem, "give one of them a number"));
                return None;
            }
            Step::Waiting => {}
        }
        self.steps[i] = Step::Begun;
        self.path.push(&parameter.name);
        let value = match &parameter.formula {
            None => Some(parameter.value),
            Some(text) => self.of_formula(&parameter.field(), text),
        };
        self.path.pop();
        let value = value.filter(|value| {
            let problem = Parameter { value: *value, ..parameter.clone() }.problem();
            let right = problem.is_none();
            self.problems.extend(problem);
            right
        });
        self.steps[i] = Step::Done(value);
        value
    }

    /// The value of the formula at `field`.
    fn of_formula(&mut self, field: &str, text: &str) -> Option<f64> {
        let formula = match Formula::parse(text) {
            Ok(formula) => formula,
            Err(NoFormula { problem, help }) => {
                self.problems.push(InvalidInput::new(field, problem, help));
                return None;
            }
        };
        let mut values = Vec::new();
        for name in formula.names() {
            match self.parameters.iter().position(|p| p.name == name) {
                Some(i) => values.push((name, self.value(i))),
                None => {
                    self.problems.push(unknown(field, name, self.parameters));
                    values.push((name, None));
                }
            }
        }
        let value = formula.value(&|name| values.iter().find(|known| known.0 == name)?.1)?;
        if !value.is_finite() {
            let with: Vec<String> = values.iter().filter_map(|(n, v)| Some(format!("{n} = {}", (*v)?))).collect();
            let with = if with.is_empty() { String::new() } else { format!(" with {}", with.join(", ")) };
            let problem = format!("\"{text}\" is {value}{with}");
            let help = "a formula must give a finite number: no division by 0, no root of a negative number";
            self.problems.push(InvalidInput::new(field, problem, help));
        }
        Some(value).filter(|x| x.is_finite())
    }
}

fn unknown(field: &str, name: &str, parameters: &[Parameter]) -> InvalidInput {
    let known: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let help = match nearest(name, &known) {
        Some(near) => format!("did you mean {near}?"),
        None if known.is_empty() => format!("write a number, as 1.0, or give [parameters] with {name} = 1.0"),
        None => format!("its parameters are {}", known.join(", ")),
    };
    InvalidInput::new(field, format!("{name} is no parameter of the design"), help)
}

impl Design {
    /// The parameters that can be set, in the order of the file.
    pub fn free_parameters(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|p| p.is_free())
    }

    /// The same design with other values of free parameters: all that is computed from them is computed anew. Parameters
    /// that are not named keep their values.
    ///
    /// Refused are names that are no free parameter or are set twice, values out of bounds, and values with which the design has
    /// [`problems`](Design::problems).
    ///
    /// ```
    /// # use maille::design::{Design, Parameter};
    /// # let design = maille_io::read_design("1.1", maille_io::builtin("1.1").unwrap()).unwrap();
    /// let wire = Parameter { name: "wire".into(), value: 0.2, formula: None, min: Some(0.1), max: None };
    /// let formulas = [("minor_radius".to_owned(), "wire / 2".to_owned())].into();
    /// let design = Design { parameters: vec![wire], formulas, ..design };
    /// assert_eq!(design.with_parameters(&[("wire", 0.15)]).unwrap().minor_radius, Some(0.075));
    /// assert!(design.with_parameters(&[("wire", 0.05)]).is_err());
    /// ```
    pub fn with_parameters(&self, values: &[(&str, f64)]) -> Result<Self, Vec<InvalidInput>> {
        let mut out = self.clone();
        let mut problems = Vec::new();
        for (i, (name, value)) in values.iter().enumerate() {
            let field = format!("parameters.{name}");
            if values[..i].iter().any(|(other, _)| other == name) {
                problems.push(InvalidInput::new(field, "is set twice", "set it once"));
                continue;
            }
            match out.parameters.iter_mut().find(|p| p.name == *name) {
                Some(parameter) if parameter.is_free() => parameter.value = *value,
                Some(Parameter { formula, .. }) => {
                    let problem = format!("is computed as \"{}\"", formula.as_deref().unwrap_or_default());
                    problems.push(InvalidInput::new(field, problem, "set what it is computed from"));
                }
                None if self.parameters.is_empty() => {
                    let problem = format!("{} has no parameter {name}", self.name);
                    let help = "a design with parameters names them in its table [parameters]";
                    problems.push(InvalidInput::new(field, problem, help));
                }
                None => problems.push(unknown(&field, name, &self.parameters)),
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        let out = out.evaluated()?;
        let problems = out.problems_of_fields();
        if problems.is_empty() { Ok(out) } else { Err(problems) }
    }

    /// The same design with all its formulas computed anew from its free parameters.
    ///
    /// Refused are names that occur twice or mean something else, formulas that cannot be read or name what is not there,
    /// parameters that are computed from themselves, values that are not finite or out of bounds.
    pub fn evaluated(&self) -> Result<Self, Vec<InvalidInput>> {
        let mut out = self.clone();
        if self.parameters.is_empty() && self.formulas.is_empty() {
            return Ok(out);
        }
        if self.parameters.len() > MOST {
            let problem = format!("{} parameters are too many", self.parameters.len());
            return Err(vec![InvalidInput::new("parameters", problem, format!("{MOST} is most"))]);
        }
        let steps = self.parameters.iter().map(|_| Step::Waiting).collect();
        let mut all = Computation { parameters: &self.parameters, steps, path: Vec::new(), problems: Vec::new() };
        for (i, parameter) in self.parameters.iter().enumerate() {
            all.problems.extend(self.wrong_name(i));
            if let Some(value) = all.value(i) {
                out.parameters[i].value = value;
            }
            debug_assert!(parameter.is_free() || all.path.is_empty());
        }
        for (place, text) in &self.formulas {
            let value = all.of_formula(place, text);
            match (out.number_mut(place), value) {
                (Some(number), Some(value)) => *number = value,
                (Some(_), None) => {}
                (None, _) => {
                    let help = "name one of its numbers, as lattice.a1[0]";
                    let problem = format!("the design has no number {place}");
                    all.problems.push(InvalidInput::new("formulas", problem, help));
                }
            }
        }
        if all.problems.is_empty() { Ok(out) } else { Err(all.problems) }
    }

    /// What is wrong with the name of parameter `i`.
    fn wrong_name(&self, i: usize) -> Option<InvalidInput> {
        let Parameter { name, .. } = &self.parameters[i];
        let wrong = |problem: String, help: &str| Some(InvalidInput::new(format!("parameters.{name}"), problem, help));
        if !is_name(name) {
            let help = "letters, digits and _, as ring_radius, not with a digit first";
            return wrong(format!("\"{name}\" cannot be the name of a parameter"), help);
        }
        if is_reserved(name) {
            return wrong(format!("{name} means something else in formulas"), "give it another name");
        }
        if TAKEN.contains(&name.as_str()) {
            let problem = format!("{name} is the name of a column of tables, or of a number that studies vary");
            return wrong(problem, "give it another name");
        }
        let twice = self.parameters[..i].iter().any(|p| p.name == *name);
        twice.then(|| wrong("is there twice".into(), "give every parameter a name of its own")).flatten()
    }

    /// What is wrong with parameters and formulas: they cannot be evaluated, or a number is not what its formula gives.
    pub(super) fn problems_of_formulas(&self) -> Vec<InvalidInput> {
        let mut anew = match self.evaluated() {
            Ok(anew) => anew,
            Err(problems) => return problems,
        };
        let mut own = self.clone();
        let least = self.reference_radius.abs();
        let wrong = |field: String, number: f64, formula: &str, value: f64| {
            let differs = (number - value).abs() > AGREE * number.abs().max(least) || number.is_nan();
            let problem = format!("is {number}, but its formula \"{formula}\" gives {value}");
            let help = "take the formula's number, or leave the formula out";
            differs.then(|| InvalidInput::new(field, problem, help))
        };
        let parameters = self.parameters.iter().zip(&anew.parameters);
        let mut out: Vec<_> =
            parameters.filter_map(|(p, new)| wrong(p.field(), p.value, p.formula.as_deref()?, new.value)).collect();
        for (place, formula) in &self.formulas {
            let numbers = own.number_mut(place).copied().zip(anew.number_mut(place).copied());
            out.extend(numbers.and_then(|(number, value)| wrong(place.clone(), number, formula, value)));
        }
        out
    }

    /// The same design without the formulas that no longer give the number at their place, because that was changed by other
    /// means. Parameters that only these used go with them.
    ///
    /// A number may differ from its formula by four units of the last place: another machine's sine does.
    pub fn settled(mut self) -> Self {
        if self.formulas.is_empty() {
            return self;
        }
        let Ok(mut anew) = self.evaluated() else {
            (self.parameters, self.formulas) = (Vec::new(), BTreeMap::new());
            return self;
        };
        // Free parameters are as they are; what is computed from them may have been changed.
        self.parameters.clone_from(&anew.parameters);
        let formulas = std::mem::take(&mut self.formulas);
        let count = formulas.len();
        for (place, text) in formulas {
            let numbers = self.number_mut(&place).zip(anew.number_mut(&place));
            if numbers.is_some_and(|(a, b)| (*a - *b).abs() <= 4.0 * f64::EPSILON * a.abs()) {
                self.formulas.insert(place, text);
            }
        }
        if self.formulas.len() == count {
            return self;
        }
        loop {
            let unused: Vec<String> = self.unused_parameters().map(|p| p.name.clone()).collect();
            if unused.is_empty() {
                return self;
            }
            self.parameters.retain(|p| !unused.contains(&p.name));
        }
    }

    /// The parameters on which nothing depends.
    pub fn unused_parameters(&self) -> impl Iterator<Item = &Parameter> {
        let formulas = self.parameters.iter().filter_map(|p| p.formula.as_ref()).chain(self.formulas.values());
        let used: Vec<String> = formulas
            .filter_map(|text| Formula::parse(text).ok())
            .flat_map(|formula| formula.names().into_iter().map(str::to_owned).collect::<Vec<_>>())
            .collect();
        self.parameters.iter().filter(move |p| !used.contains(&p.name))
    }

    /// The number at a place such as `elements[2].rings[0].normal[1]`.
    fn number_mut(&mut self, place: &str) -> Option<&mut f64> {
        if let Some(axis) = place.strip_prefix("lattice.") {
            let (name, axis) = indexed(axis)?;
            let vector = match name {
                "a1" => &mut self.lattice.a1,
                "a2" => &mut self.lattice.a2,
                _ => return None,
            };
            return vector.get_mut(axis);
        }
        match place {
            "minor_radius" => return self.minor_radius.as_mut(),
            "reference_radius" => return Some(&mut self.reference_radius),
            _ => {}
        }
        let (element, rest) = place.strip_prefix("elements")?.split_once('.')?;
        let element = self.elements.get_mut(indexed(element)?.1)?;
        if let Some((ring, of_ring)) = rest.strip_prefix("rings").and_then(|rest| rest.split_once('.')) {
            let ring = element.rings.get_mut(indexed(ring)?.1)?;
            return match of_ring {
                "major_radius" => Some(&mut ring.major_radius),
                "minor_radius" => ring.minor_radius.as_mut(),
                _ => match indexed(of_ring)? {
                    ("normal", axis) => ring.normal.get_mut(axis),
                    ("offset", axis) => ring.offset.get_mut(axis),
                    _ => None,
                },
            };
        }
        match indexed(rest)? {
            ("center", axis) => element.center.get_mut(axis),
            _ => None,
        }
    }
}

/// `a1[0]` as a name and an index.
fn indexed(text: &str) -> Option<(&str, usize)> {
    let (name, index) = text.strip_suffix(']')?.split_once('[')?;
    Some((name, index.parse().ok()?))
}
