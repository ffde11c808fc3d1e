//! Which top-level modules of its crate a source file names.

use crate::tokens::{Token, tokens};

/// A name that follows the crate's root in a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// The module that the path stands in, from the crate's root; empty in `lib.rs`.
    pub from: Vec<String>,
    /// The first name after the root, or what stands in its place (`*`, `as`).
    pub name: String,
    /// Line, from 1.
    pub line: usize,
}

/// All names that the source of module `module` takes from its crate's root: by `crate::…` and by chains of
/// `self::` and `super::` that reach it, in `use` trees and in expressions, macros' bodies included.
pub fn uses(source: &str, module: &[String]) -> Vec<Use> {
    let tokens = tokens(source);
    let is_name = |at: usize, name: &str| matches!(tokens.get(at), Some((Token::Name(n), _)) if n == name);
    let is_sign = |at: usize, sign: char| matches!(tokens.get(at), Some((Token::Sign(s), _)) if *s == sign);
    let is_separator = |at: usize| matches!(tokens.get(at), Some((Token::Separator, _)));
    let mut out = Vec::new();
    let mut here = module.to_vec();
    // Depths of braces at which inline modules opened.
    let (mut depth, mut inline) = (0usize, Vec::new());
    let mut at = 0;
    while let Some((token, line)) = tokens.get(at) {
        match token {
            Token::Sign('{') => depth += 1,
            Token::Sign('}') => {
                depth = depth.saturating_sub(1);
                if inline.last() == Some(&depth) {
                    inline.pop();
                    here.pop();
                }
            }
            Token::Name(name) if name == "mod" && is_sign(at + 2, '{') => {
                if let Some((Token::Name(name), _)) = tokens.get(at + 1) {
                    here.push(name.clone());
                    inline.push(depth);
                    depth += 1;
                    at += 2;
                }
            }
            Token::Name(name) if matches!(name.as_str(), "crate" | "self" | "super") => {
                let begins = at == 0 || !is_separator(at - 1);
                if begins && name == "crate" && is_name(at + 1, "as") {
                    out.push(Use { from: here.clone(), name: "as".into(), line: *line });
                } else if begins && is_separator(at + 1) {
                    let (mut up, mut next) = (if name == "super" { 1 } else { 0 }, at + 2);
                    while is_name(next, "super") && is_separator(next + 1) {
                        (up, next) = (up + 1, next + 2);
                    }
                    if name == "crate" || up >= here.len() {
                        let found = first_names(&tokens, next);
                        out.extend(found.into_iter().map(|(name, line)| Use { from: here.clone(), name, line }));
                    }
                }
            }
            _ => {}
        }
        at += 1;
    }
    out
}

/// The names that a path or a group goes on with at `at`: `a` of `a::b`, `a` and `c` of `{a::b, c::{d, e}}`.
fn first_names(tokens: &[(Token, usize)], at: usize) -> Vec<(String, usize)> {
    let named = |at: usize| match tokens.get(at) {
        Some((Token::Name(name), line)) => Some((name.clone(), *line)),
        Some((Token::Sign('*'), line)) => Some(("*".into(), *line)),
        _ => None,
    };
    if !matches!(tokens.get(at), Some((Token::Sign('{'), _))) {
        return named(at).into_iter().collect();
    }
    let (mut out, mut depth, mut at, mut fresh) = (Vec::new(), 1, at + 1, true);
    while let Some((token, _)) = tokens.get(at).filter(|_| depth > 0) {
        match token {
            Token::Sign('{') => depth += 1,
            Token::Sign('}') => depth -= 1,
            Token::Sign(',') if depth == 1 => {
                fresh = true;
                at += 1;
                continue;
            }
            _ if fresh => out.extend(named(at)),
            _ => {}
        }
        fresh = false;
        at += 1;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(source: &str, module: &[&str]) -> Vec<(String, usize)> {
        let module: Vec<String> = module.iter().map(|m| m.to_string()).collect();
        uses(source, &module).into_iter().map(|u| (u.name, u.line)).collect()
    }

    fn names(source: &str, module: &[&str]) -> Vec<String> {
        found(source, module).into_iter().map(|u| u.0).collect()
    }

    #[test]
    fn trees_and_expressions() {
        let source = "
            use crate::{
                model::{Model, self},
                solve::newton::{Derivatives, Objective}, state::State,
                topology::{self, links::{Link, Kind}},
            };
            fn f(x: &crate::lattice::Cell) -> crate::error::InvalidInput { g!($crate::design::Design) }
            pub(crate) fn h() { /* crate::limit */ \"crate::limit\"; }
        ";
        let expected =
            [("model", 3), ("solve", 4), ("state", 4), ("topology", 5), ("lattice", 7), ("error", 7), ("design", 7)];
        assert_eq!(found(source, &["energy"]), expected.map(|(name, line)| (name.to_string(), line)));
    }

    #[test]
    fn super_that_reaches_the_root() {
        assert_eq!(names("use super::model::Model;", &["energy"]), ["model"]);
        assert_eq!(names("use super::{model, state::State};", &["energy"]), ["model", "state"]);
        assert_eq!(names("use self::super::super::model;", &["energy", "target"]), ["model"]);
        assert!(names("use super::{barrier::barrier, SheetEnergy};", &["energy", "contacts"]).is_empty());
        assert!(names("use self::target::Target;", &["energy"]).is_empty());
        assert_eq!(names("pub use self::model::Model; mod model;", &[]), ["model"]);
    }

    #[test]
    fn inline_modules_are_one_deeper() {
        let source = "
            mod tests { use super::*; use super::super::limit; fn f() { if a { b() } } }
            use super::record;
        ";
        assert_eq!(names(source, &["energy"]), ["limit", "record"]);
    }

    #[test]
    fn what_hides_a_name_is_reported_as_it_stands() {
        assert_eq!(names("use crate::*; use crate as root; use super::*;", &["energy"]), ["*", "as", "*"]);
    }

    #[test]
    fn other_paths_are_none() {
        assert!(
            names(
                "use maille_geometry::crate_like::Vec3; pub(in crate) fn a() { self.model(); Self::model() }",
                &["state"]
            )
            .is_empty()
        );
    }
}
