//! Forms enclose what they stand for: compared in arithmetic of twice the digits.

use super::form::{Form, UNKNOWNS};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// A sum of two doubles, to some 1e-32.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn of(x: f64) -> Double {
        Double(x, 0.0)
    }

    fn add(self, y: Double) -> Double {
        let s = self.0 + y.0;
        let v = s - self.0;
        let rest = (self.0 - (s - v)) + (y.0 - v) + self.1 + y.1;
        let sum = s + rest;
        Double(sum, rest - (sum - s))
    }

    fn mul(self, y: Double) -> Double {
        let p = self.0 * y.0;
        let rest = self.0.mul_add(y.0, -p) + self.0 * y.1 + self.1 * y.0;
        let sum = p + rest;
        Double(sum, rest - (sum - p))
    }

    fn minus(self, y: Double) -> Double {
        self.add(Double(-y.0, -y.1))
    }
}

/// c + Σ b y, and r times `end` with an end in [−1, 1].
fn at(form: &Form, y: &[f64; UNKNOWNS], end: f64) -> Double {
    let linear = (0..UNKNOWNS).fold(Double::of(form.c), |sum, i| sum.add(Double::of(form.b[i]).mul(Double::of(y[i]))));
    linear.add(Double::of(form.r).mul(Double::of(end)))
}

fn holds(form: &Form, y: &[f64; UNKNOWNS], value: Double) -> bool {
    let off = value.minus(at(form, y, 0.0));
    // The comparison itself errs by some 1e-30.
    off.0.abs() <= form.r && value.0 <= form.sup() && value.0 >= form.inf()
}

struct Random(ChaCha8Rng);

impl Random {
    fn size(&mut self) -> f64 {
        let size = 10_f64.powf(self.0.random_range(-9.0..3.0));
        size * self.0.random_range(-1.0..1.0)
    }

    fn form(&mut self) -> Form {
        let mut form = Form::about(self.size(), if self.0.random() { 0.0 } else { self.size().abs() });
        for b in &mut form.b {
            *b = if self.0.random() { self.size() } else { 0.0 };
        }
        form
    }

    fn corner(&mut self) -> [f64; UNKNOWNS] {
        // Corners are where bounds are met.
        std::array::from_fn(|_| match self.0.random_range(0..3) {
            0 => 1.0,
            1 => -1.0,
            _ => self.0.random_range(-1.0..1.0),
        })
    }
}

#[test]
fn sums_and_products_are_enclosed() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1));
    for _ in 0..20_000 {
        let (f, g, y) = (random.form(), random.form(), random.corner());
        let [p, q] = [0, 1].map(|_| [-1.0, 0.0, 1.0][random.0.random_range(0..3)]);
        let (x, z) = (at(&f, &y, p), at(&g, &y, q));
        assert!(holds(&f.add(&g), &y, x.add(z)));
        assert!(holds(&f.sub(&g), &y, x.minus(z)));
        assert!(holds(&f.mul(&g), &y, x.mul(z)), "{f:?} {g:?}");
        let k = random.size();
        assert!(holds(&f.times(k), &y, x.mul(Double::of(k))));
        assert!(holds(&f.plus(k), &y, x.add(Double::of(k))));
    }
}

#[test]
fn inverse_roots_are_enclosed() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(2));
    let mut tried = 0;
    while tried < 20_000 {
        let (f, y) = (random.form(), random.corner());
        let Some(root) = f.inverse_root() else { continue };
        tried += 1;
        let x = at(&f, &y, 0.0);
        let k = 1.0 / x.0.sqrt();
        // One step of Newton's method in twice the digits: k (3 − x k²)/2.
        let (k, three) = (Double::of(k), Double::of(3.0));
        let value = k.mul(three.minus(x.mul(k).mul(k))).mul(Double::of(0.5));
        assert!(holds(&root, &y, value), "{f:?}");
    }
    assert!(Form::about(1.0, 1.0).inverse_root().is_none());
    assert!(Form::about(f64::NAN, 1.0).inverse_root().is_none());
}

#[test]
fn an_unknown_covers_its_ends() {
    let mut random = Random(ChaCha8Rng::seed_from_u64(3));
    for _ in 0..20_000 {
        let (a, b) = (random.size(), random.size());
        let (lo, hi) = (a.min(b), a.max(b));
        let form = Form::unknown(3, lo, hi);
        let (least, most) =
            (Double::of(form.c).minus(Double::of(form.b[3])), Double::of(form.c).add(Double::of(form.b[3])));
        assert!(least.minus(Double::of(lo)).0 <= 0.0 && most.minus(Double::of(hi)).0 >= 0.0);
    }
}

#[test]
fn what_is_no_number_refutes_nothing() {
    let refutes = |form: &Form| form.sup() < 0.0;
    let nothing = Form::about(f64::NAN, 0.0);
    assert!(!refutes(&nothing) && !refutes(&nothing.add(&Form::number(-1.0))));
    let large = Form::number(f64::MAX);
    let square = large.mul(&large).neg();
    assert!(!refutes(&square.sub(&square)));
    assert!(refutes(&Form::number(-1.0)));
}
