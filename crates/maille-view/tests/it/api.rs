//! The server as its page meets it, and as nobody should: other origins, wrong requests, closed sockets.

use crate::common::opened;
use axum::{
    Router,
    body::{Body, Bytes},
    http::{Method, Request, StatusCode},
};
use maille::record::Status;
use maille_io::builtin;
use maille_view::{App, api::*, router};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    io::{Read, Write},
    net::TcpStream,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};
use tower::ServiceExt;

const PORT: u16 = 4711;

fn app(folder: PathBuf) -> Arc<App> {
    Arc::new(App::new(&opened(), Some(2), folder, None).unwrap())
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap()
}

fn subject(text: &str) -> Subject {
    Subject {
        name: "mine.toml".into(),
        text: text.into(),
        minor_radius: None,
        spacing: None,
        parameters: BTreeMap::new(),
    }
}

fn solve(slot: &str, directions_deg: Vec<f64>) -> Solve {
    let subject = subject(builtin("1.1").unwrap());
    Solve { slot: slot.into(), subject, directions_deg, l2: vec![0.0], lateral_free: false }
}

async fn send(router: &Router, request: Request<Body>) -> (StatusCode, Bytes) {
    let answer = router.clone().oneshot(request).await.unwrap();
    let status = answer.status();
    (status, axum::body::to_bytes(answer.into_body(), 1 << 28).await.unwrap())
}

fn request(method: Method, path: &str, body: impl Into<Body>) -> Request<Body> {
    let host = format!("127.0.0.1:{PORT}");
    Request::builder().method(method).uri(path).header("host", host).body(body.into()).unwrap()
}

async fn post<T: DeserializeOwned>(router: &Router, path: &str, body: &impl Serialize) -> (StatusCode, T) {
    let (status, bytes) = send(router, request(Method::POST, path, serde_json::to_vec(body).unwrap())).await;
    let found = serde_json::from_slice(&bytes);
    (status, found.unwrap_or_else(|e| panic!("{path}: {e}: {}", String::from_utf8_lossy(&bytes))))
}

async fn events(router: &Router, body: &Solve) -> Vec<SolveEvent> {
    let (status, bytes) = send(router, request(Method::POST, "/api/solve", serde_json::to_vec(body).unwrap())).await;
    assert_eq!(status, StatusCode::OK, "{}", String::from_utf8_lossy(&bytes));
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    text.lines()
        .filter_map(|line| line.strip_prefix("data: "))
        .map(|json| serde_json::from_str(json).unwrap())
        .collect()
}

fn settles(app: &App) -> bool {
    let begun = Instant::now();
    while app.live() > 0 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    app.live() == 0
}

#[test]
fn other_hosts_and_origins_are_refused() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let ask = |host: Option<&str>, origin: Option<&str>| {
            let mut request = Request::builder().uri("/api/activity");
            for (name, value) in [("host", host), ("origin", origin)] {
                request = value.into_iter().fold(request, |request, value| request.header(name, value));
            }
            request.body(Body::empty()).unwrap()
        };
        let own = ["127.0.0.1:4711", "localhost:4711", "[::1]:4711"];
        for host in own {
            assert_eq!(send(&router, ask(Some(host), None)).await.0, StatusCode::OK, "{host}");
            let origin = format!("http://{host}");
            assert_eq!(send(&router, ask(Some(host), Some(&origin))).await.0, StatusCode::OK, "{origin}");
        }
        let others = [
            "127.0.0.1",
            "127.0.0.1:80",
            "127.0.0.1:47110",
            "evil.example:4711",
            "localhost.evil.example:4711",
            "0.0.0.0:4711",
            "127.0.0.1:4711.evil.example",
            "192.168.0.1:4711",
            "",
        ];
        for host in others {
            assert_eq!(send(&router, ask(Some(host), None)).await.0, StatusCode::FORBIDDEN, "{host}");
            let origin = format!("http://{host}");
            assert_eq!(send(&router, ask(Some(own[0]), Some(&origin))).await.0, StatusCode::FORBIDDEN, "{origin}");
        }
        for origin in ["null", "https://127.0.0.1:4711", "file://", "127.0.0.1:4711"] {
            assert_eq!(send(&router, ask(Some(own[0]), Some(origin))).await.0, StatusCode::FORBIDDEN, "{origin}");
        }
        assert_eq!(send(&router, ask(None, None)).await.0, StatusCode::FORBIDDEN);
        let two = Request::builder().uri("/api/activity").header("host", own[0]).header("host", own[1]);
        assert_eq!(send(&router, two.body(Body::empty()).unwrap()).await.0, StatusCode::FORBIDDEN);
    });
}

