//! The pages of the site, as Markdown: the documents of the repository with links between pages, and a page of each
//! other file that they link to.

use super::link;
use crate::{
    folder::copy_file,
    repository::{Finding, files, read},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// The book's settings, its table of contents, and the pages that are no documents of the repository.
pub const FOLDER: &str = "site";
/// The table of contents.
const CONTENTS: &str = "site/SUMMARY.md";
/// Folder whose documents all have a place in it.
const DOCUMENTS: &str = "docs";
/// Each `.ipynb` there is a page.
const NOTEBOOKS: &str = "examples/notebooks";
/// Its sections are named after designs.
const GALLERY: &str = "docs/gallery/README.md";
/// What is shown by a browser as it is.
const SHOWN: &[&str] = &["png", "jpg", "gif", "webp", "svg", "html"];

/// Pages by their path in the repository, pictures, and the table of contents.
pub struct Source<'a> {
    root: &'a Path,
    contents: String,
    pages: BTreeMap<String, String>,
    pictures: BTreeSet<String>,
}

impl<'a> Source<'a> {
    /// Reads the documents of the table of contents, and what they link to.
    pub fn read(root: &'a Path) -> Result<Source<'a>, String> {
        let contents = read(root, CONTENTS).map_err(|finding| finding.to_string())?;
        let mut out = Source { root, contents, pages: BTreeMap::new(), pictures: BTreeSet::new() };
        let listed: BTreeSet<String> = listed(&out.contents).into_iter().map(|(path, _)| path).collect();
        let mut others = BTreeSet::new();
        for page in listed.iter().filter(|page| !page.starts_with(NOTEBOOKS)) {
            let text = read(root, page).map_err(|finding| finding.to_string())?;
            let text = link::rewritten(&text, |target| {
                let (path, anchor) = link::resolved(page, target)?;
                Some(format!("{}{anchor}", link::relative(page, &out.target(&path, &listed, &mut others)?)))
            });
            out.pages.insert(page.clone(), if page == GALLERY { with_viewers(&text, page) } else { text });
        }
        if !others.is_empty() {
            out.contents += "\n# Files\n\n";
        }
        for path in others {
            let page = format!("{path}.md");
            out.contents += &format!("- [{path}]({page})\n");
            let text = out.shown(&path)?;
            out.pages.insert(page, text);
        }
        Ok(out)
    }

    /// Where a link to `path` leads in the site; none where it is left as it is.
    fn target(&mut self, path: &str, listed: &BTreeSet<String>, others: &mut BTreeSet<String>) -> Option<String> {
        if listed.contains(path) {
            return Some(link::html(path));
        }
        let index = format!("{path}/README.md");
        if listed.contains(&index) {
            return Some(link::html(&index));
        }
        if let Some(notebook) = path.strip_suffix(".ipynb").filter(|path| path.starts_with(NOTEBOOKS)) {
            return Some(format!("{notebook}.html"));
        }
        // Places of the site that are made later have no file here.
        if !self.root.join(path).exists() {
            return None;
        }
        if path.rsplit('.').next().is_some_and(|ending| SHOWN.contains(&ending)) {
            self.pictures.insert(path.to_owned());
            return Some(path.to_owned());
        }
        others.insert(path.to_owned());
        Some(format!("{path}.html"))
    }

    /// A page that shows a file, or what is in a folder.
    fn shown(&self, path: &str) -> Result<String, String> {
        let fence = "````";
        if !self.root.join(path).is_dir() {
            let text = read(self.root, path).map_err(|finding| finding.to_string())?;
            let language = path.rsplit('/').next().and_then(|name| Some(name.rsplit_once('.')?.1)).unwrap_or("text");
            return Ok(format!("# {path}\n\n{fence}{language}\n{}\n{fence}\n", text.trim_end()));
        }
        let mut out = format!("# {path}\n\nThe files of this folder of the repository.\n");
        let entries = fs::read_dir(self.root.join(path)).map_err(|e| format!("{path} cannot be read: {e}"))?;
        let mut names: Vec<_> = entries.filter_map(|entry| entry.ok()).filter(|e| e.path().is_file()).collect();
        names.sort_by_key(|entry| entry.file_name());
        for entry in names {
            let name = entry.file_name().to_string_lossy().into_owned();
            let text = read(self.root, &format!("{path}/{name}")).map_err(|finding| finding.to_string())?;
            let language = name.rsplit('.').next().unwrap_or("text");
            out += &format!("\n## {name}\n\n{fence}{language}\n{}\n{fence}\n", text.trim_end());
        }
        Ok(out)
    }

    /// Writes all below a folder.
    pub fn write(&self, folder: &Path) -> Result<(), String> {
        for (path, text) in self.pages.iter().chain([(&"SUMMARY.md".to_owned(), &self.contents)]) {
            let path = folder.join(path);
            let parent = path.parent().unwrap_or(folder);
            fs::create_dir_all(parent).map_err(|e| format!("{} cannot be made: {e}", parent.display()))?;
            fs::write(&path, text).map_err(|e| format!("{} cannot be written: {e}", path.display()))?;
        }
        for path in &self.pictures {
            copy_file(&self.root.join(path), &folder.join(path))?;
        }
        Ok(())
    }
}

/// The gallery with a link to the viewer in each design's section.
fn with_viewers(text: &str, page: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        out.push_str(line);
        if let Some(name) = line.strip_prefix("## ").and_then(|heading| heading.split_whitespace().next()) {
            let viewer = link::relative(page, &format!("viewer/{name}.html"));
            out += &format!("\n[Open {name} in the viewer]({viewer}): its limits and locked states in 3D.\n");
        }
    }
    out
}

