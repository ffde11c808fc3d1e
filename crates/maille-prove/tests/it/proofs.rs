//! Proofs against states that were found by other means, and proofs with planted faults.

use crate::sampler::{State, Weave};
use maille::design::Design;
use maille_geometry::Vec3;
use maille_io::{DesignSource, builtin};
use maille_prove::{Options, Outcome, search};
use maille_verify::proof::{Cell, Claim, Node, Piece, Proof, Reason, Rings, piece::Side, write};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use std::{sync::atomic::AtomicBool, time::Duration};

fn design(name: &str, minor_radius: f64) -> Design {
    DesignSource::new(name, builtin(name).unwrap()).read().unwrap().with_minor_radius(minor_radius)
}

/// Rings of two sizes, in an oblique cell.
fn unlike() -> Design {
    let mut design = design("2", 0.08);
    design.elements[1].rings[0].major_radius = 1.05;
    design.elements[1].rings[0].minor_radius = Some(0.05);
    design.lattice.a2 = [0.04, 2.26, 0.0];
    design
}

/// The power of two that a proof counts in.
fn unit(design: &Design) -> f64 {
    2_f64.powf(design.elements[0].rings[0].major_radius.log2().floor())
}

fn claim(design: &Design, direction_deg: f64, l2: f64, l1: f64) -> Claim {
    Claim::new(serde_json::to_value(design).unwrap(), direction_deg, l2, l1)
}

fn searched(cell: &Cell, boxes: usize) -> Outcome {
    let options = Options { boxes, time: Duration::from_secs(3600) };
    search(cell, options, &AtomicBool::new(false), |_| {})
}

/// Feasible states of a walk, every tenth.
fn states(weave: &Weave, count: usize, seed: u64) -> Vec<State> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut state, mut out) = (weave.start, Vec::new());
    assert!(weave.feasible(&state), "the start is feasible");
    while out.len() < count {
        for _ in 0..10 {
            state = weave.walk(&state, 20.0, &mut rng).0;
        }
        out.push(state);
    }
    out
}

/// The unknowns of a state: normals a and b or −a and −b, with that of ring 0 through a positive side.
fn unknowns(state: &State) -> ([f64; 8], [Side; 2]) {
    let mut x = [1.0 + state.l1, state.place.x, state.place.y, state.place.z, 0.0, 0.0, 0.0, 0.0];
    let mut sides = [Side { axis: 0, negative: false }; 2];
    let first = state.normals[0];
    let sign = first[first.iamax()].signum();
    for ring in 0..2 {
        let n = state.normals[ring] * sign;
        let axis = n.iamax();
        sides[ring] = Side { axis, negative: n[axis] < 0.0 };
        x[4 + 2 * ring] = n[(axis + 1) % 3] / n[axis].abs();
        x[5 + 2 * ring] = n[(axis + 2) % 3] / n[axis].abs();
    }
    (x, sides)
}

/// Images of a state under the symmetries of every cell of two rings, and the half turn with its t, in undeformed coordinates.
fn images(weave: &Weave, state: &State, turn: [i32; 2], alike: bool) -> Vec<State> {
    let mut out = vec![*state];
    let grow = |out: &mut Vec<State>, image: &dyn Fn(&State) -> State| {
        let more: Vec<State> = out.iter().map(image).collect();
        out.extend(more);
    };
    let flat = |n: Vec3| Vec3::new(n.x, n.y, -n.z);
    grow(&mut out, &|s| State { place: flat(s.place), normals: [flat(s.normals[0]), -flat(s.normals[1])], ..*s });
    let t = weave.lattice[0] * f64::from(turn[0]) + weave.lattice[1] * f64::from(turn[1]);
    let turned = |n: Vec3| Vec3::new(-n.x, -n.y, n.z);
    grow(&mut out, &|s| {
        let normals = [turned(s.normals[0]), -turned(s.normals[1])];
        State { place: turned(s.place) - t, normals, ..*s }
    });
    if alike {
        grow(&mut out, &|s| State { normals: [s.normals[1], -s.normals[0]], ..*s });
    }
    out
}

fn cases() -> Vec<(Design, f64, f64, bool)> {
    vec![
        (design("2", 0.1), 0.0, 0.0, true),
        (design("2", 0.05), 37.5, 0.02, true),
        (design("european-4-in-1", 0.15), 100.0, 0.0, true),
        (unlike(), 62.0, 0.0, false),
    ]
}

