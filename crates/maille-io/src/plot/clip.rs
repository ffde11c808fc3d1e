//! Lines cut at the edge of what is shown.

/// The parts of a line through `points` that lie in a circle.
pub(super) fn to_circle(points: &[[f64; 2]], center: [f64; 2], radius: f64) -> Vec<Vec<[f64; 2]>> {
    parts(points, |from, to| {
        let (p, d) = ([from[0] - center[0], from[1] - center[1]], [to[0] - from[0], to[1] - from[1]]);
        let (dd, pd) = (d[0] * d[0] + d[1] * d[1], p[0] * d[0] + p[1] * d[1]);
        let outside = p[0] * p[0] + p[1] * p[1] - radius * radius;
        if dd == 0.0 {
            return [0.0, if outside <= 0.0 { 1.0 } else { -1.0 }];
        }
        let root_sq = pd * pd - dd * outside;
        if root_sq < 0.0 { [1.0, 0.0] } else { [-1.0, 1.0].map(|sign| (-pd + sign * root_sq.sqrt()) / dd) }
    })
}

/// The parts of a line through `points` that lie in the rectangle from `low` to `high`.
pub(super) fn to_rectangle(points: &[[f64; 2]], low: [f64; 2], high: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    parts(points, |from, to| {
        (0..2).fold([0.0, 1.0], |[first, last]: [f64; 2], axis| {
            let (p, d) = (from[axis], to[axis] - from[axis]);
            if d == 0.0 {
                let inside = (low[axis]..=high[axis]).contains(&p);
                return if inside { [first, last] } else { [1.0, 0.0] };
            }
            let ends = [(low[axis] - p) / d, (high[axis] - p) / d];
            [first.max(ends[0].min(ends[1])), last.min(ends[0].max(ends[1]))]
        })
    })
}

/// Parts of a line, of which `shown` gives the first and the last share of a segment that is inside; the first is
/// above the last where there is none.
fn parts(points: &[[f64; 2]], shown: impl Fn([f64; 2], [f64; 2]) -> [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut out: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut open = false;
    for ends in points.windows(2) {
        let [first, last] = shown(ends[0], ends[1]);
        let (first, last) = (first.max(0.0), last.min(1.0));
        let at = |t: f64| [0, 1].map(|i| ends[0][i] + t * (ends[1][i] - ends[0][i]));
        if first > last {
            open = false;
            continue;
        }
        match out.last_mut().filter(|_| open && first == 0.0) {
            Some(run) => run.push(at(last)),
            None => out.push(vec![at(first), at(last)]),
        }
        open = last == 1.0;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_where_it_leaves() {
        let zigzag = [[-2.0, 0.0], [0.0, 0.0], [0.0, 3.0], [3.0, 3.0], [0.5, 0.0], [0.0, 0.5]];
        let cut = to_circle(&zigzag, [0.0, 0.0], 1.0);
        assert_eq!(cut.len(), 2);
        assert_eq!(cut[0], [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]]);
        assert_eq!(cut[1][1..], [[0.5, 0.0], [0.0, 0.5]]);
        assert!((cut[1][0][0].hypot(cut[1][0][1]) - 1.0).abs() < 1e-12);

        let cut = to_rectangle(&zigzag, [-1.0, -1.0], [1.0, 1.0]);
        assert_eq!(cut.len(), 2);
        assert_eq!(cut[0], [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]]);
        assert!((cut[1][0][0] - 1.0).abs() < 1e-12 && (cut[1][0][1] - 0.6).abs() < 1e-12);
        assert!(to_circle(&[[2.0, 2.0], [2.0, -2.0]], [0.0; 2], 1.0).is_empty());
        assert!(to_rectangle(&[[2.0, 2.0], [2.0, -2.0]], [-1.0; 2], [1.0; 2]).is_empty());
    }
}
