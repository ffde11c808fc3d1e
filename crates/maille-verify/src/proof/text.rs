//! The file of a proof: the claim as one line of JSON, then the trees of all root boxes, each node before its branches, and a last
//! line with the SHA-256 of all before it.
//!
//! A node is one line: `/ 3`, split in two halves along unknown 3; `=`, out of order, see [`Cell::out_of_order`]; `?`, not refuted, and
//! not above the claim; or the inequalities that refute it: `s` link, `a` link n, `t` pair first second, `p` link ring sign, `c` link ring, `u` pair, each with
//! its weight after `*`.

use super::{Cell, Chosen, Piece, Reason, Rings};
use crate::{files::sha256, record::Design};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::Write;

/// Version of the format.
const SCHEMA: u64 = 1;
/// A tree is no deeper.
const DEPTH: usize = 1000;

/// What is claimed: no state of the cell, with the links of the design, has a larger l1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Version of the format.
    #[serde(rename = "maille_proof")]
    pub schema: u64,
    /// The design, as in a record.
    pub design: Value,
    /// The cell, always `1x1`.
    pub cell: String,
    /// Direction of the pull, degrees counter-clockwise from x.
    pub direction_deg: f64,
    /// Stretch − 1 across it.
    pub l2: f64,
    /// The boxes hold the states with at least this l1.
    pub l1_from: f64,
    /// No state has a larger l1.
    pub l1_at_most: f64,
    /// Largest l1 that a search found; no part of what is proved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub l1_found: Option<f64>,
}

/// A node of a tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Two halves along an unknown follow.
    Split(usize),
    /// The other order of the rings holds what is here.
    OutOfOrder,
    /// Not refuted.
    Open,
    /// Inequalities with weights that contradict each other.
    Refuted(Vec<(Reason, u32)>),
}

/// A box, what refutes it, and its line.
struct Leaf {
    piece: Piece,
    terms: Vec<(Reason, u32)>,
    line: usize,
}

/// A proof that was read: its claim, and each box that is to be refuted with what refutes it.
pub struct Proof {
    /// What is claimed.
    pub claim: Claim,
    /// Name of the design.
    pub design: String,
    cell: Cell,
    boxes: Vec<Leaf>,
    nodes: usize,
}

impl Claim {
    /// A claim on all states with at least `l1_from`, which is proved if no box is left.
    pub fn new(design: Value, direction_deg: f64, l2: f64, l1_from: f64) -> Claim {
        let cell = "1x1".to_owned();
        Claim { schema: SCHEMA, design, cell, direction_deg, l2, l1_from, l1_at_most: l1_from, l1_found: None }
    }

    /// The cell that the claim is on, or why there is none.
    pub fn cell(&self) -> Result<Cell, String> {
        let design: Design = serde_json::from_value(self.design.clone()).map_err(|e| format!("the design: {e}"))?;
        if self.schema != SCHEMA || self.cell != "1x1" {
            return Err(format!(
                "a proof of format {} for the cell {}; this program knows 1 and 1x1",
                self.schema, self.cell
            ));
        }
        if self.l1_at_most < self.l1_from {
            return Err(format!("l1 <= {} is claimed of states from {} on", self.l1_at_most, self.l1_from));
        }
        Cell::new(&design, self.direction_deg, self.l2, self.l1_from)
    }

    /// Whether a box that is not refuted is within the claim.
    pub fn allows(&self, piece: &Piece) -> bool {
        (piece.hi[0] - 1.0).next_up() <= self.l1_at_most
    }
}

/// The text of a proof; `nodes` are those of the trees of all roots in turn, each node before its branches.
pub fn write(claim: &Claim, nodes: impl Iterator<Item = Node>) -> String {
    let mut out = serde_json::to_string(claim).unwrap_or_default();
    out.push('\n');
    let numbers = |out: &mut String, x: &Chosen| x.iter().for_each(|x| _ = write!(out, " {x}"));
    for node in nodes {
        match node {
            Node::Split(unknown) => _ = write!(out, "/ {unknown}"),
            Node::OutOfOrder => out.push('='),
            Node::Open => out.push('?'),
            Node::Refuted(terms) => {
                for (k, (reason, weight)) in terms.iter().enumerate() {
                    out.push_str(if k == 0 { "" } else { " " });
                    match reason {
                        Reason::Turn { pair } => _ = write!(out, "s {pair}"),
                        Reason::Plane { pair, of, below } => _ = write!(out, "p {pair} {of} {}", u8::from(*below)),
                        Reason::Chord { pair, of } => _ = write!(out, "c {pair} {of}"),
                        Reason::Through { pair } => _ = write!(out, "u {pair}"),
                        Reason::Apart { pair, along } => {
                            _ = write!(out, "a {pair}");
                            numbers(&mut out, along);
                        }
                        Reason::Touch { pair, first, second } => {
                            _ = write!(out, "t {pair}");
                            numbers(&mut out, first);
                            numbers(&mut out, second);
                        }
                    }
                    _ = write!(out, " *{weight}");
                }
            }
        }
        out.push('\n');
    }
    let sum = sha256(out.as_bytes());
    out + "end " + &sum + "\n"
}

