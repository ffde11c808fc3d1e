//! Numbers that depend on a point of a box, enclosed with outward rounding.
//!
//! A box is the image of [−1, 1]^8, and a [`Form`] stands for all functions f of y with
//!
//! |f(y) − c − Σ b_i y_i| ≤ r    for all y in [−1, 1]^8.
//!
//! Sums keep the linear part, so what cancels between two forms cancels; products and roots put what is not linear into r. Forms
//! without a linear part are intervals.
//!
//! **Rounding.** One operation of IEEE arithmetic errs by at most 2⁻⁵³ of its result, and by 2⁻¹⁰⁷⁵ if that underflows. Every
//! operation here adds at least twice that for each rounding to r, and `up` makes up for the rounding of r itself. A number
//! that overflows or is not a number ends as an r that is no number, and with such a form nothing is ever refuted: all
//! comparisons that refute are false for it.

/// Unknowns of a cell of two rings.
pub const UNKNOWNS: usize = 8;

/// Twice the relative error of one operation.
const U: f64 = f64::EPSILON;

/// An upper bound of a sum or product of fewer than a hundred numbers that are not negative, which was computed as `x`.
pub(crate) fn up(x: f64) -> f64 {
    x * (1.0 + 64.0 * U) + f64::MIN_POSITIVE
}

/// A function of a point of a box: constant and linear part, and how far it is from them at most.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// Constant.
    pub c: f64,
    /// Coefficients of the y_i.
    pub b: [f64; UNKNOWNS],
    /// Largest distance.
    pub r: f64,
}

impl Form {
    /// A number.
    pub(crate) const fn number(c: f64) -> Form {
        Form { c, b: [0.0; UNKNOWNS], r: 0.0 }
    }

    /// A number that is known to `r`.
    pub(crate) const fn about(c: f64, r: f64) -> Form {
        Form { c, b: [0.0; UNKNOWNS], r }
    }

    /// The unknown `i`, which is in [lo, hi].
    pub(crate) fn unknown(i: usize, lo: f64, hi: f64) -> Form {
        let mut out = Form::number(0.5 * lo + 0.5 * hi);
        out.b[i] = (out.c - lo).max(hi - out.c).next_up();
        out
    }

    /// Σ |b_i|.
    fn spread(&self) -> f64 {
        self.b.iter().map(|b| b.abs()).sum()
    }

    /// An upper bound.
    pub fn sup(&self) -> f64 {
        let s = self.spread() + self.r;
        self.c + s + up(16.0 * U * (self.c.abs() + s))
    }

    /// A lower bound.
    pub fn inf(&self) -> f64 {
        -self.neg().sup()
    }

    /// The largest absolute value, rounded up; no number if the form is none.
    pub(crate) fn size(&self) -> f64 {
        let s = self.c.abs() + self.spread() + self.r;
        up(s)
    }

    /// −f.
    pub(crate) fn neg(&self) -> Form {
        Form { c: -self.c, b: self.b.map(|b| -b), r: self.r }
    }

    /// f + g.
    pub fn add(&self, other: &Form) -> Form {
        let (c, mut b) = (self.c + other.c, [0.0; UNKNOWNS]);
        let mut size = c.abs();
        for (i, b) in b.iter_mut().enumerate() {
            *b = self.b[i] + other.b[i];
            size += b.abs();
        }
        Form { c, b, r: up(self.r + other.r + U * size) }
    }

    /// f − g.
    pub(crate) fn sub(&self, other: &Form) -> Form {
        self.add(&other.neg())
    }

    /// k f.
    pub fn times(&self, k: f64) -> Form {
        let (c, b) = (self.c * k, self.b.map(|b| b * k));
        let size = c.abs() + b.iter().map(|b| b.abs()).sum::<f64>();
        // An underflow of each of the nine products is far below the least normal number, which `up` adds.
        Form { c, b, r: up(self.r * k.abs() + U * size) }
    }

    /// f + k.
    pub(crate) fn plus(&self, k: f64) -> Form {
        let c = self.c + k;
        Form { c, b: self.b, r: up(self.r + U * c.abs()) }
    }

