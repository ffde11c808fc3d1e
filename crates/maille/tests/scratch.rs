//! scratch
mod common;
use maille::{constraint::*, energy::target::direction, solve::{sqp::*, kkt::*}};
use maille_geometry::Vec3;
use std::sync::atomic::AtomicBool;
#[test]
fn scratch() {
    let names: Vec<String> = std::env::var("D").unwrap_or("1.1".into()).split(',').map(|s|s.to_string()).collect();
    let r: f64 = std::env::var("R").unwrap_or("0.1".into()).parse().unwrap();
    let verbose = std::env::var("V").is_ok();
    let step: f64 = std::env::var("S").unwrap_or("7.5".into()).parse().unwrap();
    for name in names {
    let m = common::model(&name, r);
    let (mut ok, mut tot, mut its, mut pol)=(0,0,0,0); let t0=std::time::Instant::now();
    for k in 0..((180.0/step) as i32) { let dir=k as f64*step; let l2=0.0f64;
      let d=direction(dir); let d3=Vec3::new(d.x,d.y,0.0); let e3=Vec3::new(-d.y,d.x,0.0);
      let f=|v:&Vec3, l1:f64,l2:f64| d3*(1.0+l1)*d3.dot(v)+e3*(1.0+l2)*e3.dot(v);
      let pull=Pull{ base:[f(&m.start.a1,0.0,l2),f(&m.start.a2,0.0,l2)], parameters: vec![Parameter{rate:[d3*d3.dot(&m.start.a1),d3*d3.dot(&m.start.a2)],weight:1.0,most:None}]};
      let prog=SheetProgram::new(&m,&pull);
      let s=common::shaken(&m,0.03,5);
      let mut x=prog.posed(s,vec![0.0]); let mut mu=vec![]; let mut it=0; let mut done=None; let mut pause=1e-2; let mut radius=0.1; let mut hist=vec![];
      for _ in 0..8 {
        let end=maximize(&prog, x.clone(), mu.clone(), &SqpOptions{pause_at:pause,first_radius:radius,..Default::default()}, &AtomicBool::new(false));
        it+=end.iterations; pol+=1;
        let (y,c)=polish(&prog,&end);
        hist.push((end.iterations,end.point.p[0],y.p[0],c.smallest_gap,c.dual_residual,c.min_multiplier,c.min_curvature,end.settled));
        if std::env::var("W").is_ok() { for m in &end.multipliers { println!("    mu {:x} {:.4} {} {:.3e}", m.key, m.angle, m.minimum, m.value);} let rows=prog.rows(&end.point,0.02,true); for r in rows { let hn=r.hessian.iter().fold(0.0f64,|a,b|a.max(b.abs())); println!("    row {:x} {:.4} {} gap {:.2e} hess {:.2}", r.key,r.angle,r.minimum,r.gap,hn);} }
        if c.holds() { done=Some((y.p[0],c)); break; }
        if end.settled {break;}
        x=end.point; mu=end.multipliers; pause*=0.03; radius=radius.min(30.0*pause).max(1e-3);
      }
      tot+=1; its+=it; if done.is_some(){ok+=1}
      if done.is_none()||verbose||it>60 { println!("  {name} {dir} it={it} {:?} {:?}",done.map(|d|d.0),hist); }
    }
    println!("{name} r={r}: {ok}/{tot} qps/limit {:.1} polishes {:.1} ms/limit {:.2}", its as f64/tot as f64, pol as f64/tot as f64, t0.elapsed().as_secs_f64()*1e3/tot as f64);
    }
}
