//! The crate uses the type of a circle and nothing else of `maille-geometry`, and no other crate of maille.

use std::fs;

#[test]
fn nothing_is_shared_with_the_solver_but_the_circle() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    let mut found = 0;
    let files = |folder: &str| -> Vec<_> { fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect() };
    let all = files(root).into_iter().chain(files(&format!("{root}/proof")));
    for path in all.filter(|path| path.is_file()) {
        let text = fs::read_to_string(&path).unwrap();
        for (at, _) in text.match_indices("maille_geometry::") {
            let rest = &text[at + "maille_geometry::".len()..];
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || "{*_".contains(*c)).collect();
            assert_eq!(name, "Circle", "{}", path.display());
            found += 1;
        }
        // Nor the circle's own points and frames.
        for method in [".point(", ".frame()", ".angle_rad("] {
            assert!(!text.contains(method), "{}: {method}", path.display());
        }
    }
    assert!(found > 0);
    let manifest = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")).unwrap();
    let of_maille: Vec<&str> = manifest.lines().filter(|line| line.starts_with("maille")).collect();
    assert!(of_maille.len() == 1 && of_maille[0].starts_with("maille-geometry"), "{of_maille:?}");
}
