//! `maille table`: rows of records.

use crate::{
    exit::{self, wrong},
    output, records,
};
use maille_io::{
    boundary::{boundary_csv, boundary_json},
    record::NamedRecord,
    roll::{rolls_csv, rolls_json},
    table::{Condition, Extent, Field, SortKey, Table, TableError},
};
use miette::{IntoDiagnostic, Result, WrapErr};
use std::{
    io::IsTerminal,
    path::{Path, PathBuf},
};

/// Rows of records, chosen and sorted: in the terminal, or as CSV, JSON or Parquet
///
/// In the terminal numbers are rounded and columns that do not fit are named below; the other formats have all columns
/// and digits. Parquet and JSON hold the units of the columns and the inputs of each record.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  maille table 1.1                                        maille-out/1.1, in the terminal
  maille table 1.1 --where 'direction=30,l2=-0.125'
  maille table 1.1 3.1 --where 'l2<0,status=local' --sort=-l1 --rows 10
  maille table 1.1 --columns direction,l2,l1,bound_gap --where 'bound_gap>1e-6'
  maille table 1.1 1.2 -o limits.parquet                  for polars, pandas, DuckDB
  maille table radius --where spacing=1                   of the study radius.toml
  maille table 1.1 --where l1=none --format csv

Conditions: = != < <= > >=, separated by commas; all must hold. a|b means either, none an empty value. What has a \
comma stands in double quotes: 'cell=\"1,0;-1,2\"'. Numbers are equal if nine digits are. direction is short for \
direction_deg, r for minor_radius; record is the folder that a row comes from.")]
pub struct Args {
    /// Folders of records, of a sweep for all its records, or of one surface or roll; NAME stands for maille-out/NAME
    #[arg(required = true, value_name = "RECORD")]
    records: Vec<PathBuf>,
    /// Only rows that meet these conditions; may be given several times
    #[arg(long = "where", value_name = "CONDITIONS", value_parser = conditions, allow_hyphen_values = true)]
    conditions: Vec<Conditions>,
    /// Order by these columns, -COLUMN with the largest first; empty values come last
    #[arg(long, value_name = "COLUMNS", value_parser = keys, allow_hyphen_values = true)]
    sort: Option<Keys>,
    /// These columns, in this order, or all [default: in text those of a first look, else all]
    #[arg(long, value_parser = columns)]
    columns: Option<Columns>,
    /// Rows at most
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// How the table is written [default: as the file is called, else text]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// The file, or - for standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    replace: output::Replace,
}

/// Conditions of one `--where`; also of `maille plot`.
#[derive(Clone)]
pub struct Conditions(pub Vec<Condition>);

#[derive(Clone)]
struct Keys(Vec<SortKey>);

#[derive(Clone)]
enum Columns {
    All,
    These(Vec<Field>),
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Text,
    Csv,
    Json,
    Parquet,
}

/// Reads a `--where`.
pub fn conditions(text: &str) -> Result<Conditions, TableError> {
    Condition::parse_list(text).map(Conditions)
}

/// Refuses conditions on a column that none of the records has.
pub fn known(conditions: &[Conditions], records: &[NamedRecord]) -> Result<()> {
    let mut all = conditions.iter().flat_map(|conditions| &conditions.0);
    all.try_for_each(|condition| condition.check(records)).map_err(refused)
}

fn refused(error: TableError) -> miette::Report {
    wrong(exit::USAGE, error.problem, error.help)
}

fn keys(text: &str) -> Result<Keys, TableError> {
    SortKey::parse_list(text).map(Keys)
}

