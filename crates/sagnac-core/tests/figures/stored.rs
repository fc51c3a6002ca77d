//! Figures as text, and their comparison with those that are stored beside the tests.
//!
//! A value is written as its `Debug` text, floats to nine digits. A list of many numbers, or of many alike items, is written by
//! its count and, for each number, the first value, the mean, the root mean square, a mean with weights that tell the order, and
//! the last value.

use std::fmt::Debug;
use std::path::Path;

/// Relative difference of two floats that are the same figure: far above rounding, far below what a changed formula does.
const TOLERANCE: f64 = 1e-6;
/// Difference that is rounding whatever the figure.
const FLOOR: f64 = 1e-12;
/// Items of a list that are written one by one.
const SHORT: usize = 6;
/// Columns of a line.
const WIDTH: usize = 124;

/// Named figures of one room.
#[derive(Default)]
pub struct Figures {
    blocks: Vec<(String, String)>,
}

impl Figures {
    /// Adds what a computation gave.
    pub fn add(&mut self, name: impl Into<String>, value: &dyn Debug) {
        let text = format!("{value:?}");
        let mut characters = text.chars().peekable();
        let items = read_list(&mut characters, None);
        let mut out = String::new();
        for item in &items {
            lay_out(item, 4, &mut out);
        }
        self.blocks.push((name.into(), out));
    }

    /// Compares with the stored figures, or stores them where `SAGNAC_WRITE_FIGURES` is set.
    pub fn check(self, file: &str) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/figures").join(file);
        if std::env::var_os("SAGNAC_WRITE_FIGURES").is_some() {
            let text: String = self.blocks.iter().map(|(name, block)| format!("{name}\n{block}")).collect();
            std::fs::write(&path, text).unwrap();
        }
        let stored = read_blocks(&std::fs::read_to_string(&path).unwrap());
        let names = |blocks: &[(String, String)]| blocks.iter().map(|b| b.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&self.blocks), names(&stored), "{file} has other figures");
        let wrong: Vec<String> = self.blocks.iter().zip(&stored).filter_map(|(a, b)| differs(a, b)).collect();
        assert!(wrong.is_empty(), "{} figures of {file} are others:\n{}", wrong.len(), wrong.join("\n"));
        assert!(stored.len() > 9, "{file} holds only {} figures", stored.len());
    }
}

/// The first difference of a figure from the stored one, with what stands before it.
fn differs((name, now): &(String, String), (_, stored): &(String, String)) -> Option<String> {
    let (now, stored) = (words(now), words(stored));
    let same = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(x), Ok(y)) if a.contains(['.', 'e']) && b.contains(['.', 'e']) => {
            (x - y).abs() <= TOLERANCE * x.abs().max(y.abs()) + FLOOR
        }
        _ => a == b,
    };
    let at = now.iter().zip(&stored).position(|(a, b)| !same(a, b));
    let at = at.or((now.len() != stored.len()).then_some(now.len().min(stored.len())))?;
    let part = |words: &[String]| words.get(at).cloned().unwrap_or_default();
    let before = now[at.saturating_sub(12)..at].join(" ");
    Some(format!("{name}: {before} ► {} in place of {}", part(&now), part(&stored)))
}

/// A text in numbers, names and marks; the ends of lines do not count.
fn words(text: &str) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    let mut open = false;
    for c in text.chars() {
        if c.is_whitespace() {
            open = false;
        } else if c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+') {
            match out.last_mut() {
                Some(word) if open => word.push(c),
                _ => out.push(c.to_string()),
            }
            open = true;
        } else {
            out.push(c.to_string());
            open = false;
        }
    }
    out
}

fn read_blocks(text: &str) -> Vec<(String, String)> {
    let mut blocks: Vec<(String, String)> = vec![];
    for line in text.lines() {
        match blocks.last_mut() {
            Some((_, block)) if line.starts_with(' ') => {
                block.push_str(line);
                block.push('\n');
            }
            _ => blocks.push((line.to_owned(), String::new())),
        }
    }
    blocks
}