/// The pages of a table of contents, with their lines.
fn listed(contents: &str) -> Vec<(String, usize)> {
    let target = |line: &str| Some(line.split_once("](")?.1.split_once(')')?.0.to_owned());
    contents.lines().enumerate().filter_map(|(index, line)| Some((target(line)?, index + 1))).collect()
}

/// Pages of the table of contents that are not there, documents that it lacks, and pages that it names twice.
pub fn check(root: &Path) -> Vec<Finding> {
    let contents = match read(root, CONTENTS) {
        Ok(contents) => contents,
        Err(finding) => return vec![finding],
    };
    let mut out = Vec::new();
    let mut wanted = BTreeSet::new();
    for (folder, ending) in [(DOCUMENTS, "md"), (FOLDER, "md"), (NOTEBOOKS, "ipynb")] {
        match files(root, folder, ending) {
            Ok(files) => wanted.extend(files.into_iter().filter(|file| file != CONTENTS)),
            Err(e) => out.push(Finding::new(folder, 0, format!("cannot be read: {e}"))),
        }
    }
    let mut seen = BTreeSet::new();
    for (page, line) in listed(&contents) {
        let file = match page.starts_with(NOTEBOOKS) {
            true => page.replace(".md", ".ipynb"),
            false => page.clone(),
        };
        if !root.join(&file).is_file() {
            out.push(Finding::new(CONTENTS, line, format!("there is no {file}")));
        }
        if !seen.insert(file) {
            out.push(Finding::new(CONTENTS, line, format!("{page} is named twice")));
        }
    }
    let lacking = wanted.difference(&seen).map(|file| Finding::new(CONTENTS, 0, format!("{file} has no line")));
    out.extend(lacking);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_contents_is_complete_and_the_check_would_find_a_gap() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        assert_eq!(check(&root), []);
        let folder = std::env::temp_dir().join(format!("maille-site-{}", std::process::id()));
        for (path, text) in [
            ("site/SUMMARY.md", "[a](docs/a.md)\n- [b](docs/b.md)\n- [a](docs/a.md)\n"),
            ("docs/a.md", ""),
            ("docs/c.md", ""),
            ("examples/notebooks/d.ipynb", ""),
        ] {
            fs::create_dir_all(folder.join(path).parent().unwrap()).unwrap();
            fs::write(folder.join(path), text).unwrap();
        }
        let problems: Vec<String> = check(&folder).into_iter().map(|found| found.to_string()).collect();
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(
            problems,
            [
                "site/SUMMARY.md:2: there is no docs/b.md",
                "site/SUMMARY.md:3: docs/a.md is named twice",
                "site/SUMMARY.md: docs/c.md has no line",
                "site/SUMMARY.md: examples/notebooks/d.ipynb has no line",
            ]
        );
    }

    #[test]
    fn documents_link_to_pages_and_files_become_pages() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let source = Source::read(&root).unwrap();
        let readme = &source.pages["README.md"];
        assert!(readme.contains("](docs/guide/index.html)") && readme.contains("](LICENSE-MIT.html)"));
        assert!(source.pages["LICENSE-MIT.md"].contains("````text\n"));
        assert!(source.pages[GALLERY].contains("](../../viewer/byzantine.html)"));
        assert!(source.pictures.contains("docs/pictures/polar-1.1.png"));
        assert!(source.contents.contains("- [designs/chapter6](designs/chapter6.md)"));
    }
}
