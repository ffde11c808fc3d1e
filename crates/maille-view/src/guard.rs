//! Who is answered: pages of this server alone. A page of another site may send requests to a loopback address, and may
//! point a name of its own at it (DNS rebinding); both show in `Origin` and `Host`.

use crate::refusal::Refusal;
use axum::{
    extract::{Request, State},
    http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

/// What every answer says: nothing from elsewhere, nothing in a frame.
const HEADERS: [(&str, &str); 5] = [
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cross-origin-opener-policy", "same-origin"),
];

/// Refuses what another page sends.
pub async fn guard(State(port): State<u16>, request: Request, next: Next) -> Response {
    let mut response = match allowed(request.headers(), request.uri().host().is_some(), port) {
        true => next.run(request).await,
        false => Refusal::of(
            StatusCode::FORBIDDEN,
            "this server answers its own page alone",
            format!("open http://127.0.0.1:{port}/"),
        )
        .into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

fn allowed(headers: &HeaderMap, absolute: bool, port: u16) -> bool {
    let own = |host: &str| ["127.0.0.1", "localhost", "[::1]"].iter().any(|name| host == format!("{name}:{port}"));
    let only = |name: HeaderName| {
        let mut values = headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("?"));
        (values.next(), values.next().is_some())
    };
    let (host, several_hosts) = only(header::HOST);
    let (origin, several_origins) = only(header::ORIGIN);
    let own_origin = origin.is_none_or(|origin| origin.strip_prefix("http://").is_some_and(own));
    host.is_some_and(own) && own_origin && !several_hosts && !several_origins && !absolute
}
