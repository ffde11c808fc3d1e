//! What keeps the viewer from running.

use crate::refusal::Refusal;
use std::io;
use thiserror::Error;

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
    Threads(#[from] maille::InvalidInput),
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
