//! The Python literal in the header of a NumPy array: a dictionary of texts, numbers, truth values, tuples and lists.

/// Deepest nesting that is followed.
const DEEPEST: usize = 16;

/// A Python literal.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Whole(u64),
    Truth(bool),
    None,
    /// A tuple or a list.
    List(Vec<Literal>),
    Dictionary(Vec<(Literal, Literal)>),
}

impl Literal {
    pub fn text(&self) -> Option<&str> {
        match self {
            Literal::Text(text) => Some(text),
            _ => None,
        }
    }

    pub fn list(&self) -> Option<&[Literal]> {
        match self {
            Literal::List(items) => Some(items),
            _ => None,
        }
    }

    pub fn whole(&self) -> Option<u64> {
        match self {
            Literal::Whole(n) => Some(*n),
            _ => None,
        }
    }

    /// The value of a key of a dictionary.
    pub fn get(&self, key: &str) -> Option<&Literal> {
        match self {
            Literal::Dictionary(items) => {
                items.iter().find(|(k, _)| k.text() == Some(key)).map(|(_, value)| value)
            }
            _ => None,
        }
    }
}

/// Reads a literal that fills a text; an error is the byte where it stops making sense.
pub(super) fn parse(text: &str) -> Result<Literal, usize> {
    let mut parser = Parser { bytes: text.as_bytes(), text, at: 0 };
    let value = parser.value(0)?;
    parser.blank();
    if parser.at == text.len() { Ok(value) } else { Err(parser.at) }
}

struct Parser<'t> {
    bytes: &'t [u8],
    text: &'t str,
    at: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn blank(&mut self) {
        while self.peek().is_some_and(|b| b.is_ascii_whitespace()) {
            self.at += 1;
        }
    }

    fn takes(&mut self, byte: u8) -> bool {
        self.blank();
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn value(&mut self, depth: usize) -> Result<Literal, usize> {
        self.blank();
        if depth > DEEPEST {
            return Err(self.at);
        }
        match self.peek() {
            Some(b'{') => self.dictionary(depth),
            Some(b'(') => self.list(b')', depth),
            Some(b'[') => self.list(b']', depth),
            Some(b'\'' | b'"') => self.string().map(Literal::Text),
            Some(b'0'..=b'9') => self.number(),
            Some(b'u' | b'b') if matches!(self.bytes.get(self.at + 1), Some(b'\'' | b'"')) => {
                self.at += 1;
                self.string().map(Literal::Text)
            }
            _ => self.word(),
        }
    }

    fn dictionary(&mut self, depth: usize) -> Result<Literal, usize> {
        self.at += 1;
        let mut items = Vec::new();
        loop {
            if self.takes(b'}') {
                return Ok(Literal::Dictionary(items));
            }
            let key = self.value(depth + 1)?;
            if !self.takes(b':') {
                return Err(self.at);
            }
            items.push((key, self.value(depth + 1)?));
            if !self.takes(b',') {
                return if self.takes(b'}') { Ok(Literal::Dictionary(items)) } else { Err(self.at) };
            }
        }
    }

    fn list(&mut self, close: u8, depth: usize) -> Result<Literal, usize> {
        self.at += 1;
        let mut items = Vec::new();
        loop {
            if self.takes(close) {
                return Ok(Literal::List(items));
            }
            items.push(self.value(depth + 1)?);
            if !self.takes(b',') {
                // One value in round brackets without a comma is the value itself.
                return match (self.takes(close), close, items.pop()) {
                    (true, b')', Some(only)) if items.is_empty() => Ok(only),
                    (true, _, last) => {
                        items.extend(last);
                        Ok(Literal::List(items))
                    }
                    (false, ..) => Err(self.at),
                };
            }
        }
    }

    fn string(&mut self) -> Result<String, usize> {
        let quote = self.peek().unwrap_or(b'\'');
        self.at += 1;
        let start = self.at;
        let mut out = String::new();
        for (i, c) in self.text.get(start..).unwrap_or_default().char_indices() {
            let escaped = out.ends_with('\\');
            if c.is_ascii() && c as u8 == quote && !escaped {
                self.at = start + i + 1;
                return Ok(out);
            }
            if escaped && (c == '\'' || c == '"' || c == '\\') {
                out.pop();
            }
            out.push(c);
        }
        Err(start)
    }

    fn number(&mut self) -> Result<Literal, usize> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_digit()) {
            self.at += 1;
        }
        let number = self.text.get(start..self.at).and_then(|t| t.parse().ok());
        // Python 2 wrote long integers as `3L`.
        self.at += usize::from(self.peek() == Some(b'L'));
        number.map(Literal::Whole).ok_or(start)
    }

    fn word(&mut self) -> Result<Literal, usize> {
        for (word, value) in
            [("True", Literal::Truth(true)), ("False", Literal::Truth(false)), ("None", Literal::None)]
        {
            if self.text.get(self.at..).is_some_and(|rest| rest.starts_with(word)) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read() {
        let header = parse("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }  \n").unwrap();
        assert_eq!(header.get("descr").and_then(Literal::text), Some("<f8"));
        assert_eq!(header.get("fortran_order"), Some(&Literal::Truth(false)));
        let shape = header.get("shape").and_then(Literal::list).unwrap();
        assert_eq!(shape, [Literal::Whole(3), Literal::Whole(4)]);
        let list = parse("[('a b', '<f8'), (('title', \"it's\"), '|u1', (3,)), (5L), ()]").unwrap();
        let items = list.list().unwrap();
        assert_eq!(items[0].list().unwrap()[0], Literal::Text("a b".into()));
        assert_eq!(items[1].list().unwrap()[2], Literal::List(vec![Literal::Whole(3)]));
        assert_eq!((&items[2], &items[3]), (&Literal::Whole(5), &Literal::List(vec![])));
    }

    #[test]
    fn what_is_no_literal_is_refused_at_its_place() {
        for (text, at) in [
            ("", 0),
            ("{'a' 1}", 5),
            ("{'a': }", 6),
            ("'open", 1),
            ("(1, 2", 5),
            ("(1) x", 4),
            ("99999999999999999999999", 0),
            ("__import__('os')", 0),
        ] {
            assert_eq!(parse(text), Err(at), "{text}");
        }
        assert!(parse(&"[".repeat(100_000)).is_err());
    }
}
