mod common;
use std::time::Instant;
#[test]
fn time() {
    for (name, f) in common::FAMILIES.iter().chain([("degenerate", common::degenerate as fn(&mut common::Rng)->common::Pair)].iter()) {
        let mut rng = common::rng(77);
        let pairs: Vec<_> = (0..20000).map(|_| f(&mut rng)).collect();
        let mut best = f64::INFINITY; let mut s=0.0;
        let mut hist = vec![];
        for _ in 0..3 { let t=Instant::now(); for (a,b) in &pairs { s+=maille_geometry::circle_distance_minima(a,b).closest().distance; } best=best.min(t.elapsed().as_secs_f64()/pairs.len() as f64); }
        for (a,b) in &pairs { let t=Instant::now(); s+=maille_geometry::circle_distance_minima(a,b).closest().distance; hist.push(t.elapsed().as_nanos()); }
        hist.sort();
        println!("{name}: {:.0} ns mean, median {} 90% {} 99% {} 99.9% {} max {}", best*1e9, hist[10000],hist[18000],hist[19800],hist[19980],hist[19999]);
        assert!(s.is_finite());
    }
}
