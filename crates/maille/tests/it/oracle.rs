//! The quadratic and the cone solver against Clarabel, on random programs.
//!
//! Clarabel's positive cones need LAPACK. A 4×4 matrix V (A ⊕ B) Vᵀ with 2×2 blocks A and B and a rotation V is positive where
//! both blocks are, and [[a, b], [b, c]] is where |(a − c, 2b)| ≤ a + c: that is a norm, which it has without.

use clarabel::{
    algebra::CscMatrix,
    solver::{
        DefaultSettingsBuilder, DefaultSolution, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT,
        SolverStatus, SupportedConeT,
    },
};
use maille::solver::{
    cone::{Cone, ConeProgram, pack},
    qp::{QuadraticProgram, SparseRows, solve},
    symmetric::Symmetric,
};
use nalgebra::{DMatrix, DVector, Matrix4};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

fn sparse(m: &DMatrix<f64>, upper: bool) -> CscMatrix<f64> {
    let entries = (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| (i, j)));
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in entries.filter(|&(i, j)| m[(i, j)] != 0.0 && (!upper || i <= j)) {
        rows.push(i);
        columns.push(j);
        values.push(m[(i, j)]);
    }
    CscMatrix::new_from_triplets(m.nrows(), m.ncols(), rows, columns, values)
}

/// Clarabel's solution of min ½ xᵀPx + qᵀx with b − A x in the cones.
fn clarabel(
    p: &DMatrix<f64>,
    q: &DVector<f64>,
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    cones: &[SupportedConeT<f64>],
) -> DefaultSolution<f64> {
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-11)
        .tol_gap_rel(1e-11)
        .tol_feas(1e-11)
        .build()
        .expect("settings");
    let (p, a) = (sparse(p, true), sparse(a, false));
    let mut solver = DefaultSolver::new(&p, q.as_slice(), &a, b.as_slice(), cones, settings).expect("a program");
    solver.solve();
    assert!(
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
        "{:?}",
        solver.solution
    );
    solver.solution
}

/// H of every rank, rows that are repeated, and rows that hold at a common point: the same value, and the same x where
/// it is the only one. Where no point is inside, the last finite iterate is the answer.
#[test]
fn quadratic_programs_agree_with_clarabel() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for case in 0..200 {
        let n = rng.random_range(1..16usize);
        let m = rng.random_range(0..25usize);
        let rank = case % (n + 2);
        let mut random = |size: f64| size * rng.random_range(-1.0..1.0);
        let root = DMatrix::from_fn(n, rank, |_, _| random(1.0));
        let h = &root * root.transpose();
        let linear = DVector::from_fn(n, |_, _| random(1.0));
        let width = DVector::from_fn(n, |_, _| 1.0 + random(0.9));
        let inside = DVector::from_fn(n, |i, _| random(0.9) * width[i]);
        let mut rows = DMatrix::from_fn(m, n, |_, _| if random(1.0) < 0.3 { random(1.0) } else { 0.0 });
        if m > 1 {
            let first = rows.row(0).into_owned();
            rows.row_mut(m - 1).copy_from(&first);
        }
        // Half of the rows hold with equality at that point, few enough that some points are inside, or so many that none is.
        let no_interior = case % 5 == 0;
        let slack = DVector::from_fn(m, |k, _| if no_interior || k < n / 2 { random(0.5).max(0.0) } else { 0.5 });
        let lower = &rows * &inside - slack;

        let mut hessian = Symmetric::new(n, []);
        let all: Vec<usize> = (0..n).collect();
        hessian.add(&all, |i, j| h[(i, j)]);
        let mut sparse_rows = SparseRows::default();
        (0..m).for_each(|k| sparse_rows.push((0..n).map(|i| (i, rows[(k, i)])).filter(|(_, a)| *a != 0.0)));
        let found = solve(&QuadraticProgram {
            hessian: &hessian,
            linear: linear.as_slice(),
            rows: &sparse_rows,
            lower: lower.as_slice(),
            half_width: width.as_slice(),
        });

        assert!(found.x.iter().all(|x| x.is_finite()), "case {case}");
        if no_interior {
            continue; // a program that its callers never pose
        }
        let unit = DMatrix::identity(n, n);
        let a = DMatrix::from_fn(m + 2 * n, n, |k, i| match k {
            k if k < m => -rows[(k, i)],
            k if k < m + n => unit[(k - m, i)],
            k => -unit[(k - m - n, i)],
        });
        let b = DVector::from_fn(m + 2 * n, |k, _| if k < m { -lower[k] } else { width[(k - m) % n] });
        let expected = clarabel(&h, &linear, &a, &b, &[NonnegativeConeT(m + 2 * n)]);

        let x = DVector::from_vec(found.x);
        let value = 0.5 * x.dot(&(&h * &x)) + linear.dot(&x);
        assert!((value - expected.obj_val).abs() < 1e-8, "case {case}: {value} {}", expected.obj_val);
        assert!((&b - &a * &x).min() > -1e-8, "case {case} is not feasible");
        if rank >= n && h.symmetric_eigenvalues().min() > 1e-3 {
            let apart = (&x - DVector::from_vec(expected.x)).amax();
            assert!(apart < 1e-5, "case {case}: {apart:e}");
        }
        assert!(found.multipliers.iter().all(|mu| *mu >= 0.0));
    }
}

