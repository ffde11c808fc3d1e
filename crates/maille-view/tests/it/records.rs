//! Records, simulations and sweeps: what is listed can be opened, and nothing else.

use crate::common::opened;
use axum::{
    Router,
    body::Body,
    http::{Method, Request, StatusCode},
};
use maille::{
    lattice::Cell,
    model::Model,
    record::{FrameRecord, pose_records},
    relaxation::simulate::End,
};
use maille_io::{
    builtin, read_design,
    record::{SheetPlan, SimulationFolder, SimulationOutcome, SimulationRecord},
    run::Map,
};
use maille_view::{App, api::*, router, solve_map};
use serde::{Serialize, de::DeserializeOwned};
use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};
use tower::ServiceExt;

const PORT: u16 = 4712;

async fn ask<T: DeserializeOwned>(router: &Router, path: &str, body: Option<&impl Serialize>) -> (StatusCode, T) {
    let method = if body.is_some() { Method::POST } else { Method::GET };
    let bytes = body.map_or(Vec::new(), |body| serde_json::to_vec(body).unwrap());
    let request = Request::builder().method(method).uri(path).header("host", format!("127.0.0.1:{PORT}"));
    let answer = router.clone().oneshot(request.body(Body::from(bytes)).unwrap()).await.unwrap();
    let status = answer.status();
    let bytes = axum::body::to_bytes(answer.into_body(), 1 << 28).await.unwrap();
    (status, serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&bytes))))
}

/// A record of one limit in `folder`.
fn limits(folder: &Path) {
    let map = maille_view::map_of_bundle(vec![0.0], vec![0.0]).unwrap();
    let map = Map { out: Some(folder.into()), ..map };
    solve_map(&opened(), &map, &AtomicBool::new(false), &|_| ()).unwrap();
}

/// Three states of 2 x 2 cells; in the second the sheet has risen by 1.
fn simulation(folder: &Path) {
    let design = read_design("1.1", builtin("1.1").unwrap()).unwrap();
    let model = Model::compile_sheet(&design, "2x2".parse::<Cell>().unwrap()).unwrap();
    let frame = |k: u32| {
        let mut poses = pose_records(&model, &model.start);
        poses.iter_mut().for_each(|pose| pose.position[2] += f64::from(k));
        FrameRecord { run: k, share: f64::from(k) / 2.0, energy: f64::from(k), poses }
    };
    let outcome = SimulationOutcome {
        end: End::Locked,
        share: 1.0,
        smallest_gap: None,
        links_ok: true,
        iterations: 1,
        kicks: 0,
        unbalanced: 0,
        note: None,
    };
    let setup: SheetPlan = serde_json::from_value(serde_json::json!({
        "fix": ["left"], "pull": [], "gravity": null, "force": [], "floor": null, "steps": 2, "max_iterations": 1, "seed": 1,
    })).unwrap();
    let record = SimulationRecord {
        schema: 1,
        version: "0".into(),
        design,
        tile: "2x2".into(),
        setup,
        outcome,
        forces_sha256: None,
        sha256: None,
    };
    SimulationFolder::open(folder).unwrap().save(record, &[frame(0), frame(1), frame(2)], None).unwrap();
}

#[test]
fn records_are_listed_and_opened() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    limits(&at("maille-out/1.1"));
    limits(&at("maille-out/study/records/1.1-r0.1"));
    simulation(&at("maille-out/pulled"));
    limits(&at("elsewhere/a"));
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    runtime.block_on(async {
        let app = |named| Arc::new(App::new(&opened(), Some(1), folder.path().into(), named).unwrap());
        let router = router(app(None), PORT);
        let (_, start): (_, Start) = ask(&router, "/api/start", None::<&()>).await;
        let names: Vec<_> = start.records.iter().map(|r| (r.name.as_str(), r.title.as_str())).collect();
        let expected = [
            ("maille-out/1.1", "limits"),
            ("maille-out/pulled", "simulation"),
            ("maille-out/study/records/1.1-r0.1", "limits"),
        ];
        assert_eq!(names, expected);
        let open = |name: &str| OpenRecord { name: name.into() };
        let (_, shown): (_, Shown) = ask(&router, "/api/open", Some(&open(expected[2].0))).await;
        let map = shown.map.unwrap();
        assert!(map.limits.len() == 1 && map.source == expected[2].0 && shown.simulation.is_none());

        // Only what is listed: no way out of the folder, and no folder that was not named.
        for name in ["elsewhere/a", "maille-out", "maille-out/../elsewhere/a", "/etc", ""] {
            let (status, refused): (_, Refused) = ask(&router, "/api/open", Some(&open(name))).await;
            assert!(status == StatusCode::UNPROCESSABLE_ENTITY && refused.problem.contains("no record"), "{name}");
        }
        let named = maille_view::router(app(Some("elsewhere")), PORT);
        let (status, _): (_, Shown) = ask(&named, "/api/open", Some(&open("elsewhere/a"))).await;
        assert_eq!(status, StatusCode::OK);

        // A damaged record says so.
        std::fs::write(at("maille-out/1.1/limits.csv"), "design\n").unwrap();
        let (status, refused): (_, Refused) = ask(&router, "/api/open", Some(&open("maille-out/1.1"))).await;
        assert!(status == StatusCode::UNPROCESSABLE_ENTITY && refused.problem.contains("limits.csv:1"), "{refused:?}");
    });
}

#[test]
fn a_simulation_has_its_states_and_their_gaps() {
    let folder = tempfile::tempdir().unwrap();
    simulation(&folder.path().join("maille-out/pulled"));
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap();
    runtime.block_on(async {
        let router = router(Arc::new(App::new(&opened(), Some(1), folder.path().into(), None).unwrap()), PORT);
        let open = OpenRecord { name: "maille-out/pulled".into() };
        let (_, shown): (_, Shown) = ask(&router, "/api/open", Some(&open)).await;
        let text = shown.text;
        let ShownSimulation { sheet, frames, total, end, .. } = shown.simulation.unwrap();
        assert_eq!((sheet.rings.len(), &*sheet.cell, frames.len(), total, end), (12, "2x2", 3, 3, End::Locked));
        assert_eq!((frames[1].share, frames[1].poses[0].position[2], frames[1].mean_force), (0.5, 1.0, None));

        // The sheet as a whole has risen: the gaps are those of the start, and a free edge has no images.
        let measure = Measure {
            subject: Subject {
                name: "pulled".into(),
                text: text.clone(),
                minor_radius: None,
                spacing: None,
                parameters: BTreeMap::new(),
            },
            cell: sheet.cell.clone(),
            finite: true,
            a1: sheet.a1,
            a2: sheet.a2,
            poses: frames[1].poses.clone(),
        };
        let (_, pairs): (_, Vec<Pair>) = ask(&router, "/api/measure", Some(&measure)).await;
        assert!(pairs.len() == sheet.pairs.len() && pairs.iter().all(|pair| pair.shift == [0, 0]));
        assert!(pairs.iter().zip(&sheet.pairs).all(|(a, b)| (a.gap - b.gap).abs() < 1e-12 && a.number == b.number));
        // 2 x 2 cells: 8 standing rings with two links each, less those that reach over an edge.
        assert_eq!(pairs.iter().filter(|pair| pair.number != 0).count(), 12);
        let few = Measure { poses: Vec::new(), ..measure.clone() };
        let (status, _): (_, Refused) = ask(&router, "/api/measure", Some(&few)).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
        let large = Measure { cell: "4000x4000".into(), ..measure };
        let (status, _): (_, Refused) = ask(&router, "/api/measure", Some(&large)).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
    });
}