#[test]
fn a_design_is_judged_as_the_program_does() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let text = builtin("1.1").unwrap();
        let (_, judged): (_, Judged) = post(&router, "/api/judge", &subject(text)).await;
        let sheet = judged.sheet.unwrap();
        assert!(judged.problems.is_empty());
        assert_eq!((sheet.rings.len(), sheet.pairs.iter().filter(|p| p.number != 0).count()), (3, 4));

        let (_, judged): (_, Judged) = post(&router, "/api/judge", &subject(&text.replace("0.1", "-0.1"))).await;
        assert_eq!((judged.problems[0].field.as_deref(), judged.problems[0].line), (Some("minor_radius"), Some(9)));
        assert!(judged.sheet.is_none());

        // A curve with two ends is drawn from one to the other, and not back.
        let hooks = include_str!("../../../../examples/curves/hooks.toml");
        let (_, judged): (_, Judged) = post(&router, "/api/judge", &subject(hooks)).await;
        let ring = &judged.sheet.unwrap().rings[0];
        let points = ring.curve.as_ref().unwrap();
        assert!(ring.open && points[0] == [-1.0, -1.0, 0.0] && points.last() == Some(&[1.0, 1.0, 0.0]), "{points:?}");

        // Overlaps are wrong, and shown.
        let thick = Subject { minor_radius: Some(0.3), ..subject(text) };
        let (_, judged): (_, Judged) = post(&router, "/api/judge", &thick).await;
        assert!(judged.problems[0].problem.contains("overlap"), "{:?}", judged.problems);
        assert!(judged.sheet.unwrap().pairs.iter().any(|pair| pair.gap < 0.0));

        let edit = |field: &str| Edit {
            text: text.into(),
            changes: vec![Change { field: field.into(), value: "0.2".into() }],
        };
        let (_, changed): (_, Text) = post(&router, "/api/edit", &edit("elements[1].center[2]")).await;
        assert!(changed.text.contains("[1.25, 0.0, 0.2]") && changed.text.starts_with("# Flat rings"));
        let (status, _): (_, Refused) = post(&router, "/api/edit", &edit("elements[9].center")).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
    });
}

/// Values of parameters change the sheet and not the design of the file; wrong ones are named at their place in it. A changed value in
/// the text keeps the bounds beside it.
#[test]
fn parameters_are_set_for_the_sheet_or_in_the_text() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let text = include_str!("../../../../examples/parameters/square.toml");
        let with =
            |name: &str, value: f64| Subject { parameters: BTreeMap::from([(name.into(), value)]), ..subject(text) };
        let (_, judged): (_, Judged) = post(&router, "/api/judge", &with("wire", 1.6)).await;
        let (sheet, design) = (judged.sheet.unwrap(), judged.design.unwrap());
        assert!(judged.problems.is_empty() && sheet.rings.iter().all(|ring| ring.minor_radius == 0.8));
        assert_eq!(design.minor_radius, Some(0.6));
        for (name, value, problem) in
            [("wire", 3.0, "above max = 2"), ("wier", 1.0, "is no parameter"), ("pitch", 1.0, "")]
        {
            let (_, judged): (_, Judged) = post(&router, "/api/judge", &with(name, value)).await;
            assert!(judged.sheet.is_none() && judged.problems[0].problem.contains(problem), "{:?}", judged.problems);
        }
        let change = |field: &str| Change { field: field.into(), value: "1.5".into() };
        let changes = vec![change("parameters.wire"), change("parameters.tilt")];
        let (_, changed): (_, Text) = post(&router, "/api/edit", &Edit { text: text.into(), changes }).await;
        assert!(changed.text.contains("wire = { value = 1.5, min = 0.4, max = 2.0 } # its diameter"));
        assert!(changed.text.contains("tilt = 1.5 # of the upright rings"), "{}", changed.text);
    });
}

