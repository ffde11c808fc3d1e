//! Arithmetic over named numbers, as design files use it: `2.4 * radius + sin(deg(tilt))`.
//!
//! Numbers, names, `+ - * / ^`, parentheses, `pi`, and the functions of [`FUNCTIONS`]; angles are in radians. As on paper,
//! `-a^2` is `-(a^2)`, `a^b^c` is `a^(b^c)`, and operators of one rank are taken from the left.

use std::collections::BTreeSet;
use winnow::{
    ModalResult, Parser,
    ascii::{digit0, digit1, multispace0},
    combinator::{Infix, Prefix, cut_err, delimited, dispatch, expression, fail, opt, peek, preceded, separated},
    token::{any, one_of, take_while},
};

/// The functions, with the number of their arguments; `None`: two or more. `deg(x)` is x degrees in radians.
pub const FUNCTIONS: [(&str, Option<usize>); 11] = [
    ("sin", Some(1)),
    ("cos", Some(1)),
    ("tan", Some(1)),
    ("asin", Some(1)),
    ("acos", Some(1)),
    ("atan", Some(1)),
    ("sqrt", Some(1)),
    ("abs", Some(1)),
    ("deg", Some(1)),
    ("min", None),
    ("max", None),
];

/// The ratio of a circle's circumference to its diameter, as formulas name it.
pub const PI: &str = "pi";
/// Longest formula, in bytes.
const LONGEST: usize = 400;
/// Most of the signs that the reader follows into each other: it must not exhaust the stack.
const MOST_NESTED: usize = 40;
const HELP: &str = "write arithmetic, as 2 * radius + 0.1: + - * / ^ ( ), names of parameters, pi, and sin, cos, tan, asin, acos, \
                    atan (radians), deg, sqrt, abs, min, max";

/// A formula that can be evaluated many times.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula(Node);

/// Why a text is no formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoFormula {
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub help: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Name(String),
    Minus(Box<Node>),
    Both(Operator, Box<Node>, Box<Node>),
    Call(String, Vec<Node>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Formula {
    /// Reads a formula. Refused are what cannot be read, unknown functions and wrong numbers of arguments; names are not
    /// looked up yet.
    pub fn parse(text: &str) -> Result<Self, NoFormula> {
        let no = |problem: String, help: &str| Err(NoFormula { problem, help: help.into() });
        if text.trim().is_empty() {
            return no("the formula is empty".into(), HELP);
        }
        if text.len() > LONGEST {
            let help = "give parts of it a name in [parameters]";
            return no(format!("a formula of {} characters is too long; {LONGEST} is most", text.len()), help);
        }
        let nested = text.chars().filter(|c| "(+-^".contains(*c)).count();
        if nested > MOST_NESTED {
            let help = "give parts of it a name in [parameters]";
            return no(format!("a formula with {nested} of ( + - ^ is too long; {MOST_NESTED} is most"), help);
        }
        match delimited(multispace0, sum, multispace0).parse(text) {
            Ok(node) => node.check().map(|()| Formula(node)),
            Err(error) => {
                let (before, rest) = text.split_at(error.offset());
                let joined = !before.ends_with(char::is_whitespace);
                let (before, rest) = (before.trim(), rest.trim());
                match rest.chars().next() {
                    None => no(format!("\"{text}\" ends too early"), HELP),
                    Some(first) => {
                        let product = before.ends_with(|c: char| c.is_alphanumeric() || c == ')')
                            && (first.is_alphanumeric() || first == '_' || first == '(');
                        let help = match product {
                            true if joined && before.parse::<f64>().is_ok() && is_name(rest) => &format!(
                                "is an operator missing before {rest}, as *? if {rest} is a unit, write {before} without \
                                 quotes, and unit = \"{rest}\" at the top of the file: all its lengths are in it"
                            ),
                            true => &format!("is an operator missing before {rest}, as *?"),
                            false => HELP,
                        };
                        no(format!("\"{text}\" cannot be read from \"{rest}\" on"), help)
                    }
                }
            }
        }
    }

    /// The names that it uses.
    pub fn names(&self) -> BTreeSet<&str> {
        let mut out = BTreeSet::new();
        self.0.add_names(&mut out);
        out
    }

    /// Its value, with `of` giving the value of a name; `None` if that has none. Not finite where arithmetic is not: `1/0`.
    pub fn value(&self, of: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
        self.0.value(of)
    }
}

/// Whether a text can be the name of a parameter: letters, digits and `_`, not with a digit first.
pub fn is_name(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    text.starts_with(letter) && text.chars().all(|c| letter(c) || c.is_ascii_digit())
}

/// Whether formulas give this name a meaning of its own.
pub fn is_reserved(name: &str) -> bool {
    name == PI || FUNCTIONS.iter().any(|(function, _)| *function == name)
}

impl Node {
    fn check(&self) -> Result<(), NoFormula> {
        match self {
            Node::Number(x) if !x.is_finite() => {
                Err(NoFormula { problem: "a number is too large".into(), help: "at most 1.8e308".into() })
            }
            Node::Number(_) => Ok(()),
            Node::Name(name) if name != PI && is_reserved(name) => Err(NoFormula {
                problem: format!("the function {name} has no argument"),
                help: format!("write {name}(…)"),
            }),
            Node::Name(_) => Ok(()),
            Node::Minus(a) => a.check(),
            Node::Both(_, a, b) => a.check().and_then(|()| b.check()),
            Node::Call(name, arguments) => {
                let known = FUNCTIONS.map(|(function, _)| function);
                let Some((_, count)) = FUNCTIONS.iter().find(|(function, _)| function == name) else {
                    let near = crate::error::nearest(name, &known).map(|near| format!("did you mean {near}? "));
                    let help = format!("{}functions are {}", near.unwrap_or_default(), known.join(", "));
                    return Err(NoFormula { problem: format!("there is no function {name}"), help });
                };
                let found = arguments.len();
                if count.map_or(found < 2, |count| found != count) {
                    let takes = count.map_or("two arguments or more".into(), |n| format!("{n} argument"));
                    return Err(NoFormula {
                        problem: format!("{name} takes {takes}, not {found}"),
                        help: format!("write {name}({})", if count.is_some() { "a" } else { "a, b" }),
                    });
                }
                arguments.iter().try_for_each(Node::check)
            }
        }
    }

    fn add_names<'a>(&'a self, out: &mut BTreeSet<&'a str>) {
        match self {
            Node::Number(_) => {}
            Node::Name(name) => out.extend(Some(name.as_str()).filter(|name| *name != PI)),
            Node::Minus(a) => a.add_names(out),
            Node::Both(_, a, b) => [a, b].iter().for_each(|node| node.add_names(out)),
            Node::Call(_, arguments) => arguments.iter().for_each(|node| node.add_names(out)),
        }
    }

    fn value(&self, of: &impl Fn(&str) -> Option<f64>) -> Option<f64> {
        Some(match self {
            Node::Number(x) => *x,
            Node::Name(name) if name == PI => std::f64::consts::PI,
            Node::Name(name) => of(name)?,
            Node::Minus(a) => -a.value(of)?,
            Node::Both(operator, a, b) => {
                let (a, b) = (a.value(of)?, b.value(of)?);
                match operator {
                    Operator::Add => a + b,
                    Operator::Subtract => a - b,
                    Operator::Multiply => a * b,
                    Operator::Divide => a / b,
                    Operator::Power => a.powf(b),
                }
            }
            Node::Call(name, arguments) => {
                let values = arguments.iter().map(|node| node.value(of)).collect::<Option<Vec<f64>>>()?;
                call(name, &values)?
            }
        })
    }
}

