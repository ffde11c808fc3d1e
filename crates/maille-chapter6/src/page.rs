//! The page: one HTML file with everything in it.

use crate::{
    figures::Figure,
    map::{Map, SCALED, ratio_label, signed},
    statements::{Finding, Part, RULE, Verdict},
};
use base64::{Engine, prelude::BASE64_STANDARD};
use maille::{
    design::{Design, Source},
    record::{LimitRow, Status},
};
use std::fmt::Write;

/// A design in the table of designs.
pub(crate) struct Sheet<'a> {
    pub(crate) design: &'a Design,
    /// The file that it was given by, where it is not built in.
    pub(crate) given: Option<&'a str>,
    /// Elements and links of a cell.
    pub(crate) counts: [usize; 2],
    /// Its picture.
    pub(crate) png: Vec<u8>,
}

const STYLE: &str = "\
:root{color-scheme:light}*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:1rem 1rem 4rem;font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff}
h1{font-size:1.7rem;line-height:1.2;margin:.6rem 0}h2{font-size:1.3rem;margin:2.6rem 0 .6rem;border-top:1px solid #ddd;padding-top:1rem}
nav a{margin-right:.9rem;white-space:nowrap}a{color:#15498c}
.note{color:#555;max-width:70ch}
.finding{border:1px solid #ddd;border-left:8px solid #999;border-radius:6px;padding:.6rem .9rem;margin:.8rem 0}
.finding p{margin:.2rem 0}.finding ul{margin:.2rem 0;padding-left:1.2rem}
.two{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1.3fr);gap:0 1.6rem}
.badge{display:inline-block;border-radius:4px;padding:0 .5rem;color:#fff;background:#777;font-weight:600}
.holds{border-left-color:#1b7f4b}.holds .badge{background:#1b7f4b}
.holds-with-exceptions{border-left-color:#a86300}.holds-with-exceptions .badge{background:#a86300}
.fails{border-left-color:#b3261e}.fails .badge{background:#b3261e}
.figures{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,520px),1fr));gap:1rem}
figure{margin:0;border:1px solid #e3e3e3;border-radius:6px;padding:.5rem;min-width:0}
figcaption{font-weight:600;padding:.1rem .3rem .4rem}
figure svg{display:block;width:100%;height:auto}
.sheets{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,250px),1fr));gap:1rem}
.sheets img{width:100%;height:auto;display:block}.sheets p{margin:.2rem .3rem;font-size:.92rem}
table{border-collapse:collapse;font-size:.92rem;width:100%;margin-top:1rem}th,td{padding:.25rem .5rem;text-align:right;border-bottom:1px solid #e6e6e6}
td{white-space:nowrap}th{vertical-align:bottom}th:first-child,td:first-child{text-align:left}
.parts{margin:.2rem 0 .4rem;width:auto}.parts td:first-child{white-space:normal}
details summary{cursor:pointer;color:#15498c}
@media (max-width:700px){.two{grid-template-columns:1fr}body{padding:.6rem .7rem 3rem}thead{display:none}tbody,tr{display:block}
tr{display:grid;grid-template-columns:1fr 1fr;gap:0 1rem;border-bottom:1px solid #ddd;padding:.4rem 0}
td{border:0;padding:.05rem 0;display:flex;justify-content:space-between;gap:.5rem}td::before{content:attr(data-of);color:#555;white-space:normal;text-align:left;line-height:1.3}
td:first-child{grid-column:1/-1;display:block;font-weight:600}}
";

/// Number, title and note of a section of figures.
type Section = (&'static str, &'static str, &'static str);

const COSTS: Section = (
    "6.1",
    "Figure 6.1: steps and time",
    "Means over all directions of a record at l₂ = −0.25 and 0.25, where the sheet can be held there. A step is a \
     quadratic program (exact) or a Newton iteration (energy); a run is one maximisation or minimisation. Times are wall \
     times of one limit and depend on what else the machine did. The thesis shows the time of each step of one pull of each design: \
     dense designs and l₂ = −0.25 take more and slower steps than l₂ = 0.25, with a spike where the system is perturbed.",
);

/// What all polar plots show, before what the thesis shows.
const POLAR: &str = "λ₁ − 1 at the limit, against the direction of the pull; both radii of a design on one scale. Red: interlocking \
    directions, found from the links (Figure 6.9). Lines are exact limits; markers, where there are some, are limits of \
    the energy method. The thesis shows ";

const LIMITS: [Section; 5] = [
    (
        "6.4",
        "Figures 6.4 and 6.9: designs 1.1, 1.2, 1.3",
        "curves with four lobes, least at 0° and 90°, largest at 45° and 135°; the notches at 0° and 90° of 1.2 are blunter at R/20.",
    ),
    (
        "6.5",
        "Figures 6.5 and 6.9: designs 3.1, 3.2",
        "six lobes, least along the three interlocking directions; in the rectangular cell no peak is favoured. 3.2, with standing rings of half the size, is smaller in every direction.",
    ),
    ("6.6", "Figures 6.6 and 6.9: designs 3.3, 3.4", "six lobes in the rectangular cell, none of them favoured."),
    (
        "6.7",
        "Figures 6.7 and 6.9: designs 4.1, 4.2, 4.3",
        "least at 0° and 90°; the notches of 4.3 are blunter at R/20.",
    ),
    (
        "6.8",
        "Figures 6.8 and 6.9: designs 2, 5.1, 5.2",
        "design 2 low within 15° of 0° at R/10, where its rings stack, and much less so at R/20; 5.1 and 5.2 as 1.1 and 3.1.",
    ),
];

const EFFECTS: [Section; 3] = [
    (
        "6.10",
        "Figure 6.10: effect of the minor radius",
        "Largest less smallest λ₁ − 1 of all directions, against l₂. The thesis shows falling curves, larger at R/20 than at R/10, but for \
         design 2 at small l₂, where R/10 lies above R/20.",
    ),
    (
        "6.11",
        "Figure 6.11: effect of the major radius",
        "The same, of designs whose standing rings differ in their major radius. The thesis shows larger differences with the \
         larger radius, which fall with l₂ at roughly the same rate.",
    ),
    (
        "6.12",
        "Figure 6.12: sheared and rectangular arrangement",
        "The same sheet in two cells. The thesis shows the peak at 30° much wider than those at 90° and 150° in the sheared cell, at every \
         l₂, and leaves the cause open. Exact limits agree; the energy method with the thesis's corner distances favours the peak at 30° in the \
         sheared cell.",
    ),
];

/// Most exceptions that a statement lists on the page; `statements.json` has all.
const LISTED: usize = 40;

/// The page, without anything that it would have to fetch. `words` says how the records were made.
pub(crate) fn page(
    words: &str,
    findings: &[Finding],
    sheets: &[Sheet<'_>],
    maps: &[Map],
    figures: &[Figure],
) -> String {
    let mut out = String::from("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    out += "<title>Chapter 6, computed anew</title>\n<style>\n";
    out += STYLE;
    out += "</style>\n</head>\n<body>\n<h1>Chapter 6, computed anew</h1>\n";
    let _ = writeln!(out, "<p class=\"note\">{}</p>", escape(words));
    out += "<nav><a href=\"#statements\">Statements</a> <a href=\"#f6.1\">6.1 cost</a> <a href=\"#designs\">6.2, 6.3 designs</a> \
            <a href=\"#f6.4\">6.4–6.9 limits</a> <a href=\"#f6.10\">6.10 minor radius</a> <a href=\"#f6.11\">6.11 major radius</a> \
            <a href=\"#f6.12\">6.12 arrangement</a> <a href=\"#records\">Records</a></nav>\n";
    out += "<h2 id=\"statements\">What the thesis says, and what was measured</h2>\n";
    let _ = writeln!(out, "<p class=\"note\">{RULE}</p>");
    write_checks(&mut out, maps);
    for finding in findings {
        write_finding(&mut out, finding);
    }
    write_section(&mut out, COSTS, "", figures);
    write_costs(&mut out, maps);
    out += "<h2 id=\"designs\">Figures 6.2 and 6.3: the designs</h2>\n<p class=\"note\">Starting states at r = R/10. \
            \u{201c}Text\u{201d}: the thesis's text fixes topology and proportions. \u{201c}Reconstruction\u{201d}: only the number or the \
            directions are known, the rest is ours. The thesis's own pictures are lost. Many starts overlap, as its own do; a run \
            begins by pushing the rings apart.</p>\n";
    write_sheets(&mut out, sheets);
    LIMITS.iter().for_each(|section| write_section(&mut out, *section, POLAR, figures));
    EFFECTS.iter().for_each(|section| write_section(&mut out, *section, "", figures));
    write_records(&mut out, maps);
    out += "</body>\n</html>\n";
    out
}

/// What every run is checked for: links and overlap.
fn write_checks(out: &mut String, maps: &[Map]) {
    let checked = || maps.iter().flat_map(|map| map.rows.iter().filter_map(move |row| Some((map, row, row.links_ok?))));
    let (runs, kept) = (checked().count(), checked().filter(|(_, _, ok)| *ok).count());
    let _ = write!(out, "<p class=\"note\">{kept} of {runs} runs ended with the links that they began with.");
    for (map, row, _) in checked().filter(|(_, _, ok)| !ok) {
        let _ = write!(out, " Lost: {}, {}°, l₂ = {}.", escape(&map.label()), row.direction_deg, signed(row.l2));
    }
    for method in ["exact", "energy"] {
        let of_method = maps.iter().filter(|map| map.method == method);
        let worst = of_method.map(|map| (worst_overlap(map), map.label())).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((overlap, label)) = worst {
            let _ = write!(out, " Worst overlap of the {method} method: {overlap:.1e} R ({}).", escape(&label));
        }
    }
    *out += " The table of <a href=\"#records\">records</a> has both for each record, limits.csv for each limit.</p>\n";
}

/// Deepest overlap at a limit, in R.
fn worst_overlap(map: &Map) -> f64 {
    let overlap = |row: &LimitRow| Some(row.max_overlap? / (row.minor_radius? / map.ratio));
    map.rows.iter().filter_map(overlap).fold(0.0, f64::max)
}

fn write_finding(out: &mut String, finding: &Finding) {
    let class = match finding.verdict {
        Verdict::NotMeasured => "not-measured",
        Verdict::Holds => "holds",
        Verdict::HoldsWithExceptions => "holds-with-exceptions",
        Verdict::Fails => "fails",
    };
    let _ = writeln!(
        out,
        "<div class=\"finding {class}\"><p><b>Statement {}</b> <span class=\"badge\">{}</span></p>\n<div class=\"two\"><p>{}</p><div>",
        finding.number,
        finding.verdict.words(),
        escape(finding.statement)
    );
    write_parts(out, &finding.parts);
    list(out, &finding.evidence);
    if !finding.exceptions.is_empty() {
        let more = finding.exceptions.len().saturating_sub(LISTED);
        let mut shown: Vec<String> = finding.exceptions.iter().take(LISTED).cloned().collect();
        shown.extend((more > 0).then(|| format!("… and {more} more, in statements.json")));
        let open = if finding.exceptions.len() <= 6 { " open" } else { "" };
        let _ = writeln!(out, "<details{open}><summary>Exceptions: {}</summary>", finding.exceptions.len());
        list(out, &shown);
        *out += "</details>\n";
    }
    *out += "</div></div></div>\n";
}

/// How many cases show it, tie, and show the contrary.
fn write_parts(out: &mut String, parts: &[Part]) {
    if parts.is_empty() {
        return;
    }
    *out += "<table class=\"parts\"><thead><tr><th>cases</th><th>shown</th><th>ties</th><th>against</th></tr></thead><tbody>";
    for Part { what, shown, ties, against } in parts {
        let _ = write!(out, "<tr><td>{}</td>", escape(what));
        for (head, count) in [("shown", shown), ("ties", ties), ("against", against)] {
            let _ = write!(out, "<td data-of=\"{head}\">{count}</td>");
        }
        *out += "</tr>";
    }
    *out += "</tbody></table>\n";
}

fn list(out: &mut String, items: &[String]) {
    *out += "<ul>";
    for item in items {
        let _ = write!(out, "<li>{}</li>", escape(item));
    }
    *out += "</ul>\n";
}

fn write_section(out: &mut String, (number, title, note): Section, before: &str, figures: &[Figure]) {
    let _ = writeln!(out, "<h2 id=\"f{number}\">{title}</h2>\n<p class=\"note\">{before}{note}</p>");
    *out += "<div class=\"figures\">\n";
    for figure in figures.iter().filter(|figure| figure.number == number) {
        let (title, svg) = (escape(&figure.title), figure.svg.trim());
        let _ = writeln!(out, "<figure><figcaption>{title}</figcaption>{svg}</figure>");
    }
    *out += "</div>\n";
}

fn write_sheets(out: &mut String, sheets: &[Sheet<'_>]) {
    *out += "<div class=\"sheets\">\n";
    for sheet in sheets {
        let [elements, links] = sheet.counts;
        let source = match (sheet.given, sheet.design.source) {
            (Some(file), _) => format!("given: {}", escape(file)),
            (None, Source::ThesisText) => "text".into(),
            (None, Source::Reconstruction) => "reconstruction".into(),
            (None, Source::Literature) => "literature".into(),
            (None, Source::Own) => "own".into(),
        };
        let (name, title) = (escape(&sheet.design.name), escape(&sheet.design.title));
        let _ = writeln!(
            out,
            "<figure><figcaption>Design {name}</figcaption><img alt=\"Sheet of design {name}\" src=\"data:image/png;base64,{}\">\
             <p>{title}. {elements} elements and {links} links a cell; {source}.</p></figure>",
            BASE64_STANDARD.encode(&sheet.png)
        );
    }
    *out += "</div>\n";
}

fn write_costs(out: &mut String, maps: &[Map]) {
    let heads = [-0.25, 0.25].map(|l2| {
        let l2 = signed(l2);
        let of = |what: &str| format!("{what}, l₂ = {l2}");
        ["ms a limit", "steps", "runs", "steps a run"].map(of)
    });
    write_heads(out, &heads.concat());
    for map in maps {
        let costs = [-0.25, 0.25].map(|l2| cost(map, l2));
        if costs.iter().all(Option::is_none) || map.design.ends_with(SCALED) {
            continue;
        }
        let cells = costs.map(|cost| cost.unwrap_or_else(|| ["–"; 4].map(String::from)));
        write_row(out, &map.label(), &heads.concat(), &cells.concat());
    }
    *out += "</tbody></table>\n";
}

/// Opens a table of records; on a narrow screen the heads stand beside their cells.
fn write_heads(out: &mut String, heads: &[String]) {
    *out += "<table><thead><tr><th>record</th>";
    for head in heads {
        let _ = write!(out, "<th>{head}</th>");
    }
    *out += "</tr></thead><tbody>\n";
}

fn write_row(out: &mut String, label: &str, heads: &[String], cells: &[String]) {
    let _ = write!(out, "<tr><td>{}</td>", escape(label));
    for (head, cell) in heads.iter().zip(cells) {
        let _ = write!(out, "<td data-of=\"{head}\">{cell}</td>");
    }
    *out += "</tr>\n";
}

fn cost(map: &Map, l2: f64) -> Option<[String; 4]> {
    let mean = |of: fn(&LimitRow) -> f64| map.mean(|of_row| of_row == l2, of);
    let (steps, runs) = (mean(|row| row.iterations as f64)?, mean(|row| row.runs as f64)?);
    let ms = 1000.0 * mean(|row| row.wall_s)?;
    Some([ms, steps, runs, steps / runs.max(1.0)].map(|x| format!("{x:.1}")))
}

fn write_records(out: &mut String, maps: &[Map]) {
    *out += "<h2 id=\"records\">Records</h2>\n<p class=\"note\">Every limit was checked for overlap, and for the links that the \
             design starts with. Global: a proven bound is attained. Local: certified, bound not attained. No limit: proved \
             that this l₂ is out of reach.</p>\n";
    let heads = [
        "limits",
        "worst overlap / R",
        "links unchanged",
        "global",
        "local",
        "threshold reached",
        "no limit (proved)",
        "not found",
    ]
    .map(String::from);
    write_heads(out, &heads);
    for map in maps {
        let found = map.rows.iter().filter(|row| row.l1.is_some()).count();
        let count = |status: Status| map.rows.iter().filter(|row| row.status == status).count();
        let worst = worst_overlap(map);
        let checked: Vec<bool> = map.rows.iter().filter_map(|row| row.links_ok).collect();
        let (links, runs) = (checked.iter().filter(|ok| **ok).count(), checked.len());
        let proved = count(Status::L2Unreachable) + count(Status::Unbounded);
        let counts = [Status::Global, Status::Local, Status::ThresholdReached].map(|status| count(status).to_string());
        let mut cells = vec![map.rows.len().to_string(), format!("{worst:.1e}"), format!("{links} of {runs}")];
        cells.extend(counts);
        cells.extend([proved, map.rows.len() - found - proved].map(|n| n.to_string()));
        write_row(out, &map.label(), &heads, &cells);
    }
    let mut radii: Vec<String> = maps.iter().map(|map| ratio_label(map.ratio)).collect();
    radii.sort();
    radii.dedup();
    let _ = writeln!(out, "</tbody></table>\n<p class=\"note\">Minor radii: {}.</p>", escape(&radii.join(", ")));
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
