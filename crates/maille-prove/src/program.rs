//! The small linear program that finds weights: min Σ c_k μ_k + Σ_i |Σ_k μ_k b_ki| over μ ≥ 0 with Σ μ_k = 1.
//!
//! Its value is the largest t for which some y in [−1, 1]^8 has c_k + b_k·y ≥ t for all k; below 0, the weights refute the box.
//! Primal simplex on a dense tableau with 9 rows, from the best single inequality.

const UNKNOWNS: usize = 8;
const ROWS: usize = UNKNOWNS + 1;
/// Steps at most, and steps after which Bland's rule ends cycles.
const STEPS: usize = 120;
const BLAND: usize = 60;
/// A reduced cost above this is none.
const OPTIMAL: f64 = -1e-10;
/// A smaller pivot is none.
const PIVOT: f64 = 1e-9;

/// One inequality: the largest constant part, and the linear one.
pub(crate) struct Row {
    pub(crate) c: f64,
    pub(crate) b: [f64; UNKNOWNS],
}

struct Tableau {
    rows: Vec<Vec<f64>>,
    costs: Vec<f64>,
    basis: [usize; ROWS],
}

impl Tableau {
    /// With μ = 1 for the best single inequality. The columns are μ_k, then n_i and p_i with Σ μ b_i + n_i − p_i = 0, then the right side.
    fn new(given: &[Row]) -> Tableau {
        let (count, columns) = (given.len(), given.len() + 2 * UNKNOWNS);
        let alone = |row: &Row| row.c + row.b.iter().map(|b| b.abs()).sum::<f64>();
        let best = (0..count).min_by(|&i, &j| alone(&given[i]).total_cmp(&alone(&given[j]))).unwrap_or(0);
        let mut rows = vec![vec![0.0; columns + 1]; ROWS];
        let mut basis = [best; ROWS];
        for i in 0..UNKNOWNS {
            let sign = if given[best].b[i] > 0.0 { -1.0 } else { 1.0 };
            for (k, row) in given.iter().enumerate() {
                rows[i][k] = sign * (row.b[i] - given[best].b[i]);
            }
            rows[i][count + i] = sign;
            rows[i][count + UNKNOWNS + i] = -sign;
            rows[i][columns] = -sign * given[best].b[i];
            basis[i] = if sign > 0.0 { count + i } else { count + UNKNOWNS + i };
        }
        rows[UNKNOWNS][..count].fill(1.0);
        rows[UNKNOWNS][columns] = 1.0;
        let cost = |j: usize| given.get(j).map_or(1.0, |row| row.c);
        let reduced = |j: usize| {
            let own = if j < columns { cost(j) } else { 0.0 };
            own - (0..ROWS).map(|i| cost(basis[i]) * rows[i][j]).sum::<f64>()
        };
        let costs = (0..=columns).map(reduced).collect();
        Tableau { rows, costs, basis }
    }

    /// One step; false at the end.
    fn step(&mut self, bland: bool) -> bool {
        let columns = self.costs.len() - 1;
        let entering = match bland {
            true => (0..columns).find(|&j| self.costs[j] < OPTIMAL),
            false => (0..columns).min_by(|&i, &j| self.costs[i].total_cmp(&self.costs[j])),
        };
        let Some(entering) = entering.filter(|&j| self.costs[j] < OPTIMAL) else { return false };
        let ratio = |i: &usize| self.rows[*i][columns] / self.rows[*i][entering];
        let leaving =
            (0..ROWS).filter(|&i| self.rows[i][entering] > PIVOT).min_by(|i, j| ratio(i).total_cmp(&ratio(j)));
        let Some(leaving) = leaving else { return false };
        let pivot = self.rows[leaving][entering];
        self.rows[leaving].iter_mut().for_each(|x| *x /= pivot);
        let row = self.rows[leaving].clone();
        let others = self.rows.iter_mut().enumerate().filter(|(i, _)| *i != leaving).map(|(_, other)| other);
        for other in others.chain([&mut self.costs]) {
            let by = other[entering];
            if by != 0.0 {
                other.iter_mut().zip(&row).for_each(|(x, y)| *x -= by * y);
            }
        }
        self.basis[leaving] = entering;
        true
    }
}

/// The value and the weights.
pub(crate) fn weights(given: &[Row]) -> (f64, Vec<f64>) {
    let mut tableau = Tableau::new(given);
    for step in 0..STEPS {
        if !tableau.step(step >= BLAND) {
            break;
        }
    }
    let last = tableau.costs.len() - 1;
    let mut out = vec![0.0; given.len()];
    for (i, basic) in tableau.basis.iter().enumerate() {
        if let Some(weight) = out.get_mut(*basic) {
            *weight = tableau.rows[i][last].max(0.0);
        }
    }
    (-tableau.costs[last], out)
}
