//! Rust source as a stream of names and signs: enough to find paths, with comments and literals left out.

/// A token that matters to a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Token {
    /// A name or keyword; `r#name` is `name`.
    Name(String),
    /// `::`.
    Separator,
    /// Any other sign.
    Sign(char),
}

/// The tokens of `source`, each with its line from 1.
///
/// Skipped: comments (nested ones too, and documentation), strings of every prefix, characters, lifetimes, numbers.
pub fn tokens(source: &str) -> Vec<(Token, usize)> {
    let mut scan = Scan { text: source.chars().collect(), at: 0, line: 1 };
    let mut out = Vec::new();
    while let Some(c) = scan.peek(0) {
        let line = scan.line;
        match c {
            '/' if scan.peek(1) == Some('/') => scan.skip_while(|c| c != '\n'),
            '/' if scan.peek(1) == Some('*') => scan.skip_block_comment(),
            '"' => scan.skip_string(),
            '\'' => scan.skip_character_or_lifetime(),
            ':' if scan.peek(1) == Some(':') => {
                scan.skip(2);
                out.push((Token::Separator, line));
            }
            c if c.is_ascii_digit() => scan.skip_while(|c| c.is_alphanumeric() || c == '_'),
            c if c.is_alphabetic() || c == '_' => {
                let name = scan.name();
                match (name.as_str(), scan.peek(0), scan.peek(1)) {
                    ("b" | "c", Some('"'), _) => scan.skip_string(),
                    ("r" | "br" | "cr", Some('"'), _) | ("r" | "br" | "cr", Some('#'), Some('"' | '#')) => {
                        scan.skip_raw_string();
                    }
                    ("r", Some('#'), Some(c)) if c.is_alphabetic() || c == '_' => {
                        scan.skip(1);
                        out.push((Token::Name(scan.name()), line));
                    }
                    _ => out.push((Token::Name(name), line)),
                }
            }
            c => {
                scan.skip(1);
                if !c.is_whitespace() {
                    out.push((Token::Sign(c), line));
                }
            }
        }
    }
    out
}

struct Scan {
    text: Vec<char>,
    at: usize,
    line: usize,
}

impl Scan {
    fn peek(&self, ahead: usize) -> Option<char> {
        self.text.get(self.at + ahead).copied()
    }

    fn skip(&mut self, count: usize) {
        for _ in 0..count {
            if self.peek(0) == Some('\n') {
                self.line += 1;
            }
            self.at += 1;
        }
    }

    fn skip_while(&mut self, keep: impl Fn(char) -> bool) {
        while self.peek(0).is_some_and(&keep) {
            self.skip(1);
        }
    }

    fn name(&mut self) -> String {
        let begin = self.at;
        self.skip_while(|c| c.is_alphanumeric() || c == '_');
        self.text[begin..self.at].iter().collect()
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        loop {
            match (self.peek(0), self.peek(1)) {
                (Some('/'), Some('*')) => {
                    depth += 1;
                    self.skip(2);
                }
                (Some('*'), Some('/')) => {
                    depth -= 1;
                    self.skip(2);
                }
                (Some(_), _) => self.skip(1),
                (None, _) => return,
            }
            if depth == 0 {
                return;
            }
        }
    }

    /// From the opening quote past the closing one.
    fn skip_string(&mut self) {
        self.skip(1);
        while let Some(c) = self.peek(0) {
            self.skip(if c == '\\' { 2 } else { 1 });
            if c == '"' {
                return;
            }
        }
    }

    /// From the first `#` or the quote past the last `#`.
    fn skip_raw_string(&mut self) {
        let begin = self.at;
        self.skip_while(|c| c == '#');
        let hashes = self.at - begin;
        self.skip(1);
        while let Some(c) = self.peek(0) {
            let closes = c == '"' && (1..=hashes).all(|k| self.peek(k) == Some('#'));
            self.skip(1);
            if closes {
                self.skip(hashes);
                return;
            }
        }
    }

    fn skip_character_or_lifetime(&mut self) {
        match (self.peek(1), self.peek(2)) {
            (Some('\\'), _) => {
                self.skip(3);
                self.skip_while(|c| c != '\'');
                self.skip(1);
            }
            (Some(_), Some('\'')) => self.skip(3),
            _ => {
                self.skip(1);
                self.skip_while(|c| c.is_alphanumeric() || c == '_');
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(source: &str) -> Vec<(String, usize)> {
        let names = tokens(source).into_iter().filter_map(|(token, line)| match token {
            Token::Name(name) => Some((name, line)),
            _ => None,
        });
        names.collect()
    }

    #[test]
    fn comments_and_literals_are_no_names() {
        let source = r####"
            // a /* b
            /* c /* d */ " */ e
            "f \" g \\" h b"i" br#"j " k"# r"l\" m r##"n "# o"## c"p"
            'q' r '\'' s '\u{1F}' t '\\' u b'v' 'w: &'static 'λ' 1.0e5_f64 0xff x
        "####;
        let found: String = names(source).into_iter().map(|(name, _)| name).filter(|n| n.len() == 1).collect();
        assert_eq!(found, "ehmrstubx");
    }

    #[test]
    fn lines_and_raw_names() {
        let found = names("a\n/* \n */ b \"\n\" r#type\nc::d");
        let expected = [("a", 1), ("b", 3), ("type", 4), ("c", 5), ("d", 5)];
        assert_eq!(found, expected.map(|(name, line)| (name.to_string(), line)));
        assert!(tokens("c::d").contains(&(Token::Separator, 1)));
    }

    #[test]
    fn unfinished_source_ends() {
        for source in ["\"abc", "/* abc", "r#\"abc", "'\\", "'", "r#"] {
            tokens(source);
        }
    }
}
