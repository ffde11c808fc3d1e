//! Advice on the usual mistakes of TOML's syntax.

use std::ops::Range;

/// What is wrong and what would be right, guessed from the parser's message and the text at `span`.
pub(super) fn describe(message: &str, text: &str, span: &Range<usize>) -> (String, String) {
    let start = span.start.min(text.len());
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let before = text[line_start..start].trim_end();
    let rest = text[start..].lines().next().unwrap_or_default();
    let key = before.split('=').next().unwrap_or_default().trim();
    let value = before.split('=').nth(1).unwrap_or_default().trim();
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let (problem, help) = if message.contains("duplicate key") {
        (message.to_owned(), "each key stands once in its table: remove one of the two".to_owned())
    } else if before.ends_with('=') && rest.trim().is_empty() {
        (format!("`{key}` has no value"), format!("write a value after {before}"))
    } else if rest.starts_with(',') && digit(value.chars().last()) && digit(rest.chars().nth(1)) {
        let decimals: String = rest[1..].chars().take_while(char::is_ascii_digit).collect();
        (format!("`{key}` is {value},{decimals}"), format!("decimals take a point: {key} = {value}.{decimals}"))
    } else if message.contains("must be quoted") {
        let word: String = rest.chars().take_while(|c| !c.is_whitespace() && !",]}#".contains(*c)).collect();
        (format!("`{word}` is no value"), format!("a text takes quotes: {before} \"{word}\""))
    } else {
        (message.to_owned(), general_help(message).to_owned())
    };
    (format!("not valid TOML: {problem}"), help)
}

fn general_help(message: &str) -> &'static str {
    if message.contains("array") {
        "an array is [1.0, 2.0, 3.0]: commas between its items, ] at its end; look at the line above too"
    } else if message.contains("inline table") {
        "a ring is { major_radius = 1.0, normal = [0.0, 0.0, 1.0] }: commas between its keys, } at its end"
    } else if message.contains("string") {
        "a string stands in \"double quotes\", on one line"
    } else {
        "a line is key = value, [table], [[table]] or # comment"
    }
}
