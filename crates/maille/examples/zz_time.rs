//! scratch
use maille::{
    lattice::Cell,
    limit::exact::{ExactMethod, ExactOptions},
    model::Model,
};
use maille_io::{builtin, read_design};
use std::io::Write as _;
use std::sync::atomic::AtomicBool;

fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-6
}
fn model(name: &str, cell: &str, r: Option<f64>) -> Model {
    let mut design = read_design(name, builtin(name).expect("built in")).expect("valid");
    if let Some(r) = r {
        design = design.with_minor_radius(r);
    }
    Model::compile(&design, cell.parse::<Cell>().expect("a cell")).expect("compiles")
}
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let f = AtomicBool::new(false);
    match args[0].as_str() {
        "map" => {
            // map DESIGNS every out
            let mut all = Vec::new();
            let every: f64 = args[2].parse().unwrap();
            let l2: Vec<f64> = args[3].split(',').map(|x| x.parse().unwrap()).collect();
            let radii: Vec<Option<f64>> = if args.len() > 5 {
                args[5].split(',').map(|x| Some(x.parse().unwrap())).collect()
            } else {
                vec![None]
            };
            let mut out = std::fs::File::create(&args[4]).unwrap();
            for name in args[1].split(',') {
                for &r in &radii {
                    let models = [model(name, "1x1", r)];
                    let method = ExactMethod::new(&models, ExactOptions::default());
                    let mut times = Vec::new();
                    let (mut programs, mut runs) = (0, 0);
                    let n = (180.0 / every) as usize;
                    for k in 0..n {
                        let direction = every * k as f64;
                        let mut t = cpu();
                        method.limits(direction, &l2, &f, &mut |i, limit| {
                            let now = cpu();
                            times.push(now - t);
                            programs += limit.iterations;
                            runs += limit.runs;
                            let e = limit.exact.unwrap();
                            let c = e.certificate;
                            writeln!(
                                out,
                                "{name},{},{direction},{},{},{:.15},{},{},{:.4},{:?},{:?},{:?},{:?},{:?}",
                                r.unwrap_or(0.1),
                                l2[i],
                                limit.status.name(),
                                c.as_ref().map_or(0.0, |_| limit.gradient.trace()),
                                limit.iterations,
                                limit.runs,
                                now - t,
                                c.as_ref().map(|c| c.smallest_gap),
                                c.as_ref().map(|c| c.dual_residual),
                                c.as_ref().map(|c| c.min_curvature),
                                c.as_ref().map(|c| c.zero_modes),
                                e.l1_uncertified
                            )
                            .unwrap();
                            t = cpu();
                        });
                    }
                    all.extend(times.iter().copied());
                    times.sort_by(f64::total_cmp);
                    println!(
                        "{name:>4} median {:.3} mean {:.3} ms  programs {programs} runs {runs} n {}",
                        times[times.len() / 2],
                        times.iter().sum::<f64>() / times.len() as f64,
                        times.len()
                    );
                }
            }
            all.sort_by(f64::total_cmp);
            println!(
                "joint median {:.3} ms mean {:.3}",
                all[all.len() / 2],
                all.iter().sum::<f64>() / all.len() as f64
            );
        }
        "cell" => {
            // cell NAME CELL direction reps
            let models = [model(&args[1], &args[2], None)];
            let method = ExactMethod::new(&models, ExactOptions { starts: 1, ..ExactOptions::default() });
            let reps: usize = args[4].parse().unwrap();
            let l2: Vec<f64> = args[5].split(',').map(|x| x.parse().unwrap()).collect();
            for d in args[3].split(',') {
                let mut best = vec![f64::INFINITY; l2.len()];
                let mut what = vec![String::new(); l2.len()];
                for _ in 0..reps {
                    let mut t = cpu();
                    method.limits(d.parse().unwrap(), &l2, &f, &mut |i, limit| {
                        let now = cpu();
                        best[i] = best[i].min(now - t);
                        let e = limit.exact.unwrap();
                        let c = e.certificate;
                        what[i] = format!("{} {:.12} programs {} runs {} gap {:.1e} dual {:.1e} comp {:.1e} mult {:.1e} curv {:?} zero {:?}", limit.status.name(), limit.gradient.trace(), limit.iterations, limit.runs,
                            c.as_ref().map_or(9., |c| c.smallest_gap), c.as_ref().map_or(9., |c| c.dual_residual), c.as_ref().map_or(9., |c| c.complementarity), c.as_ref().map_or(9., |c| c.min_multiplier), c.as_ref().map(|c| c.min_curvature), c.as_ref().map(|c| c.zero_modes));
                        t = cpu();
                    });
                }
                for i in 0..l2.len() {
                    println!("{} {} {d} l2 {} {:.2} ms {}", args[1], args[2], l2[i], best[i], what[i]);
                }
            }
        }
        _ => {}
    }
}
