//! `cargo xtask bench`: every bench once, as the one table of docs/performance.md.

use crate::program::cargo;
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    path::Path,
    process::{Command, Stdio},
};

/// The page that the table stands in, after this line.
const PAGE: &str = "docs/performance.md";
const MARK: &str = "<!-- made by `cargo xtask bench` from here on -->";

/// A bench: its path in divan's tree, as `pair enumeration linked`, and the median time of one item.
#[derive(Clone, Debug, PartialEq)]
struct Median {
    path: String,
    seconds: f64,
}

/// Slower against faster, both from the same run.
const RATIOS: [(&str, &str, &str); 9] = [
    ("Minima of a linked pair: polynomial / enumeration", "pair polynomial linked", "pair enumeration linked"),
    ("Minima of a near pair: one by one / in a batch", "pair enumeration near", "pair batch 2 near"),
    ("Minima of a near pair in a batch: baseline / best instructions", "pair batch 0 near", "pair batch 2 near"),
    ("Hessian of 4×4 cells of 1.1: finite differences / formulas", "sheet hessian true 4x4", "sheet hessian false 4x4"),
    ("Newton direction of 7×7 cells of 1.1: dense / sparse", "sheet dense true 7x7", "sheet dense false 7x7"),
    ("Newton step of 100×100 cells of 1.1: one thread / two", "sheet step 1 100x100", "sheet step 2 100x100"),
    ("Newton step of a ring of 1.1: in 100×100 cells / in 10×10", "sheet step 2 100x100", "sheet step 2 10x10"),
    ("Limit of 1.1: energy / exact", "limits energy_limit 1.1", "limits exact_map 1.1"),
    ("Map of 1.1: one thread / two", "sweep map 1", "sweep map 2"),
];

/// Runs all benches, or reads `saved` output of them, and writes the page's table anew.
pub fn write(root: &Path, saved: Option<&str>) -> Result<(), String> {
    let output = match saved {
        Some(file) => std::fs::read_to_string(file).map_err(|e| format!("{file} cannot be read: {e}"))?,
        None => run(root)?,
    };
    let medians = parse(&output)?;
    let page = root.join(PAGE);
    let text = std::fs::read_to_string(&page).map_err(|e| format!("{PAGE} cannot be read: {e}"))?;
    let (before, _) = text.split_once(MARK).ok_or_else(|| format!("{PAGE} has no line `{MARK}`"))?;
    let whole = format!("{before}{MARK}\n\n{}{}\n{}", machine(), beside(&output), table(&medians)?);
    let new = page.with_extension("md.tmp");
    std::fs::write(&new, whole).and_then(|()| std::fs::rename(&new, &page)).map_err(|e| format!("{PAGE}: {e}"))
}

/// What the benches print; what cargo says goes to the terminal.
fn run(root: &Path) -> Result<String, String> {
    let mut command = Command::new(cargo());
    command.args(["bench", "-p", "maille-geometry", "-p", "maille", "--benches"]).current_dir(root);
    let output = command.stderr(Stdio::inherit()).output().map_err(|e| format!("cargo bench did not start: {e}"))?;
    if !output.status.success() {
        return Err(format!("cargo bench ended with {}", output.status));
    }
    String::from_utf8(output.stdout).map_err(|e| format!("cargo bench printed no text: {e}"))
}

/// What the figures were measured on, as far as the system tells.
fn machine() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        told.lines().find(|line| line.starts_with(name)).and_then(|line| line.split(':').nth(1)).map(str::trim)
    };
    let model = field("model name").unwrap_or("a processor that the system does not name");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let widest = ["avx512f", "avx2"].into_iter().find(|set| field("flags").is_some_and(|flags| flags.contains(set)));
    format!("{cores} cores of {model}, widest instructions {}.\n\n", widest.unwrap_or("baseline"))
}

/// What the benches print beside divan's trees.
fn beside(output: &str) -> String {
    let lines = output.lines().filter(|line| !line.contains('│') && !line.contains("Timer precision"));
    let mut out = String::new();
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let _ = writeln!(out, "    {line}");
    }
    out
}