/// A piece of a `Debug` text.
#[derive(Clone)]
enum Piece {
    Text(String),
    Number(f64),
    Count(i64),
    Group(char, Vec<Item>, char),
}

type Item = Vec<Piece>;

/// Reads items between commas, up to the closing mark.
fn read_list(from: &mut std::iter::Peekable<std::str::Chars<'_>>, close: Option<char>) -> Vec<Item> {
    let (mut items, mut item, mut text): (Vec<Item>, Item, String) = (vec![], vec![], String::new());
    let finish = |text: &mut String, item: &mut Item| {
        let word = text.trim();
        // The last word may be a float behind the name of its field.
        let (name, last) = word.rsplit_once(' ').map_or(("", word), |(n, l)| (n, l));
        let float = last.contains(['.', 'e']).then(|| last.parse::<f64>().ok()).flatten();
        let count = last.parse::<i64>().ok().map(Piece::Count);
        match float.filter(|x| x.is_finite()).map(Piece::Number).or(count) {
            Some(number) => {
                if !name.is_empty() {
                    item.push(Piece::Text(format!("{name} ")));
                }
                item.push(number);
            }
            None if !word.is_empty() => item.push(Piece::Text(format!("{word} "))),
            None => {}
        }
        text.clear();
    };
    while let Some(c) = from.next() {
        match c {
            '"' => {
                text.push(c);
                while let Some(c) = from.next() {
                    text.push(c);
                    if c == '\\' {
                        text.extend(from.next());
                    } else if c == '"' {
                        break;
                    }
                }
            }
            '(' | '[' | '{' => {
                finish(&mut text, &mut item);
                let end = match c {
                    '(' => ')',
                    '[' => ']',
                    _ => '}',
                };
                item.push(Piece::Group(c, read_list(from, Some(end)), end));
            }
            ',' => {
                finish(&mut text, &mut item);
                items.push(std::mem::take(&mut item));
            }
            _ if Some(c) == close => break,
            _ => text.push(c),
        }
    }
    finish(&mut text, &mut item);
    if !item.is_empty() {
        items.push(item);
    }
    items
}

fn digits(x: f64) -> String {
    if x.abs() < 1e-14 {
        return "0.0".to_owned();
    }
    format!("{:?}", format!("{x:.8e}").parse::<f64>().unwrap_or(x))
}

/// The text of an item without its numbers, and the numbers.
fn shape_of(item: &Item, shape: &mut String, numbers: &mut Vec<f64>) {
    for piece in item {
        match piece {
            Piece::Text(text) => shape.push_str(text),
            Piece::Number(x) => {
                shape.push('#');
                numbers.push(*x);
            }
            Piece::Count(x) => {
                shape.push('#');
                numbers.push(*x as f64);
            }
            Piece::Group(open, items, close) => {
                shape.push(*open);
                for inner in condensed(*open, items) {
                    shape_of(&inner, shape, numbers);
                    shape.push_str(", ");
                }
                shape.push(*close);
            }
        }
    }
}

/// A long list by its alike items; a short one, a tuple or the fields of a struct as they are.
fn condensed(open: char, items: &[Item]) -> Vec<Item> {
    if items.len() <= SHORT || open != '[' {
        return items.to_vec();
    }
    let mut kinds: Vec<(String, Vec<Vec<f64>>)> = vec![];
    for item in items {
        let (mut shape, mut numbers) = (String::new(), vec![]);
        shape_of(item, &mut shape, &mut numbers);
        match kinds.iter_mut().find(|k| k.0 == shape) {
            Some((_, rows)) => rows.push(numbers),
            None => kinds.push((shape, vec![numbers])),
        }
    }
    let of_kind = |(shape, rows): &(String, Vec<Vec<f64>>)| {
        let mut out = format!("{} × ", rows.len());
        let mut parts = shape.split('#');
        out.push_str(parts.next().unwrap_or_default());
        for (at, rest) in parts.enumerate() {
            let column: Vec<f64> = rows.iter().filter_map(|r| r.get(at).copied()).collect();
            out.push_str(&summary(&column));
            out.push_str(rest);
        }
        vec![Piece::Text(out)]
    };
    kinds.iter().map(of_kind).collect()
}

