use maille::{bound::*, lattice::Cell, model::Model};
fn model(name: &str, r: f64, cell: &str) -> Model {
    let d = maille_io::read_design(name, maille_io::builtin(name).unwrap()).unwrap().with_minor_radius(r);
    Model::compile(&d, cell.parse().unwrap()).unwrap()
}
#[test]
fn explore() {
    for name in ["1.1", "1.2", "1.3", "2", "3.1", "3.2", "3.3", "3.4", "4.1", "4.2", "4.3", "5.1", "5.2"] {
        let m = model(name, 0.1, "1x1");
        let t = std::time::Instant::now();
        let chain = ChainBound::new(&m);
        let t_chain = t.elapsed();
        let link = LinkBound::new(&m, &chain);
        let (mut n, mut better, mut worst_gap, mut it, mut itmax, mut unr, mut above) = (0, 0, 0.0f64, 0, 0, 0, 0.0f64);
        let mut tq = std::time::Duration::ZERO; let mut tl = tq; let mut gain = 0.0f64; let mut bc=0; let mut same=0.0f64;
        for k in 0..25 { for l2 in [-0.25, -0.125, 0.0, 0.125] {
            let dir = 7.5 * k as f64;
            let t = std::time::Instant::now();
            let b = chain.limit(dir, l2);
            tq += t.elapsed();
            let t = std::time::Instant::now();
            let s = link.limit(dir, l2);
            tl += t.elapsed();
            it += s.iterations; itmax = itmax.max(s.iterations); n += 1;
            match b {
                Bound::Finite { l1, .. } => {
                    worst_gap = worst_gap.max((s.l1 - s.primal_l1).abs());
                    if s.l1 <= -1.0 { unr += 1; println!("   link-unreachable {dir} {l2} {}", s.l1); }
                    else { if s.l1 < l1 - 1e-9 { better += 1; gain = gain.max(l1 - s.l1); } else { same = same.max((l1-s.l1).abs()); }
                      above = above.max(s.l1 - l1);
                      if (s.l1 - s.primal_l1).abs() > 1e-9 || s.l1 > l1 + 1e-10 { println!("   {dir} {l2} chain {l1:.12} link {:.12} primal {:.12} it {}", s.l1, s.primal_l1, s.iterations); } }
                }
                Bound::L2Unreachable { .. } => { bc += 1; if !s.l2_unreachable() { println!("   chain says unreachable {dir} {l2} link {} {}", s.l1, s.iterations); } }
                Bound::Unbounded => println!("unbounded"),
            }
        }}
        println!("{name}: chains {} new {t_chain:?} query {:?} link {:?} better {better}/{n} by {gain:.5} chain-unreach {bc} link-unreach {unr} gap {worst_gap:.1e} above {above:.1e} same {same:.1e} it {:.1} max {itmax}", chain.chains().count(), tq/n, tl/n, it as f64/n as f64);
    }
}
#[test]
fn one() {
    let m = model("4.3", 0.1, "1x1");
    let chain = ChainBound::new(&m);
    let link = LinkBound::new(&m, &chain);
    println!("{:?}", link.limit(30.0, -0.25));
    let m = model("1.2", 0.1, "1x1");
    let chain = ChainBound::new(&m);
    let link = LinkBound::new(&m, &chain);
    println!("{:?}", link.limit(15.0, 0.125));
}