/// The medians of divan's trees. A line below a bench gives its items a second; without one the bench is one item.
fn parse(output: &str) -> Result<Vec<Median>, String> {
    let mut out: Vec<Median> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for line in output.lines() {
        let columns: Vec<&str> = line.split('│').map(str::trim).collect();
        // The tree's own lines are │, too: the last five columns are the figures.
        let [.., _, median, _, _, _] = columns[..] else { continue };
        let Some(name_at) = line.find(|c: char| !" │├╰─".contains(c)) else { continue };
        let depth = line[..name_at].chars().count() / 3;
        let head = line[name_at..].split('│').next().unwrap_or_default();
        let is_group = head.trim_end().split("  ").filter(|word| !word.trim().is_empty()).count() < 2;
        if line[name_at..].contains("item/s") {
            let rate = quantity(median.trim_end_matches("item/s"))?;
            out.last_mut().ok_or("a rate without a bench")?.seconds = 1.0 / rate;
            continue;
        }
        let name = head.trim().split("  ").next().unwrap_or_default().trim();
        names.truncate(depth);
        names.push(name.to_owned());
        if !is_group && median.ends_with('s') {
            out.push(Median { path: names.join(" "), seconds: quantity(median)? });
        }
    }
    if out.is_empty() { Err("the benches printed no figures".into()) } else { Ok(out) }
}

/// A figure with its unit, as `28.24 ms` or `330.3 K`.
fn quantity(text: &str) -> Result<f64, String> {
    // Rates below a thousand have no unit.
    let (number, unit) = text.trim().split_once(' ').unwrap_or((text.trim(), ""));
    let factor = match unit.trim() {
        "" => 1.0,
        "K" => 1e3,
        "M" => 1e6,
        "G" => 1e9,
        "s" => 1.0,
        "ms" => 1e-3,
        "µs" => 1e-6,
        "ns" => 1e-9,
        "ps" => 1e-12,
        "m" => 60.0,
        _ => return Err(format!("`{unit}` is no unit")),
    };
    number.parse::<f64>().map(|x| x * factor).map_err(|_| format!("`{number}` is no number"))
}

fn table(medians: &[Median]) -> Result<String, String> {
    let known: BTreeMap<&str, f64> = medians.iter().map(|m| (m.path.as_str(), m.seconds)).collect();
    let find = |path: &str| known.get(path).copied().ok_or_else(|| format!("there is no bench `{path}`"));
    let mut out = String::from("| compared | slower | faster | ratio |\n| --- | ---: | ---: | ---: |\n");
    for (words, slower, faster) in RATIOS {
        let (slow, fast) = (find(slower)?, find(faster)?);
        let _ = writeln!(out, "| {words} | {} | {} | {:.2} |", time(slow), time(fast), slow / fast);
    }
    out.push_str("\n| bench | case | median of one item |\n| --- | --- | ---: |\n");
    for Median { path, seconds } in medians {
        let mut words = path.splitn(3, ' ');
        let [file, bench] = [words.next(), words.next()].map(Option::unwrap_or_default);
        let _ = writeln!(out, "| {file} {bench} | {} | {} |", words.next().unwrap_or_default(), time(*seconds));
    }
    Ok(out)
}

fn time(seconds: f64) -> String {
    let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    let (size, unit) = units.into_iter().find(|(size, _)| seconds >= *size).unwrap_or((1e-9, "ns"));
    let value = seconds / size;
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_become_medians() {
        let output = "\
Timer precision: 20 ns
pair                   fastest       │ slowest       │ median        │ mean          │ samples │ iters
├─ batch                             │               │               │               │         │
│  ╰─ 0                              │               │               │               │         │
│     ├─ near            52.5 µs     │ 60 µs         │ 50 µs         │ 54 µs         │ 100     │ 100
│     │                  20 Mitem/s  │ 10 Mitem/s    │ 20 Mitem/s    │ 18 Mitem/s    │         │
├─ enumeration                       │               │               │               │         │
│  ├─ near degenerate  24.28 ms      │ 37.78 ms      │ 28.24 ms      │ 28.54 ms      │ 100     │ 100
│  │                   41.17 Kitem/s │ 26.46 Kitem/s │ 35.4 Kitem/s  │ 35.03 Kitem/s │         │
├─ slow                300 ms        │ 300 ms        │ 300 ms        │ 300 ms        │ 5       │ 5
│                      83.16 item/s  │ 80 item/s     │ 80 item/s     │ 80 item/s     │         │
╰─ alone               1.5 s         │ 2.5 s         │ 2 s           │ 2 s           │ 100     │ 100
";
        let found = parse(output).unwrap();
        let expected = [
            ("pair batch 0 near", 5e-8),
            ("pair enumeration near degenerate", 1.0 / 35.4e3),
            ("pair slow", 0.0125),
            ("pair alone", 2.0),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (median, (path, seconds)) in found.iter().zip(expected) {
            assert_eq!(median.path, path);
            assert!((median.seconds / seconds - 1.0).abs() < 1e-12, "{median:?}");
        }
        assert!(parse("nothing").is_err());
        assert_eq!((time(2.5e-7), time(0.0123), time(3.2)), ("250 ns".into(), "12.3 ms".into(), "3.20 s".into()));
    }
}
