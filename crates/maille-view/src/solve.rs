//! Maps that are asked for, sent as they are found.

use crate::{
    api::{Refused, Solve, SolveEvent, Subject},
    refusal::Refusal,
    sheet::{Read, limit, sheet},
    work::{CancelOnDrop, Ticket, Work},
};
use axum::{
    body::{Body, Bytes},
    response::{IntoResponse, Response},
};
use futures_util::stream::unfold;
use maille::{
    lattice::{Across, Cell},
    model::Model,
    record::{LimitRow, StateRecord},
    search::ExactOptions,
    survey::{CellChoice, MapQuestion, Method},
};
use maille_io::{
    Quantity,
    run::{Map, OpenMap},
};
use std::{
    borrow::Cow,
    convert::Infallible,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

/// Limits of one request, at most.
const MOST_LIMITS: usize = 2_000;
/// The stream says something at least this often, so that a socket that has closed is found.
const HEARTBEAT: Duration = Duration::from_millis(500);

/// The map that is asked for: as `maille characterize` without `--out`. With a free width, l2 is `[0]`.
pub fn map_of(directions_deg: Vec<f64>, l2: Vec<f64>, lateral_free: bool) -> Result<Map, Refusal> {
    if directions_deg.len().saturating_mul(l2.len()) > MOST_LIMITS {
        return Err(Refusal::wrong("there are too many limits to find", format!("ask for {MOST_LIMITS} at most")));
    }
    let across = Across { lateral_free, shear_free: false };
    let method = Method::Exact(ExactOptions { across, ..ExactOptions::default() });
    let l2 = Some(l2).filter(|l2| !(lateral_free && *l2 == [0.0]));
    let question = MapQuestion::new(method, CellChoice::Auto, Some(directions_deg), l2, None)
        .map_err(|e| Refusal::wrong(e.to_string(), e.help))?;
    Ok(Map { question, quantity: Quantity::default(), out: None, overwrite: false, sensitivities: false })
}

/// Starts the solve and answers with its events. It ends when the answer is dropped.
pub fn stream(work: Arc<Work>, request: Solve) -> Result<Response, Refusal> {
    let map = map_of(request.directions_deg.clone(), request.l2.clone(), request.lateral_free)?;
    let ticket = work.claim(&request.slot)?;
    let (send, receive) = unbounded_channel();
    let guard = CancelOnDrop(Arc::clone(&ticket.cancel));
    let places = Arc::clone(&work.solves);
    tokio::spawn(async move {
        let Ok(_place) = places.acquire_owned().await else { return };
        let _ = tokio::task::spawn_blocking(move || run(&work, &map, &request, ticket, &send)).await;
    });
    let body = Body::from_stream(unfold((receive, guard), next));
    let head = [("content-type", "text/event-stream"), ("cache-control", "no-store")];
    Ok((head, body).into_response())
}

async fn next(
    (mut receive, guard): (UnboundedReceiver<SolveEvent>, CancelOnDrop),
) -> Option<(Result<Bytes, Infallible>, (UnboundedReceiver<SolveEvent>, CancelOnDrop))> {
    let said = match tokio::time::timeout(HEARTBEAT, receive.recv()).await {
        Err(_) => ":\n\n".to_owned(),
        Ok(None) => return None,
        Ok(Some(event)) => match serde_json::to_string(&event) {
            Ok(json) => format!("data: {json}\n\n"),
            Err(e) => {
                format!("data: {{\"failed\":{{\"problem\":{:?},\"help\":\"\",\"problems\":[]}}}}\n\n", e.to_string())
            }
        },
    };
    Some((Ok(Bytes::from(said)), (receive, guard)))
}

/// Finds the limits; the ticket is given back at the end, before the last word.
fn run(work: &Work, map: &Map, request: &Solve, ticket: Ticket, send: &UnboundedSender<SolveEvent>) {
    let cancel = Arc::clone(&ticket.cancel);
    // Of packages and tests; with the profile `release` a panic ends the viewer.
    let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        if cancel.load(Ordering::Relaxed) {
            return Ok(());
        }
        work.pool.install(|| solve(map, request, &cancel, send))
    }));
    let last = match found {
        Ok(Ok(())) => SolveEvent::Ended { cancelled: cancel.load(Ordering::Relaxed) },
        Ok(Err(refusal)) => SolveEvent::Failed(refusal.refused),
        Err(_) => SolveEvent::Failed(Refused {
            problem: "maille itself is at fault: a solve has panicked".into(),
            help: "please report this, with the design".into(),
            problems: Vec::new(),
        }),
    };
    drop(ticket);
    let _ = send.send(last); // nobody may listen any more
}

/// The models with one of the cell `cell` among them: the image of a limit can be of a cell that was not solved.
fn with_cell<'a>(models: &'a [Model], cell: &str) -> Cow<'a, [Model]> {
    match cell.parse::<Cell>() {
        Ok(other) if models.iter().all(|model| model.cell != other) => {
            Cow::Owned(models.iter().cloned().chain([models[0].in_cell(other)]).collect())
        }
        _ => Cow::Borrowed(models),
    }
}

/// The subject with its models, and the map of it, open.
pub fn open(map: &Map, subject: &Subject) -> Result<(Read, Vec<Model>, OpenMap), Refusal> {
    let read = subject.read()?;
    let models = map.cells(&read.design).into_iter().map(|cell| read.compile(&read.design, cell));
    let models = models.collect::<Result<Vec<_>, _>>()?;
    let mut map = map.clone();
    if read.design.lattice.single {
        // A chain is pulled along itself, and has no width.
        (map.question.directions_deg, map.question.l2) = (vec![read.design.lattice.direction_deg()], vec![0.0]);
    }
    map.question.suits(&models[0]).map_err(|e| Refusal::wrong(e.problem, e.help))?;
    let open = map.open(&read.design, models.clone()).map_err(Refusal::fault)?;
    Ok((read, models, open))
}

fn solve(map: &Map, request: &Solve, cancel: &AtomicBool, send: &UnboundedSender<SolveEvent>) -> Result<(), Refusal> {
    let (read, models, open) = open(map, &request.subject)?;
    let say = |event| drop(send.send(event));
    say(SolveEvent::Begun(open.total()));
    // Sheets come before their limits, and each once.
    let told = Mutex::new(Vec::<String>::new());
    let found = |row: &LimitRow, state: &StateRecord| {
        if cancel.load(Ordering::Relaxed) {
            return; // limits that were cut off
        }
        let models = with_cell(&models, &row.cell);
        let limit = limit(&models, row, state);
        let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
        for model in models.iter() {
            let cell = model.cell.to_string();
            if (cell == row.cell || told.is_empty()) && !told.contains(&cell) {
                say(SolveEvent::Sheet(Box::new(sheet(model, &read.design))));
                told.push(cell);
            }
        }
        say(SolveEvent::Limit(Box::new(limit)));
    };
    open.run(cancel, &|_, _| (), &found).map_err(Refusal::fault)?;
    Ok(())
}
