mod common;
use maille::{constraint::*, energy::target::direction, solve::{sqp::*, kkt::*}};
use maille_geometry::Vec3;
use std::sync::atomic::AtomicBool;
#[test]
fn scratch() {
    let names: Vec<String> = std::env::var("D").unwrap_or("1.1".into()).split(',').map(|s|s.to_string()).collect();
    let r: f64 = std::env::var("R").unwrap_or("0.1".into()).parse().unwrap();
    for name in names {
    let m = common::model(&name, r);
    for dir in [0.0,15.0,30.0,45.0,90.0f64] { for l2 in [0.0f64,-0.125] {
      let t=std::time::Instant::now();
      let d=direction(dir); let d3=Vec3::new(d.x,d.y,0.0); let e3=Vec3::new(-d.y,d.x,0.0);
      let f=|v:&Vec3, l1:f64,l2:f64| d3*(1.0+l1)*d3.dot(v)+e3*(1.0+l2)*e3.dot(v);
      let pull=Pull{ base:[f(&m.start.a1,0.0,l2),f(&m.start.a2,0.0,l2)], parameters: vec![Parameter{rate:[d3*d3.dot(&m.start.a1),d3*d3.dot(&m.start.a2)],weight:1.0,most:None}]};
      let prog=SheetProgram::new(&m,&pull);
      let s=common::shaken(&m,0.03,5);
      let end=maximize(&prog, prog.posed(s,vec![0.0]), &SqpOptions::default(), &AtomicBool::new(false));
      let t1=t.elapsed();
      let (x,c)=polish(&prog,&end);
      println!("{name} dir={dir} l2={l2} l1={:.12} sqp={:.12} it={} settled={} viol={:.1e} gap={:.1e} dual={:.1e} comp={:.1e} mu={:.1e} curv={:?} zero={} na={} ok={} links={} {:?} {:?}", x.p[0], end.point.p[0], end.iterations,end.settled,end.violation,c.smallest_gap,c.dual_residual,c.complementarity,c.min_multiplier,c.min_curvature,c.zero_modes,c.multipliers.len(),c.holds(),maille::topology::links_kept(&m,&x.state),t1,t.elapsed());
    }}}
}
