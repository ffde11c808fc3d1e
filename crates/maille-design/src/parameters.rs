//! Named parameters of a design, and how they are computed from each other.

use crate::{
    error::{InvalidInput, nearest},
    formula::{Formula, NoFormula},
};
use serde::{Deserialize, Serialize};

/// Names of columns of tables, and of the numbers that studies vary: no parameter can have one of these.
pub const TAKEN: [&str; 54] = [
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
    "extreme",
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
    "spacing",
    "status",
    "stretch1",
    "stretch2",
    "wall_s",
    "wave_curvature",
    "wave_q1",
    "wave_q2",
    "zero_modes",
];

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

    pub(super) fn field(&self) -> String {
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
#[derive(Clone, Copy)]
enum Step {
    Waiting,
    Begun,
    Done(Option<f64>),
}

/// Values of parameters while they are computed from each other.
pub(super) struct Computation<'a> {
    parameters: &'a [Parameter],
    steps: Vec<Step>,
    /// Names on the way from the one that was asked for.
    path: Vec<&'a str>,
    /// What is wrong.
    pub problems: Vec<InvalidInput>,
}

impl<'a> Computation<'a> {
    pub fn new(parameters: &'a [Parameter]) -> Self {
        Self { parameters, steps: vec![Step::Waiting; parameters.len()], path: Vec::new(), problems: Vec::new() }
    }

    /// The value of parameter `i`; `None` once something is wrong with it.
    pub fn value(&mut self, i: usize) -> Option<f64> {
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
    pub fn of_formula(&mut self, field: &str, text: &str) -> Option<f64> {
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

/// The error of a name that no parameter has.
pub(super) fn unknown(field: &str, name: &str, parameters: &[Parameter]) -> InvalidInput {
    let known: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    let help = match nearest(name, &known) {
        Some(near) => format!("did you mean {near}?"),
        None if known.is_empty() => format!("write a number, as 1.0, or give [parameters] with {name} = 1.0"),
        None => format!("its parameters are {}", known.join(", ")),
    };
    InvalidInput::new(field, format!("{name} is no parameter of the design"), help)
}
