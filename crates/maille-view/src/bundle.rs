//! A page without a server: one file that holds the script, the style and the limits.

use crate::{api::Start, assets::asset, error::ViewError};

/// Where the data go in: the page reads the element of this name.
const DATA: &str = "maille-data";

/// The page with `start` and everything else inside.
pub fn bundle(start: &Start) -> Result<String, ViewError> {
    let text = |name: &str| {
        let (_, bytes) = asset(name).ok_or(ViewError::NoPage)?;
        Ok::<_, ViewError>(String::from_utf8_lossy(bytes).into_owned())
    };
    let (page, script, style) = (text("index.html")?, text("viewer.js")?, text("viewer.css")?);
    // JSON in a script element: no `<` can end it.
    let data = serde_json::to_string(start)?.replace('<', "\\u003c");
    let data = format!("<script id=\"{DATA}\" type=\"application/json\">{data}</script>");
    // In a script, `</script` can stand in strings and comments alone, where this means the same.
    let script = format!("<script type=\"module\">{}</script>", script.replace("</script", "<\\/script"));
    let mut out = String::with_capacity(page.len() + script.len() + style.len() + data.len());
    let (mut script, mut style) = (Some(script), Some(format!("<style>{style}</style>")));
    for line in page.lines() {
        if line.contains("viewer.js") && line.contains("<script") {
            continue;
        } else if line.contains("viewer.css") {
            out.extend(style.take());
        } else if line.trim() == "</body>" {
            out.push_str(&data);
            out.push('\n');
            out.extend(script.take());
            out.push_str("\n</body>");
        } else {
            out.push_str(line);
        }
        out.push('\n');
    }
    match (script, style) {
        (None, None) => Ok(out),
        _ => Err(ViewError::OddPage),
    }
}