fn columns(text: &str) -> Result<Columns, TableError> {
    if text == "all" { Ok(Columns::All) } else { Field::parse_list(text).map(Columns::These) }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<()> {
    let file = args.output.as_deref().filter(|path| *path != Path::new("-"));
    let format = match (args.format, file) {
        (Some(format), _) => format,
        (None, Some(file)) => format_of(file)?,
        (None, None) => Format::Text,
    };
    if format == Format::Parquet && file.is_none() && std::io::stdout().is_terminal() {
        return Err(wrong(exit::USAGE, "Parquet is not for the terminal", "name a file, as -o limits.parquet"));
    }
    file.into_iter().try_for_each(|file| args.replace.check(file))?;
    let bytes = match &args.records[..] {
        [path] => match (records::surface(path)?, records::rolls(path)?) {
            (Some((_, surface)), _) => {
                let json = |rows| boundary_json(&surface, rows);
                Some(whole(args, "surface", &boundary_csv(&surface), &json, format)?)
            }
            (_, Some((record, rolls))) => {
                let json = |rows: usize| {
                    let rolls = &rolls[..rows.min(rolls.len())];
                    format!("{:#}\n", rolls_json(&record.design, rolls))
                };
                Some(whole(args, "roll", &rolls_csv(&rolls), &json, format)?)
            }
            (None, None) => None,
        },
        _ => None,
    };
    let bytes = match bytes {
        Some(bytes) => bytes,
        None => written(args, &records::read(&args.records)?, format)?,
    };
    match file {
        Some(file) => {
            output::write(file, &bytes)?;
            eprintln!("{}", file.display());
            Ok(())
        }
        None => output::print(&bytes),
    }
}

fn written(args: &Args, records: &[NamedRecord], format: Format) -> Result<Vec<u8>> {
    let fields = match (&args.columns, format) {
        (Some(Columns::These(fields)), _) => fields.clone(),
        (None, Format::Text) => Field::first_look(records),
        _ => Field::all(records, records.len() > 1),
    };
    fields.iter().try_for_each(|field| field.check(records)).map_err(refused)?;
    known(&args.conditions, records)?;
    let mut table = Table::new(records, fields);
    table.keep(&args.conditions.iter().flat_map(|c| c.0.clone()).collect::<Vec<_>>());
    if let Some(Keys(keys)) = &args.sort {
        keys.iter().try_for_each(|key| key.check(records)).map_err(refused)?;
        table.sort(keys);
    }
    if format != Format::Text {
        table.truncate(args.rows.unwrap_or(usize::MAX));
    }
    Ok(match format {
        Format::Text => {
            let on_terminal = args.output.is_none() && std::io::stdout().is_terminal();
            let width = terminal_size::terminal_size().filter(|_| on_terminal).map(|(width, _)| usize::from(width.0));
            table.text(Extent { width, rows: args.rows }).into_bytes()
        }
        Format::Csv => table.csv().into_bytes(),
        Format::Json => table.json().into_bytes(),
        Format::Parquet => {
            let mut bytes = Vec::new();
            table.parquet(&mut bytes).into_diagnostic().wrap_err("cannot write the table")?;
            bytes
        }
    })
}

/// The table of a `surface` or of a `roll`: the columns of its CSV file, rounded in text.
fn whole(args: &Args, what: &str, csv: &str, json: &dyn Fn(usize) -> String, format: Format) -> Result<Vec<u8>> {
    if !args.conditions.is_empty() || args.sort.is_some() || args.columns.is_some() || format == Format::Parquet {
        let help = "--format csv or json has all of its columns and rows, for other programs to choose from";
        let problem = format!("the table of a {what} is not chosen from, sorted or written as Parquet");
        return Err(wrong(exit::USAGE, problem, help));
    }
    let rows = args.rows.unwrap_or(usize::MAX);
    let parsed: Vec<csv::StringRecord> = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(csv.as_bytes())
        .into_records()
        .take(rows.saturating_add(1))
        .collect::<Result<_, _>>()
        .into_diagnostic()?;
    let kept: Vec<Vec<&str>> = parsed.iter().map(|row| row.iter().collect()).collect();
    let text = match (format, &kept[..]) {
        (Format::Text, kept) => aligned(kept),
        (Format::Json, _) => json(rows),
        (_, kept) => csv.lines().take(kept.len()).map(|line| format!("{line}\n")).collect(),
    };
    Ok(text.into_bytes())
}

/// Columns as wide as their longest text, numbers to six decimals.
fn aligned(rows: &[Vec<&str>]) -> String {
    let rounded = |text: &&str| match text.parse::<f64>() {
        Ok(number) if text.contains('.') => format!("{number:.6}"),
        _ => (*text).to_owned(),
    };
    let texts: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(rounded).collect()).collect();
    let columns = texts.first().map_or(0, Vec::len);
    let width =
        |k: usize| texts.iter().filter_map(|row| row.get(k)).map(|text| text.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(text, width)| format!("{text:>width$}"));
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    texts.iter().map(line).collect()
}

fn format_of(file: &Path) -> Result<Format> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "txt" => Ok(Format::Text),
        "csv" => Ok(Format::Csv),
        "json" => Ok(Format::Json),
        "parquet" => Ok(Format::Parquet),
        _ => Err(wrong(
            exit::USAGE,
            format!("the ending of {} is not a format of tables", file.display()),
            "call it .txt, .csv, .json or .parquet, or give --format",
        )),
    }
}
