//! Advice on the usual mistakes of TOML's syntax.

use std::ops::Range;

/// What is wrong and what would be right, guessed from the parser's message and the text at `span`.
pub(super) fn describe(message: &str, text: &str, span: &Range<usize>) -> (String, String) {
    let start = span.start.min(text.len());
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let at = Place {
        message,
        before: text[line_start..start].trim_end(),
        rest: text[start..].lines().next().unwrap_or_default(),
        marked: text.get(span.clone()).unwrap_or_default(),
    };
    let guess = at.duplicate().or_else(|| at.no_value()).or_else(|| at.decimal_comma());
    let guess = guess.or_else(|| at.semicolon()).or_else(|| at.unit()).or_else(|| at.unquoted());
    let (problem, help) = guess.unwrap_or_else(|| (message.to_owned(), general_help(message).to_owned()));
    (format!("not valid TOML: {problem}"), help)
}

/// Where the parser stopped.
struct Place<'a> {
    message: &'a str,
    /// The line up to there.
    before: &'a str,
    /// The line from there.
    rest: &'a str,
    /// What the parser marks.
    marked: &'a str,
}

/// What is wrong, and what would be right.
type Guess = Option<(String, String)>;

impl Place<'_> {
    fn key(&self) -> &str {
        self.before.split('=').next().unwrap_or_default().trim()
    }

    fn duplicate(&self) -> Guess {
        if !self.message.contains("duplicate key") {
            return None;
        }
        let line = format!("{}{}", self.before, self.rest);
        Some(match line.trim() {
            "[elements]" => (
                "[elements] stands twice".into(),
                "each element begins with [[elements]], in two pairs of brackets: so they make a list".into(),
            ),
            _ => (self.message.into(), "each key stands once in its table: remove one of the two".into()),
        })
    }

    fn no_value(&self) -> Guess {
        let none = self.before.ends_with('=') && self.rest.trim().is_empty();
        none.then(|| (format!("`{}` has no value", self.key()), format!("write a value after {}", self.before)))
    }

    /// `minor_radius = 0,1`, or `major_radius = 6,0` in a ring.
    fn decimal_comma(&self) -> Guess {
        if self.before.contains('{') {
            return self.decimal_comma_inline();
        }
        let value = self.before.split('=').nth(1).unwrap_or_default().trim();
        let decimals: String = self.rest.strip_prefix(',')?.chars().take_while(char::is_ascii_digit).collect();
        let key = self.key();
        (value.ends_with(|c: char| c.is_ascii_digit()) && !decimals.is_empty()).then(|| {
            (format!("`{key}` is {value},{decimals}"), format!("decimals take a point: {key} = {value}.{decimals}"))
        })
    }

    fn decimal_comma_inline(&self) -> Guess {
        let line = format!("{}{}", self.before, self.rest);
        let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).collect::<String>();
        let (keys, values) = (line.split('='), line.split('=').skip(1));
        keys.zip(values).find_map(|(key, value)| {
            let key = key.rsplit([',', '{', ' ']).find(|word| !word.is_empty())?;
            let whole = digits(value.trim_start());
            let decimals = digits(value.trim_start().strip_prefix(&whole)?.strip_prefix(',')?);
            (!whole.is_empty() && !decimals.is_empty()).then(|| {
                (format!("`{key}` is {whole},{decimals}"), format!("decimals take a point: {key} = {whole}.{decimals}"))
            })
        })
    }

    /// `minor_radius = 0.6;` or `a1 = [15.0; 0.0; 0.0]`.
    fn semicolon(&self) -> Guess {
        let line = format!("{}{}", self.before, self.rest);
        let (left, _) = line.split_once(';').filter(|(left, _)| !left.contains(['#', '"', '\'']))?;
        let number = left.rsplit(|c: char| !(c.is_ascii_digit() || ".+-".contains(c))).next()?;
        let help = match left.contains('[') {
            true => "numbers of a list are separated by commas: [1.0, 2.0, 3.0]",
            false => "leave it out: a line ends without one",
        };
        (!number.is_empty()).then(|| (format!("a semicolon follows {number}"), help.into()))
    }

    /// `minor_radius = 1.6mm`.
    fn unit(&self) -> Guess {
        let unit: String = self.rest.chars().take_while(|c| c.is_alphabetic()).collect();
        let head = self.before.trim_end_matches(|c: char| c.is_ascii_digit() || ".+-".contains(c));
        let number = &self.before[head.len()..];
        let digit = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        (digit && !unit.is_empty()).then(|| with_unit(number, &unit))
    }

    /// A text without straight quotes, or numbers without a comma between them.
    fn unquoted(&self) -> Guess {
        if !self.message.contains("must be quoted") {
            return None;
        }
        let numbers: Vec<&str> = self.marked.split_whitespace().collect();
        if numbers.len() > 1 && numbers.iter().all(|word| word.parse::<f64>().is_ok()) {
            let after = self.rest.get(self.marked.len()..).unwrap_or_default();
            return Some((
                format!("between {} a comma is missing", numbers.join(" and ")),
                format!("{}{}{after}", self.before, numbers.join(", ")),
            ));
        }
        let number: String = self.marked.chars().take_while(|c| c.is_ascii_digit() || ".+-".contains(*c)).collect();
        let unit = self.marked[number.len()..].trim();
        if number.parse::<f64>().is_ok() && !unit.is_empty() && unit.chars().all(char::is_alphabetic) {
            return Some(with_unit(&number, unit));
        }
        let typographic = |c: char| "“”„‟‘’‚«»".contains(c);
        if self.rest.starts_with(typographic) {
            let word = self.marked.trim_matches(typographic);
            return Some((
                format!("the quotes of {} are typographic", self.marked.trim()),
                format!("write straight ones: {} \"{word}\"", self.before),
            ));
        }
        let word: String = self.rest.chars().take_while(|c| !c.is_whitespace() && !",]}#".contains(*c)).collect();
        Some((format!("`{word}` is not a value"), format!("a text takes quotes: {} \"{word}\"", self.before)))
    }
}

fn with_unit(number: &str, unit: &str) -> (String, String) {
    (
        format!("{number}{unit} is not a number"),
        format!("write {number} alone; the unit of all lengths has a line of its own: unit = \"mm\""),
    )
}

fn general_help(message: &str) -> &'static str {
    if message.contains("array") {
        "an array is [1.0, 2.0, 3.0]: commas between its items, ] at its end; look at the line above too"
    } else if message.contains("inline table") {
        "a ring is { major_radius = 1.0, normal = [0.0, 0.0, 1.0] }: commas between its keys, } at its end"
    } else if message.contains("string") {
        "a string stands in \"double quotes\", on one line"
    } else if message.contains("expected newline") {
        "a line ends after its value: what stands there belongs on a line of its own, or nowhere"
    } else {
        "a line is key = value, [table], [[table]] or # comment"
    }
}
