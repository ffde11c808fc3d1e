//! Branch and bound: boxes with the largest l1 first, split until they are refuted or the limits of the search are reached.

use crate::choose::Chooser;
use maille_verify::proof::{Cell, Claim, Node, Piece, Reason};
use rayon::prelude::*;
use std::{
    cmp::Ordering,
    collections::BinaryHeap,
    sync::atomic::{self, AtomicBool},
    time::{Duration, Instant},
};

/// Boxes that are looked at between two looks at the clock; a fixed number, so that the proof does not depend on threads.
const ROUND: usize = 256;
/// A box whose widest side is narrower holds a state, or a proof needs other inequalities.
const NARROWEST: f64 = 1e-6;
/// How wide an unknown counts when the widest is split: 1 + l1, the place, the height, the normals.
const WIDTHS: [f64; 8] = [2.0, 1.0, 1.0, 0.7, 1.0, 1.0, 1.0, 1.0];

/// When the search ends without a proof.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Boxes at most.
    pub boxes: usize,
    /// Time at most.
    pub time: Duration,
}

/// Where a search stands.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// No state has a larger l1: proved so far.
    pub l1_at_most: f64,
    /// Boxes that were looked at.
    pub boxes: usize,
    /// Boxes that are left.
    pub open: usize,
}

/// What came of a search.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// No state has a larger l1: proved by the nodes.
    pub l1_at_most: f64,
    /// Boxes that were looked at.
    pub boxes: usize,
    /// Boxes that are left.
    pub open: usize,
    /// Whether a box was left that is too narrow to be split.
    pub narrow: bool,
    /// Whether the flag ended it.
    pub interrupted: bool,
    nodes: Vec<Found>,
    roots: usize,
}

#[derive(Clone, Debug)]
enum Found {
    Open,
    OutOfOrder,
    Refuted(Vec<(Reason, u32)>),
    /// Along which unknown, and where the two halves are.
    Split(usize, usize),
}

/// A box in the queue.
struct Waiting {
    piece: Piece,
    node: usize,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.piece.hi[0].total_cmp(&other.piece.hi[0]).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

/// The unknown that is split: the widest.
fn widest(piece: &Piece) -> (usize, f64) {
    let width = |i: usize| (piece.hi[i] - piece.lo[i]) * WIDTHS[i];
    (0..WIDTHS.len()).map(|i| (i, width(i))).max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).unwrap_or((0, 0.0))
}

/// What is found out about one box.
enum Judged {
    Leaf(Found),
    /// Along which unknown.
    Halves(usize, Box<[Piece; 2]>),
    TooNarrow,
}

fn judged(cell: &Cell, chooser: &Chooser<'_>, piece: &Piece) -> Judged {
    if cell.out_of_order(piece) {
        return Judged::Leaf(Found::OutOfOrder);
    }
    if let Some(terms) = chooser.refutation(piece) {
        return Judged::Leaf(Found::Refuted(terms));
    }
    let (unknown, width) = widest(piece);
    match piece.halves(unknown).filter(|_| width > NARROWEST) {
        Some(halves) => Judged::Halves(unknown, Box::new(halves)),
        None => Judged::TooNarrow,
    }
}

/// Looks for a proof that no state of the cell has l1 above that of its roots.
///
/// `cancel` ends it; `told` is called now and then. The outcome depends on neither threads nor time, unless the time is up.
pub fn search(cell: &Cell, options: Options, cancel: &AtomicBool, told: impl Fn(&Progress)) -> Outcome {
    let begun = Instant::now();
    let chooser = Chooser::new(cell);
    let least = cell.roots.first().map_or(1.0, |root| root.lo[0]);
    let mut nodes = vec![Found::Open; cell.roots.len()];
    let mut queue: BinaryHeap<Waiting> =
        cell.roots.iter().enumerate().map(|(node, piece)| Waiting { piece: *piece, node }).collect();
    let (mut boxes, mut narrow, mut interrupted) = (0, false, false);
    let above = |queue: &BinaryHeap<Waiting>| queue.peek().map(|top| (top.piece.hi[0] - 1.0).next_up());
    while let Some(l1_at_most) = above(&queue) {
        told(&Progress { l1_at_most, boxes, open: queue.len() });
        interrupted = cancel.load(atomic::Ordering::Relaxed);
        if interrupted || narrow || boxes >= options.boxes || begun.elapsed() >= options.time {
            break;
        }
        let round: Vec<Waiting> = (0..ROUND).map_while(|_| queue.pop()).collect();
        boxes += round.len();
        let found: Vec<_> = round.par_iter().with_max_len(8).map(|of| judged(cell, &chooser, &of.piece)).collect();
        for (of, found) in round.into_iter().zip(found) {
            match found {
                Judged::Leaf(found) => nodes[of.node] = found,
                Judged::Halves(unknown, halves) => {
                    let first = nodes.len();
                    nodes[of.node] = Found::Split(unknown, first);
                    nodes.extend([Found::Open, Found::Open]);
                    queue.extend([0, 1].map(|k| Waiting { piece: halves[k], node: first + k }));
                }
                Judged::TooNarrow => {
                    narrow = true;
                    queue.push(of);
                }
            }
        }
    }
    let l1_at_most = above(&queue).unwrap_or(f64::NEG_INFINITY).max(least - 1.0);
    Outcome { l1_at_most, boxes, open: queue.len(), narrow, interrupted, nodes, roots: cell.roots.len() }
}

impl Outcome {
    /// Whether no box is left.
    pub fn closed(&self) -> bool {
        self.open == 0
    }

    /// The claim that was proved: that of all boxes if none is left, else a weaker one.
    pub fn claim(&self, asked: Claim) -> Claim {
        let l1_at_most = if self.closed() { asked.l1_from } else { self.l1_at_most.max(asked.l1_from) };
        Claim { l1_at_most, ..asked }
    }

    /// The trees of all roots in turn, each node before its branches.
    pub fn nodes(&self) -> impl Iterator<Item = Node> {
        let mut left: Vec<usize> = (0..self.roots).rev().collect();
        std::iter::from_fn(move || {
            Some(match &self.nodes[left.pop()?] {
                Found::Open => Node::Open,
                Found::OutOfOrder => Node::OutOfOrder,
                Found::Refuted(terms) => Node::Refuted(terms.clone()),
                Found::Split(unknown, first) => {
                    left.extend([first + 1, *first]);
                    Node::Split(*unknown)
                }
            })
        })
    }
}
