//! The page, as it was built into the crate.

include!(concat!(env!("OUT_DIR"), "/assets.rs"));

/// A file of the page with its MIME type.
pub fn asset(name: &str) -> Option<(&'static str, &'static [u8])> {
    let (name, bytes) = FILES.iter().find(|(known, _)| *known == name)?;
    let kind = match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    };
    Some((kind, bytes))
}

/// Whether the page has been built.
pub fn built() -> bool {
    asset("index.html").is_some()
}
