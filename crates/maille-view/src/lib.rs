//! The viewer: a server on the loopback address, with its page inside, and the page as one file.
//!
//! It is a door, as the program is: designs come in as text, limits come from [`maille_io::run::Map`], files from the
//! writers of `maille-io`. [`serve`] runs until a flag is set; [`bundle_file`] makes the page that needs no server.

pub mod api;
mod assets;
mod bundle;
mod export;
mod guard;
mod refusal;
mod routes;
mod save;
mod sheet;
mod solve;
mod work;

pub use refusal::Refusal;
pub use routes::router;

use api::{Listed, Palette, Shown, ShownMap, Start, Subject};
use maille::{lattice::Cell, record::LimitRow};
use maille_io::{
    builtin_designs, read_design,
    record::Record,
    render::{FORCE, KINDS, LOADS, UNLOADED},
    run::Map,
    weave::Weave,
};
use std::{
    io,
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};
use thiserror::Error;
use work::Work;

/// What keeps the viewer from running.
#[derive(Debug, Error)]
pub enum ViewError {
    /// The crate was built without its page.
    #[error("this program was built without the viewer's page")]
    NoPage,
    /// The page is not as the bundle needs it.
    #[error("the viewer's page was built otherwise than a bundle needs it")]
    OddPage,
    /// The port is taken, or the system gives none.
    #[error("cannot listen on port {port}")]
    Listen {
        /// The port that was asked for; 0 is any.
        port: u16,
        /// Why.
        source: io::Error,
    },
    /// Threads could not be started.
    #[error("cannot start the threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The server could not be started.
    #[error("cannot run the server")]
    Run(#[from] io::Error),
    /// The bundle's data could not be written.
    #[error("cannot write the bundle's data")]
    Data(#[from] serde_json::Error),
    /// The design or the record cannot be shown.
    #[error("{0}")]
    Refused(#[from] Refusal),
}

/// A design to open.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The name that errors show: a built-in name or a path.
    pub name: String,
    /// The design file, if it is one that may be written again.
    pub file: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// A record of it, with its name.
    pub record: Option<(String, Record)>,
}

/// What a server knows.
#[derive(Debug)]
pub struct App {
    start: Start,
    work: Arc<Work>,
    /// Where new files go.
    folder: PathBuf,
}

impl App {
    /// Opens a design; solves run on `threads`, new files go to `folder`.
    pub fn new(opened: &Opened, threads: Option<usize>, folder: PathBuf) -> Result<Self, ViewError> {
        Ok(App { start: start(opened, false)?, work: Arc::new(Work::new(threads)?), folder })
    }

    /// Solves that run or wait.
    pub fn live(&self) -> usize {
        self.work.live()
    }
}

/// The server stops for at most this long.
const PATIENCE: Duration = Duration::from_secs(5);

/// Serves the page on the loopback address until `stop` is set; `ready` hears of the address. Port 0 is any free one.
pub fn serve(app: App, port: u16, stop: &AtomicBool, ready: impl FnOnce(SocketAddr)) -> Result<(), ViewError> {
    if !assets::built() {
        return Err(ViewError::NoPage);
    }
    let app = Arc::new(app);
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let served = runtime.block_on(async {
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let listener =
            tokio::net::TcpListener::bind(address).await.map_err(|source| ViewError::Listen { port, source })?;
        let address = listener.local_addr()?;
        let server = tokio::spawn(axum::serve(listener, router(Arc::clone(&app), address.port())).into_future());
        ready(address);
        while !stop.load(Ordering::Relaxed) {
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
        server.abort();
        app.work.cancel_all();
        let begun = Instant::now();
        while app.live() > 0 && begun.elapsed() < PATIENCE {
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
        Ok(())
    });
    runtime.shutdown_timeout(PATIENCE);
    served
}

/// A map for a bundle: as `maille characterize` of these directions, on the current thread pool.
pub fn map_of_bundle(directions_deg: Vec<f64>, l2: Vec<f64>) -> Result<Map, ViewError> {
    Ok(solve::map_of(directions_deg, l2, false)?)
}

/// Solves `map` of the design that is opened; `found` hears of each limit.
pub fn solve_map(
    opened: &Opened,
    map: &Map,
    cancel: &AtomicBool,
    found: &(dyn Fn(&LimitRow) + Sync),
) -> Result<Record, ViewError> {
    let subject = Subject { name: opened.name.clone(), text: opened.text.clone(), minor_radius: None, spacing: None };
    let read = subject.read()?;
    let models = map.cells(&read.design).into_iter().map(|cell: Cell| read.compile(&read.design, cell));
    let models = models.collect::<Result<Vec<_>, _>>()?;
    let open = map.open(&read.design, models).map_err(Refusal::fault)?;
    Ok(open.run(cancel, &|row, _| found(row)).map_err(Refusal::fault)?)
}

/// The page with the design and its record inside, as one file that needs no server.
pub fn bundle_file(opened: &Opened) -> Result<String, ViewError> {
    bundle::bundle(&start(opened, true)?)
}

fn start(opened: &Opened, bundle: bool) -> Result<Start, ViewError> {
    let list = |entry: &maille_io::Builtin| {
        let title = read_design(entry.name, entry.toml).map_or(String::new(), |design| design.title);
        Listed { name: entry.name.to_owned(), title }
    };
    let color = |srgb: &u32| format!("#{srgb:06x}");
    let map = |(name, record): &(String, Record)| sheet::shown_map(name.clone(), record);
    let map: Option<ShownMap> = opened.record.as_ref().map(map).transpose()?;
    Ok(Start {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        designs: if bundle { Vec::new() } else { builtin_designs().iter().map(list).collect() },
        weaves: Weave::ALL.iter().map(|weave| weave.name().to_owned()).collect(),
        opened: Shown {
            name: opened.name.clone(),
            file: opened.file.as_ref().map(|file| file.display().to_string()),
            text: opened.text.clone(),
            map,
        },
        palette: Palette {
            kinds: KINDS.iter().map(color).collect(),
            loads: LOADS.iter().map(color).collect(),
            unloaded: color(&UNLOADED),
            force: color(&FORCE),
        },
        bundle,
    })
}