impl Proof {
    /// Reads a proof and checks that its trees leave nothing out. The line, from 1, and the problem otherwise.
    pub fn read(text: &str) -> Result<Proof, (usize, String)> {
        let body = text.strip_suffix('\n').and_then(|text| text.rfind('\n').map(|at| text.split_at(at + 1)));
        let lines = text.matches('\n').count().max(1);
        let (body, end) = body.ok_or((lines, "the file is cut off".to_owned()))?;
        match end.strip_prefix("end ") {
            None => return Err((lines, "the last line is missing: the file is cut off".into())),
            Some(sum) if sum != sha256(body.as_bytes()) => {
                return Err((lines, "the file was edited: its SHA-256 is another".into()));
            }
            Some(_) => {}
        }
        let (first, rest) = body.split_once('\n').unwrap_or((body, ""));
        let claim: Claim = serde_json::from_str(first).map_err(|e| (1, e.to_string()))?;
        let cell = claim.cell().map_err(|e| (1, e))?;
        let design = claim.design["name"].as_str().unwrap_or_default().to_owned();
        let mut proof = Proof { claim, design, cell, boxes: Vec::new(), nodes: 0 };
        let mut lines = rest.lines();
        for root in proof.cell.roots.clone() {
            proof.tree(root, &mut lines)?;
        }
        match lines.next() {
            None => Ok(proof),
            Some(_) => Err((proof.nodes + 2, "more nodes than the trees have".into())),
        }
    }

    fn tree<'a>(&mut self, root: Piece, lines: &mut impl Iterator<Item = &'a str>) -> Result<(), (usize, String)> {
        let mut left = vec![(root, 0)];
        while let Some((piece, depth)) = left.pop() {
            self.nodes += 1;
            let line = self.nodes + 1;
            let wrong = |problem: &str| (line, problem.to_owned());
            let node = lines.next().ok_or_else(|| wrong("a branch of the tree is missing"))?;
            match node_of(node).ok_or_else(|| wrong("no node of a proof"))? {
                Node::Split(unknown) => {
                    let halves = piece.halves(unknown).filter(|_| depth < DEPTH);
                    let [low, high] = halves.ok_or_else(|| wrong("this box cannot be split"))?;
                    left.extend([(high, depth + 1), (low, depth + 1)]);
                }
                Node::OutOfOrder if self.cell.out_of_order(&piece) => {}
                Node::OutOfOrder => return Err(wrong("this box is not out of order")),
                Node::Open if self.claim.allows(&piece) => {}
                Node::Open => {
                    let words = format!("a box with l1 up to {} is not refuted, above the claim", piece.hi[0] - 1.0);
                    return Err((line, words));
                }
                Node::Refuted(terms) => self.boxes.push(Leaf { piece, terms, line }),
            }
        }
        Ok(())
    }

    /// Boxes that are refuted.
    pub fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Nodes of all trees.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Checks box `k`, counted from 0: that its inequalities contradict each other. Its line otherwise.
    pub fn check(&self, k: usize) -> Result<(), usize> {
        let Leaf { piece, terms, line } = &self.boxes[k];
        if self.cell.refutes(&Rings::of(piece), terms) { Ok(()) } else { Err(*line) }
    }
}

/// The node of a line.
fn node_of(line: &str) -> Option<Node> {
    let mut words = line.split(' ').peekable();
    match *words.peek()? {
        "=" if line == "=" => return Some(Node::OutOfOrder),
        "?" if line == "?" => return Some(Node::Open),
        "/" => {
            words.next();
            let unknown = words.next()?.parse().ok().filter(|k| *k < super::form::UNKNOWNS)?;
            return words.next().is_none().then_some(Node::Split(unknown));
        }
        _ => {}
    }
    let mut terms = Vec::new();
    while let Some(kind) = words.next() {
        let pair = words.next()?.parse().ok()?;
        let mut number = || words.next()?.parse::<i32>().ok();
        let reason = match kind {
            "s" => Reason::Turn { pair },
            "u" => Reason::Through { pair },
            "a" => Reason::Apart { pair, along: chosen(&mut number)? },
            "p" => Reason::Plane { pair, of: which(number()?)?, below: which(number()?)? == 1 },
            "c" => Reason::Chord { pair, of: which(number()?)? },
            "t" => Reason::Touch { pair, first: chosen(&mut number)?, second: chosen(&mut number)? },
            _ => return None,
        };
        terms.push((reason, words.next()?.strip_prefix('*')?.parse().ok()?));
    }
    Some(Node::Refuted(terms))
}

fn chosen(number: &mut impl FnMut() -> Option<i32>) -> Option<Chosen> {
    Some([number()?, number()?, number()?])
}

/// 0 or 1.
fn which(number: i32) -> Option<usize> {
    usize::try_from(number).ok().filter(|x| *x < 2)
}