/// What every reason says of a box holds at each state in it.
#[test]
fn inequalities_hold_at_feasible_states() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut seen = [0_usize; 6];
    for (design, direction, l2, _) in cases() {
        let unit = unit(&design);
        let cell = claim(&design, direction, l2, -0.5).cell().unwrap();
        let weave = Weave::new(&design, direction, l2);
        for state in states(&weave, 300, 7) {
            let (x, sides) = unknowns(&State { place: state.place / unit, ..state });
            // A box of random size around the state, which is anywhere in it.
            let size = 10_f64.powf(rng.random_range(-4.0..0.0));
            let (mut lo, mut hi) = (x, x);
            for i in 0..8 {
                let width = size * rng.random::<f64>();
                let part = rng.random::<f64>();
                (lo[i], hi[i]) = (x[i] - part * width, x[i] + (1.0 - part) * width);
            }
            let rings = Rings::of(&Piece { lo, hi, sides });
            let mut number = |size: i32| rng.random_range(-size..=size);
            for pair in 0..cell.pairs.len() {
                let mut vector = || [number(1000), number(1000), number(1000)];
                let (first, second, along) = (vector(), vector(), vector());
                let reasons = [
                    Reason::Turn { pair },
                    Reason::Apart { pair, along },
                    Reason::Plane { pair, of: number(1).unsigned_abs() as usize, below: number(1) > 0 },
                    Reason::Chord { pair, of: number(1).unsigned_abs() as usize },
                    Reason::Touch { pair, first, second },
                    Reason::Through { pair },
                ];
                for (k, reason) in reasons.iter().enumerate() {
                    let Some(form) = cell.inequality(&rings, reason) else { continue };
                    let y = |i: usize| ((x[i] - 0.5 * (lo[i] + hi[i])) / (0.5 * (hi[i] - lo[i]))).clamp(-1.0, 1.0);
                    let value = form.c + (0..8).map(|i| form.b[i] * y(i)).sum::<f64>() + form.r;
                    assert!(value > -1e-9, "{reason:?}: {value} at {state:?} in {lo:?} .. {hi:?}");
                    seen[k] += 1;
                }
            }
        }
    }
    // The last says nothing unless a pair that is not linked is so all over the box, which no feasible state allows.
    assert!(seen[..5].iter().all(|n| *n > 500) && seen[5] == 0, "{seen:?}");
}

/// The leaf of the trees that a state is in, if it is in a root.
fn leaf<'a>(cell: &Cell, trees: &'a [Tree], x: &[f64; 8], sides: &[Side; 2]) -> Option<&'a Node> {
    let inside = |root: &Piece| root.sides == *sides && (0..8).all(|i| root.lo[i] <= x[i] && x[i] <= root.hi[i]);
    let root = cell.roots.iter().position(inside)?;
    let (mut tree, mut piece) = (&trees[root], cell.roots[root]);
    while let Tree::Split(unknown, halves) = tree {
        let [low, high] = piece.halves(*unknown).unwrap();
        let upper = x[*unknown] > low.hi[*unknown];
        (tree, piece) = (&halves[usize::from(upper)], if upper { high } else { low });
    }
    match tree {
        Tree::Leaf(node) => Some(node),
        Tree::Split(..) => None,
    }
}

enum Tree {
    Leaf(Node),
    Split(usize, Box<[Tree; 2]>),
}

fn tree(nodes: &mut impl Iterator<Item = Node>) -> Tree {
    match nodes.next().unwrap() {
        Node::Split(unknown) => {
            let low = tree(nodes);
            Tree::Split(unknown, Box::new([low, tree(nodes)]))
        }
        leaf => Tree::Leaf(leaf),
    }
}

/// Every state has an image, itself feasible, in the boxes that are not out of order; and no box that holds one is refuted.
#[test]
fn boxes_hold_all_states_and_none_with_a_state_is_refuted() {
    for (design, direction, l2, alike) in cases() {
        let unit = unit(&design);
        let cell = claim(&design, direction, l2, -0.2).cell().unwrap();
        let outcome = searched(&cell, 6_000);
        assert!(!outcome.closed());
        let mut nodes = outcome.nodes();
        let trees: Vec<Tree> = cell.roots.iter().map(|_| tree(&mut nodes)).collect();
        assert!(nodes.next().is_none());
        let weave = Weave::new(&design, direction, l2);
        let shifts = || cell.links().map(|link| link.shift);
        let turn = [0, 1].map(|k| shifts().map(|s| s[k]).min().unwrap() + shifts().map(|s| s[k]).max().unwrap());
        let (mut refuted, mut tried) = (0, 0);
        for state in states(&weave, 300, 11) {
            if state.l1 < -0.19 {
                continue;
            }
            tried += 1;
            let images = images(&weave, &state, turn, alike);
            assert!(images.iter().all(|image| weave.feasible(image)), "{images:?}");
            let found = |image: &State| {
                let (x, sides) = unknowns(&State { place: image.place / unit, ..*image });
                match leaf(&cell, &trees, &x, &sides) {
                    Some(Node::Refuted(_)) => {
                        refuted += 1;
                        true
                    }
                    Some(Node::Open) => !cell.out_of_order(&Piece { lo: x, hi: x, sides }),
                    _ => false,
                }
            };
            assert!(images.iter().map(found).filter(|found| *found).count() > 0, "{state:?}");
        }
        assert!(refuted == 0 && tried > 100, "{refuted} of {tried}");
    }
}

