//! A design's numbers as formulas over its parameters: computed anew, checked, and dropped where they no longer hold.

use crate::{
    Design, InvalidInput,
    formula::{Formula, is_name, is_reserved},
    parameters::{Computation, Parameter, TAKEN, unknown},
};
use std::collections::BTreeMap;

/// Most parameters of a design: it bounds how long a chain of them can be.
const MOST: usize = 500;
/// How far a number may be from its formula's, as a part of it or of the reference radius: sines differ between machines.
const AGREE: f64 = 1e-9;

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
    /// # use maille_design::{Design, Parameter};
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
        let mut all = Computation::new(&self.parameters);
        for i in 0..self.parameters.len() {
            all.problems.extend(self.wrong_name(i));
            if let Some(value) = all.value(i) {
                out.parameters[i].value = value;
            }
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
            "curve_tolerance" => return self.curve_tolerance.as_mut(),
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
        if let Some((curve, of_curve)) = rest.strip_prefix("curves").and_then(|rest| rest.split_once('.')) {
            let curve = element.curves.get_mut(indexed(curve)?.1)?;
            if let Some((form, number)) = of_curve.split_once('.') {
                return (curve.shape.name() == form).then(|| curve.shape.number_mut(number))?;
            }
            return match of_curve {
                "minor_radius" => curve.minor_radius.as_mut(),
                _ => match indexed(of_curve)? {
                    ("normal", axis) => curve.normal.get_mut(axis),
                    ("along", axis) => curve.along.get_mut(axis),
                    ("offset", axis) => curve.offset.get_mut(axis),
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