fn call(name: &str, values: &[f64]) -> Option<f64> {
    let (first, rest) = values.split_first()?;
    Some(match name {
        "sin" => first.sin(),
        "cos" => first.cos(),
        "tan" => first.tan(),
        "asin" => first.asin(),
        "acos" => first.acos(),
        "atan" => first.atan(),
        "sqrt" => first.sqrt(),
        "abs" => first.abs(),
        "deg" => first.to_radians(),
        // What is not a number must not vanish, as it would in f64::min.
        "min" => rest.iter().fold(*first, |a, &b| if a.is_nan() || a < b { a } else { b }),
        "max" => rest.iter().fold(*first, |a, &b| if a.is_nan() || a > b { a } else { b }),
        _ => return None,
    })
}

fn both(operator: Operator, a: Node, b: Node) -> ModalResult<Node> {
    Ok(Node::Both(operator, a.into(), b.into()))
}

/// The whole grammar: operands between operators of three ranks.
fn sum(input: &mut &str) -> ModalResult<Node> {
    expression(preceded(multispace0, operand))
        .prefix(preceded(
            multispace0,
            dispatch! {peek(any);
                '-' => '-'.map(|_| Prefix(9, |_: &mut &str, a: Node| Ok(Node::Minus(a.into())))),
                '+' => '+'.map(|_| Prefix(9, |_: &mut &str, a: Node| Ok(a))),
                _ => fail,
            },
        ))
        .infix(preceded(
            multispace0,
            dispatch! {any;
                '+' => Infix::Left(5, |_: &mut &str, a, b| both(Operator::Add, a, b)),
                '-' => Infix::Left(5, |_: &mut &str, a, b| both(Operator::Subtract, a, b)),
                '*' => Infix::Left(7, |_: &mut &str, a, b| both(Operator::Multiply, a, b)),
                '/' => Infix::Left(7, |_: &mut &str, a, b| both(Operator::Divide, a, b)),
                '^' => Infix::Right(11, |_: &mut &str, a, b| both(Operator::Power, a, b)),
                _ => fail,
            },
        ))
        .parse_next(input)
}

