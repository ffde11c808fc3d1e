//! What the server answers.

use crate::{
    api::{Activity, Change, Edit, Export, Judged, Measure, New, OpenRecord, Refused, Save, Solve, Subject, Text},
    app::App,
    assets::asset,
    export,
    guard::guard,
    new_design,
    refusal::{Refusal, json_response},
    save,
    sheet::{sheet, tolerant},
    simulated, solve,
};
use axum::{
    Router,
    body::Bytes,
    extract::{DefaultBodyLimit, Path, State},
    http::StatusCode,
    middleware::from_fn_with_state,
    response::{IntoResponse, Response},
    routing::{get, post},
};
use maille::{lattice::Cell, model::Model};
use maille_io::{DesignSource, ListedProblem, builtin};
use serde::de::DeserializeOwned;
use std::sync::Arc;

/// Bytes of a request, at most: a map of a few hundred states.
const MOST_BYTES: usize = 16 << 20;
/// Bytes of a design file, at most.
const MOST_TEXT: usize = 1 << 20;

type Answer = Result<Response, Refusal>;
type Shared = State<Arc<App>>;

/// The server's answers, for its own page at `port` alone.
pub fn router(app: Arc<App>, port: u16) -> Router {
    Router::new()
        .route("/", get(|| async { page("index.html") }))
        .route("/{name}", get(|Path(name): Path<String>| async move { page(&name) }))
        .route("/api/start", get(start))
        .route("/api/activity", get(activity))
        .route("/api/builtin/{name}", get(of_builtin))
        .route("/api/open", post(open))
        .route("/api/measure", post(measure))
        .route("/api/judge", post(judge))
        .route("/api/edit", post(edit))
        .route("/api/new", post(new))
        .route("/api/save", post(save))
        .route("/api/solve", post(solve))
        .route("/api/export", post(export))
        .fallback(|| async { Refusal::of(StatusCode::NOT_FOUND, "there is nothing here", "open /") })
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .layer(from_fn_with_state(port, guard))
        .with_state(app)
}

fn page(name: &str) -> Response {
    match asset(name) {
        Some((kind, bytes)) => ([("content-type", kind)], bytes).into_response(),
        None => Refusal::of(StatusCode::NOT_FOUND, format!("there is no {name}"), "open /").into_response(),
    }
}

fn read<T: DeserializeOwned>(body: &Bytes) -> Result<T, Refusal> {
    serde_json::from_slice(body).map_err(|e| {
        Refusal::of(StatusCode::BAD_REQUEST, format!("the request cannot be read: {e}"), "send what api.rs says")
    })
}

fn small(text: &str) -> Result<(), Refusal> {
    match text.len() <= MOST_TEXT {
        true => Ok(()),
        false => Err(Refusal::of(StatusCode::PAYLOAD_TOO_LARGE, "the design file is larger than 1 MiB", "shorten it")),
    }
}

/// Work that takes a moment, aside from the server's threads.
async fn aside<T: Send + 'static>(
    app: &Arc<App>,
    work: impl FnOnce(&App) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let _place = Arc::clone(&app.work.short).acquire_owned().await.map_err(Refusal::fault)?;
    let shared = Arc::clone(app);
    tokio::task::spawn_blocking(move || work(&shared)).await.map_err(|_| Refusal::fault("a check has panicked"))?
}

async fn start(State(app): Shared) -> Answer {
    let start = aside(&app, |app| Ok(app.start())).await?;
    Ok(json_response(StatusCode::OK, &start))
}

async fn activity(State(app): Shared) -> Answer {
    Ok(json_response(StatusCode::OK, &Activity { solves: app.work.live() }))
}

async fn of_builtin(Path(name): Path<String>) -> Answer {
    match builtin(&name) {
        Some(text) => Ok(json_response(StatusCode::OK, &Text { name, text: text.to_owned() })),
        None => {
            Err(Refusal::of(StatusCode::NOT_FOUND, format!("there is no built-in design \"{name}\""), "see the list"))
        }
    }
}

async fn open(State(app): Shared, body: Bytes) -> Answer {
    let OpenRecord { name } = read(&body)?;
    let shown = aside(&app, move |app| app.open(&name)).await?;
    Ok(json_response(StatusCode::OK, &shown))
}

async fn measure(State(app): Shared, body: Bytes) -> Answer {
    let request: Measure = read(&body)?;
    small(&request.subject.text)?;
    let pairs = aside(&app, move |_| simulated::measure(&request)).await?;
    Ok(json_response(StatusCode::OK, &pairs))
}

async fn judge(State(app): Shared, body: Bytes) -> Answer {
    let subject: Subject = read(&body)?;
    small(&subject.text)?;
    let judged = aside(&app, move |_| Ok(judged(&subject))).await?;
    Ok(json_response(StatusCode::OK, &judged))
}

fn judged(subject: &Subject) -> Judged {
    let unread = |refusal: Refusal| {
        let mut problems = refusal.refused.problems;
        if problems.is_empty() {
            let Refused { problem, help, .. } = refusal.refused;
            problems.push(ListedProblem { field: None, problem, help: Some(help), line: None, column: None });
        }
        Judged { problems, design: None, sheet: None }
    };
    let read = match subject.read() {
        Ok(read) => read,
        Err(refusal) => return unread(refusal),
    };
    // What overlaps is shown as it lies.
    match read.compile(&tolerant(&read.design), Cell::PRIMITIVE) {
        Err(refusal) => Judged { design: Some(read.written), ..unread(refusal) },
        Ok(model) => {
            let strict = Model::compile(&read.design, Cell::PRIMITIVE).err().unwrap_or_default();
            Judged {
                problems: if strict.is_empty() { Vec::new() } else { read.source.explain(&strict).list() },
                sheet: Some(sheet(&model, &read.design)),
                design: Some(read.written),
            }
        }
    }
}

async fn edit(body: Bytes) -> Answer {
    let Edit { mut text, changes } = read(&body)?;
    small(&text)?;
    for Change { field, value } in changes {
        let changed = DesignSource::new("design", &*text).with_value(&field, &value);
        let absent = || Refusal::wrong(format!("the file has no {field} to change"), "write it into the text");
        text = changed.ok_or_else(absent)?;
        small(&text)?;
    }
    Ok(json_response(StatusCode::OK, &Text { name: "design".into(), text }))
}

async fn new(State(app): Shared, body: Bytes) -> Answer {
    let request: New = read(&body)?;
    let text = aside(&app, move |_| new_design::design_file(&request)).await?;
    Ok(json_response(StatusCode::OK, &text))
}

async fn save(State(app): Shared, body: Bytes) -> Answer {
    let request: Save = read(&body)?;
    small(&request.text)?;
    let saved = aside(&app, move |app| save::save(app, &request)).await?;
    Ok(json_response(StatusCode::OK, &saved))
}

async fn solve(State(app): Shared, body: Bytes) -> Answer {
    let request: Solve = read(&body)?;
    small(&request.subject.text)?;
    solve::stream(Arc::clone(&app.work), request)
}

async fn export(State(app): Shared, body: Bytes) -> Answer {
    let request: Export = read(&body)?;
    small(&request.subject.text)?;
    let file = aside(&app, move |app| app.work.pool.install(|| export::export(&request))).await?;
    Ok(([("content-type", file.kind)], file.bytes).into_response())
}
