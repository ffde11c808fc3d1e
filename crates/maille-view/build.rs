//! Takes the built page into the crate, if it has been built.

use std::{env, fs, path::Path};

fn main() {
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").expect("cargo sets it")).join("web/dist");
    println!("cargo::rerun-if-changed={}", folder.display());
    let mut names: Vec<String> = fs::read_dir(&folder)
        .map(|entries| entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect())
        .unwrap_or_default();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    let list: String = names
        .iter()
        .map(|name| format!("    ({name:?}, include_bytes!({:?})),\n", folder.join(name).display().to_string()))
        .collect();
    let out = Path::new(&env::var("OUT_DIR").expect("cargo sets it")).join("assets.rs");
    let text = format!("/// Names and contents of the page's files.\nconst FILES: &[(&str, &[u8])] = &[\n{list}];\n");
    fs::write(out, text).expect("the build's folder can be written");
}