/// A ring that gives no offset and no minor radius gets them, inline or in a table of its own; comments stay.
#[test]
fn absent_values_of_a_ring_are_added() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let inline = builtin("1.1").unwrap().to_owned();
        let block = inline.replace(
            "rings = [{ major_radius = 1.0, normal = [0.0, 0.0, 1.0] }]",
            "[[elements.rings]]\nmajor_radius = 1.0\nnormal = [0.0, 0.0, 1.0] # up\n",
        );
        for text in [inline, block] {
            let change = |field: &str, value: &str| Change { field: field.into(), value: value.into() };
            let ring = "elements[0].rings[0]";
            let changes = vec![
                change(&format!("{ring}.offset"), "[0.0, 0.0, 0.5]"),
                change(&format!("{ring}.minor_radius"), "0.08"),
                change(&format!("{ring}.offset"), "[0.0, 0.0, 0.25]"),
            ];
            let edit = Edit { text: text.clone(), changes };
            let (status, changed): (_, Text) = post(&router, "/api/edit", &edit).await;
            assert_eq!(status, StatusCode::OK);
            let (_, judged): (_, Judged) = post(&router, "/api/judge", &subject(&changed.text)).await;
            let design = judged.design.unwrap_or_else(|| panic!("{:?}\n{}", judged.problems, changed.text));
            let ring = &design.elements[0].rings[0];
            assert_eq!((ring.offset, ring.minor_radius), ([0.0, 0.0, 0.25], Some(0.08)));
            assert!(changed.text.starts_with("# Flat rings") && changed.text.contains("# up") == text.contains("# up"));
        }
    });
}

#[test]
fn a_new_design_is_a_weave_or_one_ring() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let new = |weave: Option<&str>, minor| New {
            name: "mine".into(),
            weave: weave.map(str::to_owned),
            major: 5.0,
            minor,
            unit: "mm".into(),
        };
        for (weave, rings, links) in [(None, 1, 0), (Some("kings-mail"), 4, 16)] {
            let (_, made): (_, Text) = post(&router, "/api/new", &new(weave, 0.8)).await;
            let (_, judged): (_, Judged) = post(&router, "/api/judge", &subject(&made.text)).await;
            let sheet = judged.sheet.unwrap();
            assert!(judged.problems.is_empty() && sheet.unit.as_deref() == Some("mm"), "{:?}", judged.problems);
            assert_eq!((sheet.rings.len(), sheet.pairs.iter().filter(|p| p.number != 0).count()), (rings, links));
        }
        for wrong in [new(None, -1.0), new(Some("lace"), 0.8)] {
            let (status, _): (_, Refused) = post(&router, "/api/new", &wrong).await;
            assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
        }
    });
}

#[test]
fn limits_stream_in_with_their_states() {
    let app = app(PathBuf::from("."));
    runtime().block_on(async {
        let found = events(&router(Arc::clone(&app), PORT), &solve("a", vec![0.0, 45.0])).await;
        assert!(matches!(found[0], SolveEvent::Begun(2)), "{:?}", found[0]);
        assert!(matches!(found[1], SolveEvent::Sheet(_)));
        assert!(matches!(found.last(), Some(SolveEvent::Ended { cancelled: false })));
        let limits: Vec<&Limit> = found
            .iter()
            .filter_map(|e| match e {
                SolveEvent::Limit(l) => Some(&**l),
                _ => None,
            })
            .collect();
        assert_eq!(limits.len(), 2);
        let straight = limits.iter().find(|l| l.row.direction_deg == 0.0).unwrap();
        // The chain along 0 degrees is straight: 2 (2 R - 2 r) on a period of 2.5.
        assert!((straight.row.l1.unwrap() - 0.44).abs() < 1e-9 && straight.row.status == Status::Global);
        assert!(
            !straight.state.contacts.is_empty()
                && straight.state.chain.is_some()
                && straight.pairs.iter().any(|p| p.gap.abs() < 1e-6)
        );
    });
    assert!(settles(&app));
}

#[test]
fn a_newer_request_ends_the_older_one() {
    let app = app(PathBuf::from("."));
    runtime().block_on(async {
        let router = router(Arc::clone(&app), PORT);
        // Long enough that none ends by itself before the next one comes.
        let many = solve("a", (0..1800).map(|k| 0.1 * f64::from(k)).collect());
        let mut tasks = Vec::new();
        for _ in 0..8 {
            let (router, many) = (router.clone(), many.clone());
            tasks.push(tokio::spawn(async move { events(&router, &many).await }));
            tokio::time::sleep(Duration::from_millis(30)).await;
        }
        let last = events(&router, &solve("a", vec![30.0])).await;
        assert!(matches!(last.last(), Some(SolveEvent::Ended { cancelled: false })));
        let mut cut = 0;
        for task in tasks {
            cut += usize::from(matches!(task.await.unwrap().last(), Some(SolveEvent::Ended { cancelled: true })));
        }
        assert!(cut >= 6, "{cut} of 8 were cancelled");
    });
    assert!(settles(&app));
}

