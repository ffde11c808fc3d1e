//! Requests that are refused, as answers.

use crate::api::Refused;
use axum::{
    http::StatusCode,
    response::{IntoResponse, Response},
};
use maille_io::DesignError;
use std::fmt;

/// Why a request is refused, with its status.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// The status of the answer.
    pub status: StatusCode,
    /// What it says.
    pub refused: Refused,
}

impl Refusal {
    /// The request is wrong.
    pub fn wrong(problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self::of(StatusCode::UNPROCESSABLE_ENTITY, problem, help)
    }

    /// With another status.
    pub fn of(status: StatusCode, problem: impl Into<String>, help: impl Into<String>) -> Self {
        Refusal { status, refused: Refused { problem: problem.into(), help: help.into(), problems: Vec::new() } }
    }

    /// The design is wrong.
    pub fn design(error: &DesignError) -> Self {
        let problems = error.list();
        let help = problems.iter().find_map(|p| p.help.clone()).unwrap_or_default();
        let mut out = Self::wrong(error.to_string(), help);
        out.refused.problems = problems;
        out
    }

    /// The server is at fault.
    pub fn fault(problem: impl fmt::Display) -> Self {
        Self::of(StatusCode::INTERNAL_SERVER_ERROR, problem.to_string(), "please report this")
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.refused.problem)
    }
}

impl std::error::Error for Refusal {}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        json_response(self.status, &self.refused)
    }
}

/// An answer in JSON.
pub fn json_response(status: StatusCode, body: &impl serde::Serialize) -> Response {
    match serde_json::to_vec(body) {
        Ok(bytes) => (status, [("content-type", "application/json")], bytes).into_response(),
        Err(e) => (StatusCode::INTERNAL_SERVER_ERROR, e.to_string()).into_response(),
    }
}