/// A rotation of four axes.
fn turned(random: &mut impl FnMut() -> f64) -> Matrix4<f64> {
    Matrix4::from_fn(|_, _| random()).qr().q()
}

/// Norms, and 4×4 matrices of two blocks, strictly feasible on both sides: the same value, and z proves it.
#[test]
fn cone_programs_agree_with_clarabel() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for case in 0..60 {
        let (n, norms, matrices) = (rng.random_range(1..9usize), rng.random_range(2..8usize), case % 3);
        let mut random = || rng.random_range(-1.0..1.0);
        let rows = 4 * norms + 10 * matrices;
        let (mut g, mut h) = (DMatrix::zeros(rows, n), DVector::zeros(rows));
        // Two norms of three rows for each matrix, with the same unknowns.
        let (mut clarabel_g, mut clarabel_h) =
            (DMatrix::zeros(4 * norms + 6 * matrices, n), DVector::zeros(4 * norms + 6 * matrices));
        let x = DVector::from_fn(n, |_, _| random());
        let mut cost = DVector::zeros(n);
        for k in 0..norms {
            let part = DMatrix::from_fn(4, n, |_, _| random());
            let inner =
                |random: &mut dyn FnMut() -> f64| DVector::from_fn(4, |i, _| if i == 0 { 2.0 } else { random() });
            let (s, z) = (inner(&mut random), inner(&mut random));
            cost -= part.tr_mul(&z);
            for (g, h) in [(&mut g, &mut h), (&mut clarabel_g, &mut clarabel_h)] {
                g.rows_mut(4 * k, 4).copy_from(&part);
                h.rows_mut(4 * k, 4).copy_from(&(&part * &x + &s));
            }
        }
        for k in 0..matrices {
            let turn = turned(&mut random);
            let (at, at_norms) = (4 * norms + 10 * k, 4 * norms + 6 * k);
            let blocks = |[a, b, c, d, e, f]: [f64; 6]| {
                Matrix4::new(a, b, 0.0, 0.0, b, c, 0.0, 0.0, 0.0, 0.0, d, e, 0.0, 0.0, e, f)
            };
            let column = |of: [f64; 6], g: &mut [f64], h: &mut [f64]| {
                g.copy_from_slice(&pack(&(turn * blocks(of) * turn.transpose())));
                let [a, b, c, d, e, f] = of;
                h.copy_from_slice(&[a + c, a - c, 2.0 * b, d + f, d - f, 2.0 * e]);
            };
            let mut centre = [1.5, 0.0, 1.5, 1.5, 0.0, 1.5];
            for j in 0..n {
                let of: [f64; 6] = std::array::from_fn(|_| random());
                column(
                    of,
                    &mut g.column_mut(j).as_mut_slice()[at..at + 10],
                    &mut clarabel_g.column_mut(j).as_mut_slice()[at_norms..at_norms + 6],
                );
                (0..6).for_each(|i| centre[i] += x[j] * of[i]);
                cost[j] -= of[0] + of[2] + of[3] + of[5]; // z is the unit matrix
            }
            column(centre, &mut h.as_mut_slice()[at..at + 10], &mut clarabel_h.as_mut_slice()[at_norms..at_norms + 6]);
        }
        let cones = [vec![SecondOrderConeT(4); norms], vec![SecondOrderConeT(3); 2 * matrices]].concat();
        let expected = clarabel(&DMatrix::zeros(n, n), &cost, &clarabel_g, &clarabel_h, &cones);
        let cones = [vec![Cone::Norm; norms], vec![Cone::Positive; matrices]].concat();
        let program = ConeProgram { cost, matrix: g, offset: h, cones };
        let found = program.solve(|_| false);

        let value = program.cost.dot(&found.x);
        let size = 1.0 + value.abs();
        assert!(found.residual < 1e-8, "case {case}: {:e}", found.residual);
        assert!((value - expected.obj_val).abs() < 1e-7 * size, "case {case}: {value} {}", expected.obj_val);
        let dual = -program.offset.dot(&found.z);
        assert!((dual - value).abs() < 1e-7 * size, "case {case}: {dual} {value}");
        let balance = (program.matrix.tr_mul(&found.z) + &program.cost).amax();
        assert!(balance < 1e-7 * size, "case {case}: {balance:e}");
    }
}
