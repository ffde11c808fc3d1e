//! Links of Markdown pages.

/// A page with the target of each link replaced by what `new` makes of it; code blocks and code spans are left as they are.
pub fn rewritten(text: &str, mut new: impl FnMut(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(text.len());
    let mut fenced = false;
    for line in text.split_inclusive('\n') {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        match fence || fenced || line.starts_with("    ") {
            true => out.push_str(line),
            false => rewrite_line(line, &mut out, &mut new),
        }
    }
    out
}

fn rewrite_line(line: &str, out: &mut String, new: &mut impl FnMut(&str) -> Option<String>) {
    let (mut rest, mut ticks) = (line, 0);
    while let Some(at) = rest.find("](") {
        let (before, after) = rest.split_at(at + 2);
        out.push_str(before);
        rest = after;
        ticks += before.matches('`').count();
        if let Some(end) = after.find(')').filter(|_| ticks % 2 == 0) {
            let target = &after[..end];
            out.push_str(new(target).as_deref().unwrap_or(target));
            rest = &after[end..];
        }
    }
    out.push_str(rest);
}

/// The path of a relative link from the repository's root, and its anchor (`#part` or nothing); none of an address or of
/// an anchor alone.
pub fn resolved<'a>(page: &str, target: &'a str) -> Option<(String, &'a str)> {
    let (path, anchor) = target.split_at(target.find('#').unwrap_or(target.len()));
    if path.is_empty() || path.contains("://") || path.starts_with("mailto:") {
        return None;
    }
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in path.split('/').filter(|part| !matches!(*part, "" | ".")) {
        match part {
            ".." => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    Some((parts.join("/"), anchor))
}

/// The link from one page to a path of the site.
pub fn relative(page: &str, path: &str) -> String {
    format!("{}{path}", "../".repeat(page.matches('/').count()))
}

/// What the page of a Markdown file is called.
pub fn html(path: &str) -> String {
    match path.strip_suffix("README.md") {
        Some(folder) => format!("{folder}index.html"),
        None => format!("{}.html", path.strip_suffix(".md").unwrap_or(path)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_replaced_and_code_is_not() {
        let text =
            "See [a](b.md#c) and `[d](e.md)`, ![f](g.png).\n\n    [h](i.md)\n\n```\n[j](k.md)\n```\n[l](https://m.org)";
        let out = rewritten(text, |target| target.ends_with("png").then(|| "new".into()).or(Some(html(target))));
        assert!(out.starts_with("See [a](b.md#c.html) and `[d](e.md)`, ![f](new).\n\n    [h](i.md)\n"), "{out}");
        assert!(out.contains("\n[j](k.md)\n"));
    }

    #[test]
    fn links_are_resolved_from_their_page() {
        assert_eq!(resolved("docs/a/b.md", "../c.md#d"), Some(("docs/c.md".into(), "#d")));
        assert_eq!(resolved("README.md", "docs/"), Some(("docs".into(), "")));
        assert_eq!(resolved("README.md", "#a"), None);
        assert_eq!(resolved("README.md", "https://a.org/b.md"), None);
        assert_eq!(relative("docs/a/b.md", "c/d.html"), "../../c/d.html");
        assert_eq!(
            (html("README.md"), html("a/README.md"), html("a/b.md")),
            ("index.html".into(), "a/index.html".into(), "a/b.html".into())
        );
    }
}