#[test]
fn files_are_those_of_the_writers() {
    runtime().block_on(async {
        let router = router(app(PathBuf::from(".")), PORT);
        let text = builtin("1.1").unwrap();
        let wanted = |format: &str, tile| Export {
            format: format.into(),
            subject: subject(text),
            tile,
            state: None,
            cell: None,
            finite: false,
            rows: Vec::new(),
        };
        for (format, head) in
            [("3mf", &b"PK"[..]), ("glb", b"glTF"), ("ply", b"ply"), ("png", b"\x89PNG"), ("obj", b"#")]
        {
            let body = serde_json::to_vec(&wanted(format, [2, 2])).unwrap();
            let (status, bytes) = send(&router, request(Method::POST, "/api/export", body)).await;
            assert!(status == StatusCode::OK && bytes.starts_with(head), "{format} {status}");
        }
        for (format, tile) in [
            ("stl", [4_000_000_000, 4_000_000_000]),
            ("stl", [0, 1]),
            ("doc", [1, 1]),
            ("stl", [200, 80]),
            ("svg", [1, 1]),
        ] {
            let (status, _): (_, Refused) = post(&router, "/api/export", &wanted(format, tile)).await;
            assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY, "{format} {tile:?}");
        }
        // A state that does not belong to the design, and contacts of rings that are not there.
        let found = events(&router, &solve("a", vec![0.0])).await;
        let limit = found
            .iter()
            .find_map(|e| match e {
                SolveEvent::Limit(l) => Some((**l).clone()),
                _ => None,
            })
            .unwrap();
        let mut export = wanted("stl", [2, 2]);
        (export.state, export.cell) = (Some(limit.state.clone()), Some("2x1".into()));
        let (status, _): (_, Refused) = post(&router, "/api/export", &export).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
        export.cell = Some("1x1".into());
        export.state.as_mut().unwrap().contacts[0].ring_b = 9999;
        let (status, _): (_, Refused) = post(&router, "/api/export", &export).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
    });
}

#[test]
fn only_plain_names_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    runtime().block_on(async {
        let router = router(app(folder.path().join("in")), PORT);
        std::fs::create_dir(folder.path().join("in")).unwrap();
        let save = |file: &str, overwrite| Save { file: file.into(), text: "name = \"a\"".into(), overwrite };
        for file in
            ["../a.toml", "/tmp/a.toml", "a/b.toml", "a", ".toml", "..", "a\\b.toml", "", "a\0.toml", "C:a.toml"]
        {
            let (status, _): (_, Refused) = post(&router, "/api/save", &save(file, true)).await;
            assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY, "{file}");
        }
        let (status, _): (_, Text) = post(&router, "/api/save", &save("a.toml", false)).await;
        assert_eq!(status, StatusCode::OK);
        let (status, _): (_, Refused) = post(&router, "/api/save", &save("a.toml", false)).await;
        assert_eq!(status, StatusCode::CONFLICT);
        let (status, _): (_, Text) = post(&router, "/api/save", &save("a.toml", true)).await;
        assert_eq!(status, StatusCode::OK);
    });
    assert_eq!(std::fs::read_to_string(folder.path().join("in/a.toml")).unwrap(), "name = \"a\"");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// A JSON value like one that is right, with something in it that is not.
fn spoilt(value: &Value, random: &mut ChaCha8Rng) -> Value {
    let odd = [
        json!(null),
        json!(1e308),
        json!(-1e308),
        json!(1e-308),
        json!(0),
        json!(-1),
        json!(9e15),
        json!(u64::MAX),
        json!("x"),
        json!(""),
        json!([]),
        json!({}),
        json!([[[[]]]]),
        json!(true),
        json!("minor_radius = 1e999"),
        json!("\u{0}\u{ffff}"),
        json!([1e300, -1e300]),
        json!("[[elements]]\n".repeat(300)),
    ];
    if random.random_range(0..4) == 0 {
        return odd[random.random_range(0..odd.len())].clone();
    }
    match value {
        Value::Array(list) if !list.is_empty() => {
            let mut list = list.clone();
            let k = random.random_range(0..list.len());
            list[k] = spoilt(&list[k], random);
            Value::Array(list)
        }
        Value::Object(map) if !map.is_empty() => {
            let mut map = map.clone();
            let key = map.keys().nth(random.random_range(0..map.len())).unwrap().clone();
            let new = spoilt(&map[&key], random);
            map.insert(key, new);
            Value::Object(map)
        }
        // A design whose numbers are changed.
        Value::String(text) if text.contains("lattice") => {
            let numbers = ["1e300", "-1e300", "1e-300", "nan", "inf", "0.0", "1e6", "1e-6", "\"x\"", "[[]]"];
            let places: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit()).map(|(at, _)| at).collect();
            let at = places[random.random_range(0..places.len())];
            json!(format!("{}{}{}", &text[..at], numbers[random.random_range(0..numbers.len())], &text[at + 1..]))
        }
        _ => odd[random.random_range(0..odd.len())].clone(),
    }
}

