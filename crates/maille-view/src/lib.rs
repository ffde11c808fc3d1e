//! The viewer: a server on the loopback address, with its page inside, and the page as one file.
//!
//! It is a front end, as the program is: designs come in as text, limits come from [`maille_io::run::Map`], files from the
//! writers of `maille-io`. [`serve`] runs until a flag is set; [`bundle_file`] makes the page that needs no server.

pub mod api;
mod app;
mod assets;
mod bundle;
mod error;
mod export;
mod guard;
mod new_design;
mod records;
mod refusal;
mod rolled;
mod routes;
mod save;
mod sheet;
mod simulated;
mod solve;
mod work;

pub use app::App;
pub use error::ViewError;
pub use records::{Opened, Recorded};
pub use refusal::Refusal;
pub use routes::router;

use api::Subject;
use maille::record::LimitRow;
use maille_io::{record::Record, run::Map};
use std::{
    net::{Ipv4Addr, SocketAddr},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

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
    let Opened { name, text, parameters, .. } = opened.clone();
    let subject = Subject { name, text, minor_radius: None, spacing: None, parameters };
    let (.., open) = solve::open(map, &subject)?;
    Ok(open.run(cancel, &|_, _| (), &|row, _| found(row)).map_err(Refusal::fault)?)
}

/// The page with the design and its record inside, as one file that needs no server.
pub fn bundle_file(opened: &Opened) -> Result<String, ViewError> {
    bundle::bundle(&app::start(opened, true)?)
}