fn summary(column: &[f64]) -> String {
    let n = column.len() as f64;
    let rms = (column.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
    let mean = column.iter().sum::<f64>() / n;
    let weight = |i: usize| (0.618_033_988_75 * (i + 1) as f64).fract() + 0.1 * (i as f64 / n);
    let ordered = column.iter().enumerate().map(|(i, x)| weight(i) * x).sum::<f64>() / n;
    // What cancels is rounding.
    let real = |x: f64| if x.abs() < 1e-9 * rms { 0.0 } else { x };
    let (first, last) = (column.first().copied().unwrap_or(0.0), column.last().copied().unwrap_or(0.0));
    let all = [first, mean, rms, ordered, last].map(|x| digits(real(x)));
    format!("<{}>", all.join(" "))
}

fn on_one_line(item: &Item) -> String {
    let mut out = String::new();
    for piece in item {
        match piece {
            Piece::Text(text) => out.push_str(text),
            Piece::Number(x) => out.push_str(&digits(*x)),
            Piece::Count(x) => out.push_str(&x.to_string()),
            Piece::Group(open, items, close) => {
                let inner: Vec<String> =
                    condensed(*open, items).iter().map(|i| on_one_line(i).trim_end().to_owned()).collect();
                out.push_str(&format!("{open}{}{close}", inner.join(", ")));
            }
        }
    }
    out
}

/// Writes an item in one line, or its groups line by line where that is too long.
fn lay_out(item: &Item, indent: usize, out: &mut String) {
    let line = on_one_line(item);
    let margin = " ".repeat(indent);
    if indent + line.chars().count() <= WIDTH || !item.iter().any(|p| matches!(p, Piece::Group(..))) {
        out.push_str(&format!("{margin}{}\n", line.trim_end()));
        return;
    }
    out.push_str(&margin);
    for piece in item {
        match piece {
            Piece::Text(text) => out.push_str(text),
            Piece::Number(x) => out.push_str(&digits(*x)),
            Piece::Count(x) => out.push_str(&x.to_string()),
            Piece::Group(open, items, close) => {
                out.push_str(&format!("{open}\n"));
                condensed(*open, items).iter().for_each(|i| lay_out(i, indent + 2, out));
                out.push_str(&format!("{margin}{close}"));
            }
        }
    }
    out.push('\n');
}

#[test]
fn figures_are_the_same_up_to_rounding_and_no_further() {
    let block = |value: &dyn Debug| {
        let mut figures = Figures::default();
        figures.add("f", value);
        figures.blocks.remove(0)
    };
    let series = |last: f64| (0..20).map(|i| if i == 19 { last } else { f64::from(i) }).collect::<Vec<f64>>();
    assert_eq!(differs(&block(&series(1.0)), &block(&series(1.0 + 1e-9))), None);
    for (a, b) in [(1.0, 1.00001), (1.0, -1.0), (1.0, f64::NAN)] {
        assert!(differs(&block(&(0.1, a)), &block(&(0.1, b))).is_some());
        assert!(differs(&block(&series(a)), &block(&series(b))).is_some());
    }
    let (mut turned, straight) = (series(19.0), series(19.0));
    turned.swap(7, 8);
    assert!(differs(&block(&turned), &block(&straight)).is_some(), "the order counts");
    assert!(differs(&block(&(3usize, "a")), &block(&(4usize, "a"))).is_some());
    assert!(differs(&block(&Some("a, b")), &block(&Some("a, c"))).is_some());
    assert!(differs(&block(&vec![1.0; 3]), &block(&vec![1.0; 4])).is_some());
}