fn operand(input: &mut &str) -> ModalResult<Node> {
    dispatch! {peek(any);
        '(' => delimited('(', cut_err(sum), cut_err((multispace0, ')'))),
        c if c.is_ascii_digit() || c == '.' => number,
        c if c.is_ascii_alphabetic() || c == '_' => named,
        _ => fail,
    }
    .parse_next(input)
}

fn number(input: &mut &str) -> ModalResult<Node> {
    let exponent = opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1));
    let digits = dispatch! {peek(any);
        '.' => ('.', digit1).void(),
        _ => (digit1, opt(('.', digit0))).void(),
    };
    (digits, exponent).take().parse_to().map(Node::Number).parse_next(input)
}

/// A name, or a function with its arguments.
fn named(input: &mut &str) -> ModalResult<Node> {
    let name = take_while(1.., |c: char| c.is_ascii_alphanumeric() || c == '_').parse_next(input)?;
    if opt((multispace0, '(')).parse_next(input)?.is_none() {
        return Ok(Node::Name(name.to_owned()));
    }
    let arguments = separated(1.., sum, (multispace0, ','));
    let arguments: Vec<Node> = cut_err(arguments).parse_next(input)?;
    cut_err((multispace0, ')')).parse_next(input)?;
    Ok(Node::Call(name.to_owned(), arguments))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let of = |name: &str| [("a", 7.0), ("minor", 3.0), ("pi2", 4.0)].iter().find(|n| n.0 == name).map(|n| n.1);
        Formula::parse(text).unwrap_or_else(|e| panic!("{text}: {}", e.problem)).value(&of).unwrap()
    }

    #[test]
    fn ranks_are_those_of_paper() {
        for (text, found) in [
            ("1 - 2 + 3", 2.0),
            ("2 / 3 / 4", 2.0 / 3.0 / 4.0),
            ("8/2*4", 16.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1 * 3", 1.5),
            ("--a", 7.0),
            ("2*-3", -6.0),
            ("(1 + 2)*( a - 3 )", 12.0),
            ("2*max(3, min(4, 5, a)) - 1", 7.0),
            ("min(1,min(2,3))*2", 2.0),
            ("minor + pi2", 7.0),
            ("1e-3 + .5 + 2.", 2.501),
            ("deg ( 180 ) - pi", 0.0),
            ("sqrt(abs(-4)) + atan(0) + asin(0) + acos(1) + tan(0) + sin(0) + cos(0)", 3.0),
        ] {
            assert_eq!(value(text), found, "{text}");
        }
        assert!(value("max(0/0, 1)").is_nan() && value("min(1, 0/0)").is_nan() && value("1/0").is_infinite());
    }

    #[test]
    fn names_are_found() {
        let formula = Formula::parse("2*pitch + sin(tilt)*pi - pitch").unwrap();
        assert_eq!(formula.names().into_iter().collect::<Vec<_>>(), ["pitch", "tilt"]);
        assert_eq!(formula.value(&|_| None), None);
    }

    #[test]
    fn what_is_no_formula_is_refused() {
        let problem = |text: &str| Formula::parse(text).map_err(|e| e.problem).unwrap_err();
        for (text, found) in [
            ("", "the formula is empty"),
            ("2 *", "\"2 *\" ends too early"),
            ("(1 + 2", "\"(1 + 2\" ends too early"),
            ("1)", "\"1)\" cannot be read from \")\" on"),
            ("2 radius", "\"2 radius\" cannot be read from \"radius\" on"),
            ("2 ** 3", "\"2 ** 3\" cannot be read from \"* 3\" on"),
            ("a, b", "\"a, b\" cannot be read from \", b\" on"),
            ("()", "\"()\" cannot be read from \")\" on"),
            ("sin", "the function sin has no argument"),
            ("sine(1)", "there is no function sine"),
            ("sin(1, 2)", "sin takes 1 argument, not 2"),
            ("min(1)", "min takes two arguments or more, not 1"),
            ("1e999", "a number is too large"),
        ] {
            assert_eq!(problem(text), found, "{text}");
        }
        let help = |text: &str| Formula::parse(text).unwrap_err().help;
        assert_eq!(help("2 radius"), "is an operator missing before radius, as *?");
        assert!(help("0.6mm").contains("write 0.6 without quotes, and unit = \"mm\""));
        assert!(problem(&"(".repeat(1000)).contains("too long"));
        assert!(problem(&"(".repeat(LONGEST)).contains("too long"));
        assert!(problem(&"(".repeat(MOST_NESTED)).contains("too early"));
    }
}
