//! The circle check: no file of a crate uses itself through others, and no folder of `maille-io` does.

use crate::{
    crates::{Crates, Sources, folder},
    repository::Finding,
    uses::Use,
};
use std::collections::{BTreeMap, BTreeSet};

/// Crates whose folders below `src` stand in no circle either; a file there is a folder of one.
const FOLDERS: &[&str] = &["maille-io"];

/// The circles. Uses between the files of one are not counted apart: what they add is seen only when it draws another file in.
pub fn check(crates: &Crates) -> Vec<Finding> {
    let of = |(name, sources): (&String, &Result<Sources, Finding>)| match sources {
        Ok(sources) => check_crate(name, &sources.uses),
        Err(finding) => vec![finding.clone()],
    };
    crates.iter().flat_map(of).collect()
}

fn check_crate(name: &str, uses: &[Use]) -> Vec<Finding> {
    let uses = graph(uses);
    let mut graphs = vec![uses.clone()];
    if FOLDERS.contains(&name) {
        graphs.push(between_folders(&uses));
    }
    judge(&folder(name), &graphs)
}

/// A use of one file or folder by another, with the first line that makes it.
type Graph = BTreeMap<(String, String), usize>;

/// Unit tests may use what they like.
fn graph(uses: &[Use]) -> Graph {
    let mut out = Graph::new();
    for u in uses.iter().filter(|u| !u.test) {
        let line = out.entry((u.from.clone(), u.to.clone())).or_insert(u.line);
        *line = u.line.min(*line);
    }
    out
}

/// A finding for each circle in `graphs`.
fn judge(folder: &str, graphs: &[Graph]) -> Vec<Finding> {
    let finding = |graph: &Graph, circle: Vec<String>| {
        let inside = graph.iter().filter(|((from, to), _)| circle.contains(from) && circle.contains(to));
        let uses: String = inside.map(|((from, to), line)| format!("\n  {from}:{line} uses {to}")).collect();
        Finding::new(folder, 0, format!("a circle of {}{uses}", circle.join(", ")))
    };
    graphs.iter().flat_map(|graph| circles(graph).into_iter().map(move |circle| finding(graph, circle))).collect()
}

/// Uses between the folders and files at the top; those of the crate's root are left out.
fn between_folders(uses: &Graph) -> Graph {
    let folder = |file: &str| file.split('/').next().unwrap_or(file).trim_end_matches(".rs").to_string();
    let mut out = Graph::new();
    for ((from, to), line) in uses {
        let pair = (folder(from), folder(to));
        if pair.0 != pair.1 && pair.0 != "lib" {
            out.entry(pair).or_insert(*line);
        }
    }
    out
}

/// Sets of nodes of which each reaches each other, as large as they are, with their nodes sorted.
fn circles(uses: &Graph) -> Vec<Vec<String>> {
    let mut reach: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in uses.keys() {
        reach.entry(from).or_default().insert(to);
    }
    // What is reached by one more step, until nothing is.
    loop {
        let longer: BTreeMap<&str, BTreeSet<&str>> = reach
            .iter()
            .map(|(from, to)| {
                (*from, to.iter().flat_map(|to| reach.get(to).into_iter().flatten()).chain(to).copied().collect())
            })
            .collect();
        if longer == reach {
            break;
        }
        reach = longer;
    }
    let reaches = |from: &str, to: &str| reach.get(from).is_some_and(|reached| reached.contains(to));
    let circles: BTreeSet<Vec<String>> = reach
        .keys()
        .filter(|node| reaches(node, node))
        .map(|node| reach[node].iter().filter(|other| reaches(other, node)).map(|other| other.to_string()).collect())
        .collect();
    circles.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(files: &[(&str, &str)]) -> Graph {
        let files = files.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect();
        graph(&crate::uses::uses(&files).unwrap())
    }

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        circles(&uses(files)).into_iter().map(|circle| circle.join(" ")).collect()
    }

    #[test]
    fn a_planted_circle_is_found() {
        let mut files = vec![
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use crate::b::B; pub struct A(B);"),
            ("b/mod.rs", "mod d; pub use d::D; pub struct B;"),
            ("b/d.rs", "pub struct D;"),
            ("c.rs", "pub fn c() { crate::a::A; super::b::D; }"),
        ];
        assert_eq!(found(&files), [""; 0]);
        files[3].1 = "pub struct D; fn f() { m!(super::super::c::c()) }";
        assert_eq!(found(&files), ["b/d.rs c.rs"], "what b passes on is d's, not b's");
        files[2].1 = "mod d; pub use d::D; pub struct B(D);";
        assert_eq!(found(&files), ["a.rs b/d.rs b/mod.rs c.rs"]);
    }

    #[test]
    fn folders_are_judged_as_wholes() {
        let files = [
            ("lib.rs", "pub mod plot; pub mod record;"),
            ("plot.rs", "pub mod axes; pub mod curve;"),
            ("plot/axes.rs", "pub struct Axes;"),
            ("plot/curve.rs", "use crate::record::Row;"),
            ("record.rs", "pub struct Row; mod map;"),
            ("record/map.rs", "use crate::plot::axes::Axes;"),
        ];
        assert_eq!(found(&files), [""; 0]);
        assert_eq!(circles(&between_folders(&uses(&files))), [["plot", "record"]]);
    }

    #[test]
    fn a_finding_names_the_uses_of_its_circle() {
        let round = uses(&[("lib.rs", "mod a; mod b;"), ("a.rs", "use crate::b::B;"), ("b.rs", "use super::a::A;")]);
        let straight = uses(&[("lib.rs", "mod a; mod b;"), ("a.rs", "use crate::b::B;"), ("b.rs", "pub struct B;")]);
        assert!(judge("src", &[round])[0].problem.contains("b.rs:1 uses a.rs"));
        assert_eq!(judge("src", &[straight]), []);
    }
}