/// A proof that is complete in some thousand boxes.
fn small() -> (Claim, Outcome) {
    let claim = claim(&design("2", 0.1), 45.0, 0.0, 0.13);
    let outcome = searched(&claim.cell().unwrap(), 100_000);
    (claim, outcome)
}

fn accepted(text: &str) -> Result<(), String> {
    let proof = Proof::read(text).map_err(|(line, problem)| format!("{line}: {problem}"))?;
    (0..proof.len()).try_for_each(|k| proof.check(k).map_err(|line| format!("{line}: not refuted")))
}

#[test]
fn a_proof_is_read_again_and_planted_faults_are_found() {
    let (claim, outcome) = small();
    assert!(outcome.closed() && outcome.boxes < 50_000, "{}", outcome.boxes);
    let claim = outcome.claim(claim);
    let nodes: Vec<Node> = outcome.nodes().collect();
    let text = |claim: &Claim, nodes: &[Node]| write(claim, nodes.iter().cloned());
    assert_eq!(accepted(&text(&claim, &nodes)), Ok(()));
    // Whoever edits the file and not its sum is found by that; the others have the sum of what they say.
    let edited = text(&claim, &nodes).replacen("0.13", "0.12", 1);
    assert!(accepted(&edited).unwrap_err().contains("was edited"));
    let refused = |claim: &Claim, nodes: &[Node], words: &str| {
        let said = accepted(&text(claim, nodes)).unwrap_err();
        assert!(said.contains(words), "{said}");
    };
    // A state with l1 = 0.1173 exists: what claims less is false.
    let lower = Claim { l1_from: 0.117, l1_at_most: 0.117, ..claim.clone() };
    refused(&lower, &nodes, "not refuted");
    refused(&Claim { l1_at_most: 0.12, ..claim.clone() }, &nodes, "is claimed of states from");
    let at = nodes.iter().position(|node| matches!(node, Node::Refuted(_))).unwrap();
    let mut fewer = nodes.clone();
    fewer.remove(at);
    assert!(accepted(&text(&claim, &fewer)).is_err());
    fewer.truncate(at);
    refused(&claim, &fewer, "a branch of the tree is missing");
    let mut open = nodes.clone();
    open[at] = Node::Open;
    refused(&claim, &open, "is not refuted, above the claim");
    open[at] = Node::OutOfOrder;
    refused(&claim, &open, "not out of order");
    open[at] = Node::Refuted(Vec::new());
    refused(&claim, &open, "no node of a proof");
    open[at] = Node::Refuted(vec![(Reason::Turn { pair: 99 }, 1)]);
    refused(&claim, &open, "not refuted");
    for (key, value) in [("minor_radius", 0.09), ("reference_radius", 1.0)] {
        let mut design = claim.design.clone();
        design[key] = value.into();
        design["elements"][0]["rings"][0]["major_radius"] = 1.02.into();
        refused(&Claim { design, ..claim.clone() }, &nodes, "");
    }
    refused(&Claim { cell: "2x1".into(), ..claim.clone() }, &nodes, "for the cell 2x1");
    refused(&Claim { l2: -0.05, ..claim.clone() }, &nodes, "");
}

#[test]
fn a_search_that_ends_early_proves_what_it_reached() {
    let claim = claim(&design("2", 0.1), 45.0, 0.0, 0.05);
    let outcome = searched(&claim.cell().unwrap(), 3_000);
    assert!(!outcome.closed() && outcome.boxes >= 3_000);
    let reached = outcome.claim(claim);
    // The limit is 0.117294.
    assert!(reached.l1_at_most > 0.1172 && reached.l1_at_most < 0.15, "{}", reached.l1_at_most);
    assert_eq!(accepted(&write(&reached, outcome.nodes())), Ok(()));
    let lower = Claim { l1_at_most: reached.l1_at_most - 1e-6, ..reached };
    assert!(accepted(&write(&lower, outcome.nodes())).is_err());
}

#[test]
fn threads_do_not_change_a_proof() {
    let text = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (claim, outcome) = pool.install(small);
        write(&claim, outcome.nodes())
    };
    assert!(text(1) == text(3));
}

#[test]
fn walks_find_no_state_above_a_proof_and_come_near_it() {
    let (claim, outcome) = small();
    assert!(outcome.closed());
    let weave = Weave::new(&design("2", 0.1), 45.0, 0.0);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut state, mut largest) = (weave.start, 0.0_f64);
    for step in 0..40_000 {
        state = weave.walk(&state, 10.0 + f64::from(step), &mut rng).0;
        largest = largest.max(state.l1);
    }
    assert!(largest < claim.l1_at_most && largest > 0.09, "{largest}");
}