#[test]
fn wrong_requests_are_refused_and_nothing_is_left_running() {
    let folder = tempfile::tempdir().unwrap();
    let app = app(folder.path().to_owned());
    runtime().block_on(async {
        let router = router(Arc::clone(&app), PORT);
        let text = builtin("1.1").unwrap();
        let right = [
            ("/api/judge", json!(subject(text))),
            ("/api/solve", json!(solve("a", vec![0.0]))),
            ("/api/edit", json!({ "text": text, "field": "minor_radius", "value": "0.2" })),
            ("/api/new", json!({ "name": "a", "weave": "kings-mail", "major": 5.0, "minor": 0.5, "unit": "mm" })),
            ("/api/save", json!({ "file": "a.toml", "text": text, "overwrite": true })),
            ("/api/export", json!({ "format": "stl", "subject": subject(text), "tile": [2, 2], "state": null, "cell": "1x1", "rows": [] })),
        ];
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let mut refused = 0;
        for k in 0..400 {
            let (path, value) = &right[k % right.len()];
            let mut bytes = serde_json::to_vec(&spoilt(value, &mut random)).unwrap();
            if k % 7 == 0 {
                bytes.truncate(random.random_range(0..bytes.len())); // no JSON
            }
            if k % 11 == 0 && !bytes.is_empty() {
                let at = random.random_range(0..bytes.len());
                bytes[at] = random.random();
            }
            let shown = String::from_utf8_lossy(&bytes).into_owned();
            let answer = tokio::time::timeout(Duration::from_secs(60), send(&router, request(Method::POST, path, bytes)));
            let (status, body) = answer.await.unwrap_or_else(|_| panic!("{path} hangs at {shown}"));
            assert!(status.is_success() || status.is_client_error(), "{path} {status}: {shown}");
            assert!(!String::from_utf8_lossy(&body).contains("panicked"), "{path}: {shown}");
            refused += usize::from(status.is_client_error());
        }
        assert!(refused > 150, "{refused}");
        for (method, path) in [(Method::GET, "/api/solve"), (Method::DELETE, "/"), (Method::GET, "/../Cargo.toml"), (Method::GET, "/api/builtin/..%2f..")] {
            assert!(send(&router, request(method, path, Body::empty())).await.0.is_client_error(), "{path}");
        }
        let large = vec![b' '; 17 << 20];
        assert_eq!(send(&router, request(Method::POST, "/api/judge", large)).await.0, StatusCode::PAYLOAD_TOO_LARGE);
        let long = subject(&" ".repeat(2 << 20));
        assert_eq!(post::<Refused>(&router, "/api/judge", &long).await.0, StatusCode::PAYLOAD_TOO_LARGE);
    });
    assert!(settles(&app));
}

#[test]
fn sockets_that_close_end_their_solves() {
    let app = app(PathBuf::from("."));
    let runtime = runtime();
    let listener = runtime.block_on(tokio::net::TcpListener::bind("127.0.0.1:0")).unwrap();
    let address = listener.local_addr().unwrap();
    let server = runtime.spawn(axum::serve(listener, router(Arc::clone(&app), address.port())).into_future());
    let mut random = ChaCha8Rng::seed_from_u64(10);
    let request = |slot: usize, directions: usize| {
        // 180 directions of a map that takes long.
        let mut solve = solve(&format!("slot {slot}"), (0..directions).map(|k| k as f64).collect());
        solve.subject = subject(builtin("5.1").unwrap());
        let body = serde_json::to_vec(&solve).unwrap();
        let head = format!("POST /api/solve HTTP/1.1\r\nhost: {address}\r\ncontent-length: {}\r\n\r\n", body.len());
        [head.into_bytes(), body].concat()
    };
    for k in 0..24 {
        let mut socket = TcpStream::connect(address).unwrap();
        let bytes = request(k % 5, 180);
        let sent = if k % 3 == 0 { random.random_range(1..bytes.len()) } else { bytes.len() };
        socket.write_all(&bytes[..sent]).unwrap();
        if k % 3 == 1 {
            let mut some = vec![0; random.random_range(1..4000)];
            let _ = socket.read(&mut some);
        }
        drop(socket);
    }
    assert!(settles(&app), "{} solves are left", app.live());
    // And it still answers.
    let mut socket = TcpStream::connect(address).unwrap();
    write!(socket, "GET /api/activity HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200") && answer.ends_with("{\"solves\":0}"), "{answer}");
    server.abort();
}
