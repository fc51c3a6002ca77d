//! Legends: above the axes, in rows, where they cover nothing.

use super::layer::{dash, mark};
use super::style::look;
use super::write::{Anchor, cut, px, text, width};
use crate::figure::{Layer, Panel, Style};
use std::fmt::Write;

const SIZE: f64 = 11.0;
const SWATCH: f64 = 26.0;
const ROW: f64 = 17.0;
const GAP: f64 = 16.0;

/// What an entry shows beside its words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Shown {
    line: bool,
    points: bool,
    area: bool,
}

/// A legend laid out in rows.
#[derive(Debug)]
pub struct Legend {
    rows: Vec<Vec<(f64, Entry)>>,
}

#[derive(Debug, Clone)]
struct Entry {
    words: String,
    style: Style,
    shown: Shown,
}

impl Legend {
    /// Collects the entries of a panel and lays them out in the given width. Layers with the same words and the same
    /// part are one entry.
    pub fn new(panel: &Panel, room: f64, say: impl Fn(&str) -> String) -> Legend {
        let mut entries: Vec<Entry> = vec![];
        for layer in &panel.layers {
            let (legend, style, shown) = match layer {
                Layer::Line { legend, style, .. } | Layer::Horizontal { legend, style, .. } => {
                    (legend, *style, Shown { line: true, ..Shown::default() })
                }
                Layer::Points { legend, style, .. } => {
                    (legend, *style, Shown { points: true, ..Shown::default() })
                }
                Layer::Band { legend, style, .. }
                | Layer::Bars { legend, style, .. }
                | Layer::Span { legend, style, .. } => {
                    (legend, *style, Shown { area: true, ..Shown::default() })
                }
                Layer::Label { .. } => continue,
            };
            if legend.is_empty() {
                continue;
            }
            let words = cut(&say(legend), SIZE, room - SWATCH - 8.0);
            match entries.iter_mut().find(|e| e.words == words && e.style == style) {
                Some(known) => {
                    known.shown.line |= shown.line;
                    known.shown.points |= shown.points;
                    known.shown.area |= shown.area;
                }
                None => entries.push(Entry { words, style, shown }),
            }
        }
        let mut rows: Vec<Vec<(f64, Entry)>> = vec![];
        let mut x = f64::INFINITY;
        for entry in entries {
            let size = SWATCH + 6.0 + width(&entry.words, SIZE);
            if x + size > room {
                rows.push(vec![]);
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, entry));
            }
            x += size + GAP;
        }
        Legend { rows }
    }

    /// Height it takes, px.
    pub fn height(&self) -> f64 {
        self.rows.len() as f64 * ROW + if self.rows.is_empty() { 0.0 } else { 4.0 }
    }

    /// The words of all entries.
    pub fn words(&self) -> Vec<&str> {
        self.rows.iter().flatten().map(|(_, e)| e.words.as_str()).collect()
    }

    /// Draws it with its upper left corner at a point.
    pub fn draw(&self, out: &mut String, left: f64, top: f64) {
        for (i, row) in self.rows.iter().enumerate() {
            let middle = top + (i as f64 + 0.5) * ROW;
            for (x, entry) in row {
                let look = look(entry.style);
                let (a, b) = (left + x, left + x + SWATCH);
                if entry.shown.area {
                    let _ = writeln!(
                        out,
                        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"10\" fill=\"{3}\" fill-opacity=\"{4}\" \
                         stroke=\"{3}\" stroke-opacity=\"0.5\" stroke-width=\"0.6\"/>",
                        px(a),
                        px(middle - 5.0),
                        px(SWATCH),
                        look.colour,
                        look.fill_opacity.max(0.22),
                    );
                }
                if entry.shown.line {
                    let _ = writeln!(
                        out,
                        "<path d=\"M{} {}H{}\" stroke=\"{}\" stroke-width=\"{}\"{}/>",
                        px(a),
                        px(middle),
                        px(b),
                        look.colour,
                        look.width,
                        dash(look)
                    );
                }
                if entry.shown.points {
                    let size = if matches!(entry.style, Style::Reference | Style::Limit) { 5.0 } else { 2.9 };
                    mark(out, (0.5 * (a + b), middle), look, size);
                }
                text(out, (b + 6.0, middle + 3.8), Anchor::Start, SIZE, "", &entry.words);
            }
        }
    }
}
