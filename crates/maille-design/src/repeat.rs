//! Several cells of a design as one.

use crate::{Design, ElementSpec};
use std::collections::BTreeMap;

impl Design {
    /// The same sheet with `n` × `m` of its cells as one cell: lattice vectors n a1 and m a2, and a copy of every element for each cell
    /// (i, j), called `NAME-i-j`. So each copy's numbers can be changed by themselves. Formulas go along.
    ///
    /// # Panics
    /// For no cells.
    pub fn repeated(&self, n: usize, m: usize) -> Self {
        assert!(n > 0 && m > 0, "one cell or more");
        let mut out = self.clone();
        let times = |a: [f64; 3], k: usize| a.map(|x| x * k as f64);
        let (a1, a2) = (self.lattice.a1, self.lattice.a2);
        (out.lattice.a1, out.lattice.a2) = (times(a1, n), times(a2, m));
        let cells: Vec<[usize; 2]> = (0..m).flat_map(|j| (0..n).map(move |i| [i, j])).collect();
        if cells.len() == 1 {
            return out;
        }
        let copy = |[i, j]: [usize; 2], element: &ElementSpec| {
            let center = std::array::from_fn(|k| element.center[k] + i as f64 * a1[k] + j as f64 * a2[k]);
            ElementSpec { name: format!("{}-{i}-{j}", element.name), center, ..element.clone() }
        };
        out.elements = cells.iter().flat_map(|cell| self.elements.iter().map(|element| copy(*cell, element))).collect();
        out.formulas = self.repeated_formulas([n, m], &cells);
        out
    }

    fn repeated_formulas(&self, [n, m]: [usize; 2], cells: &[[usize; 2]]) -> BTreeMap<String, String> {
        let formula = |place: &str| self.formulas.get(place);
        let mut out = BTreeMap::new();
        for (place, text) in self.formulas.iter().filter(|(place, _)| !place.starts_with("elements[")) {
            let copies = if place.starts_with("lattice.a1") {
                n
            } else if place.starts_with("lattice.a2") {
                m
            } else {
                1
            };
            out.insert(place.clone(), if copies == 1 { text.clone() } else { format!("{copies} * ({text})") });
        }
        for (c, [i, j]) in cells.iter().enumerate() {
            for (e, element) in self.elements.iter().enumerate() {
                let (from, to) = (format!("elements[{e}]."), format!("elements[{}].", c * self.elements.len() + e));
                for (place, text) in self.formulas.iter() {
                    if let Some(number) = place
                        .strip_prefix(&from)
                        .filter(|number| number.starts_with("rings") || number.starts_with("curves"))
                    {
                        out.insert(to.clone() + number, text.clone());
                    }
                }
                for axis in 0..3 {
                    let parts = [
                        (1, formula(&format!("{from}center[{axis}]")), element.center[axis]),
                        (*i, formula(&format!("lattice.a1[{axis}]")), self.lattice.a1[axis]),
                        (*j, formula(&format!("lattice.a2[{axis}]")), self.lattice.a2[axis]),
                    ];
                    let used = || parts.iter().filter(|(times, _, _)| *times > 0);
                    if used().any(|(_, formula, _)| formula.is_some()) {
                        let term = |(times, formula, number): &(usize, Option<&String>, f64)| {
                            let text = formula.map_or(format!("{number}"), |text| text.clone());
                            if *times == 1 { format!("({text})") } else { format!("{times} * ({text})") }
                        };
                        out.insert(format!("{to}center[{axis}]"), used().map(term).collect::<Vec<_>>().join(" + "));
                    }
                }
            }
        }
        out
    }
}