    /// f g. Of the quadratic part, y_i² is in [0, 1] and y_i y_j in [−1, 1].
    pub(crate) fn mul(&self, other: &Form) -> Form {
        let mut b = [0.0; UNKNOWNS];
        let (mut squares, mut size, mut mixed) = (0.0, 0.0, 0.0);
        for (i, b) in b.iter_mut().enumerate() {
            *b = self.c * other.b[i] + other.c * self.b[i];
            let square = self.b[i] * other.b[i];
            squares += square;
            size += square.abs();
            for j in 0..i {
                mixed += (self.b[i] * other.b[j] + other.b[i] * self.b[j]).abs();
            }
        }
        let (x, y) = (self.c.abs() + self.spread(), other.c.abs() + other.spread());
        let rest = self.r * y + other.r * x + self.r * other.r;
        let rounding = 64.0 * U * ((x + self.r) * (y + other.r));
        Form { c: self.c * other.c + 0.5 * squares, b, r: up(0.5 * size + mixed + rest + rounding) }
    }

    /// 1/√f; none if f may be 0 or less.
    ///
    /// The function is convex: it is above its tangent at c, and farthest from it at an end of the range.
    pub(crate) fn inverse_root(&self) -> Option<Form> {
        let (lo, hi, c) = (self.inf(), self.sup(), self.c);
        if !(lo > 1e-100 && hi < 1e100) {
            return None;
        }
        let f = |x: f64| 1.0 / x.sqrt();
        let (value, slope) = (f(c), -0.5 * f(c) / c);
        let above = |x: f64| f(x) - (value + slope * (x - c));
        let most = above(lo).max(above(hi)).max(0.0);
        let rounding = 64.0 * U * (f(lo) + value + slope.abs() * (hi + c));
        let mut out = self.plus(-c).times(slope).plus(value + 0.5 * most);
        out.r = up(out.r + 0.5 * most + rounding);
        Some(out)
    }
}

/// A vector of forms.
pub(crate) type Forms = [Form; 3];
/// A vector of numbers.
pub(crate) type Numbers = [f64; 3];

pub(crate) fn add(a: &Forms, b: &Forms) -> Forms {
    [a[0].add(&b[0]), a[1].add(&b[1]), a[2].add(&b[2])]
}

pub(crate) fn sub(a: &Forms, b: &Forms) -> Forms {
    [a[0].sub(&b[0]), a[1].sub(&b[1]), a[2].sub(&b[2])]
}

pub(crate) fn scaled(a: &Forms, k: &Form) -> Forms {
    [a[0].mul(k), a[1].mul(k), a[2].mul(k)]
}

pub(crate) fn dot(a: &Forms, b: &Forms) -> Form {
    a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
}

pub(crate) fn cross(a: &Forms, b: &Forms) -> Forms {
    let part = |i: usize, j: usize| a[i].mul(&b[j]).sub(&a[j].mul(&b[i]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// a·p for numbers p.
pub(crate) fn dot_numbers(a: &Forms, p: &Numbers) -> Form {
    a[0].times(p[0]).add(&a[1].times(p[1])).add(&a[2].times(p[2]))
}

/// a × p for numbers p.
pub(crate) fn cross_numbers(a: &Forms, p: &Numbers) -> Forms {
    let part = |i: usize, j: usize| a[i].times(p[j]).sub(&a[j].times(p[i]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// Vectors of plain numbers, for what a proof may choose as it likes.
pub mod plain {
    /// x·y.
    pub fn dot(x: &[f64; 3], y: &[f64; 3]) -> f64 {
        x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
    }

    /// x × y.
    pub fn cross(x: &[f64; 3], y: &[f64; 3]) -> [f64; 3] {
        [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
    }

    /// x + k y.
    pub fn add(x: &[f64; 3], k: f64, y: &[f64; 3]) -> [f64; 3] {
        [x[0] + k * y[0], x[1] + k * y[1], x[2] + k * y[2]]
    }

    /// |x|.
    pub fn length(x: &[f64; 3]) -> f64 {
        dot(x, x).sqrt()
    }

    /// x/|x|.
    pub fn unit(x: &[f64; 3]) -> [f64; 3] {
        x.map(|k| k / length(x))
    }

    /// x less its part along the unit vector n.
    pub fn across(x: &[f64; 3], n: &[f64; 3]) -> [f64; 3] {
        add(x, -dot(x, n), n)
    }
}
