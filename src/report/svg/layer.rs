//! Drawing of the layers of a panel.

use super::axis::Ruled;
use super::style::{Look, Marker, look};
use super::write::px;
use crate::figure::{Layer, Panel, Scale, Style};
use std::fmt::Write;

/// The rectangle of a pair of axes on paper, with its axes.
#[derive(Debug)]
pub struct Plot<'a> {
    /// Left edge, px.
    pub left: f64,
    /// Upper edge, px.
    pub top: f64,
    /// Width, px.
    pub width: f64,
    /// Height, px.
    pub height: f64,
    /// Abscissa.
    pub x: &'a Ruled,
    /// Ordinate.
    pub y: &'a Ruled,
}

impl Plot<'_> {
    pub(super) fn at_x(&self, v: f64) -> Option<f64> {
        self.x.place(v).map(|p| self.left + p * self.width)
    }

    pub(super) fn at_y(&self, v: f64) -> Option<f64> {
        self.y.place(v).map(|p| self.top + (1.0 - p) * self.height)
    }

    fn at_y_or_below(&self, v: f64) -> Option<f64> {
        self.y.place_or_below(v).map(|p| self.top + (1.0 - p) * self.height)
    }

    /// Position of a point on paper, `None` where it has none.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        Some((self.at_x(x)?, self.at_y(y)?))
    }

    /// Draws one layer; words are drawn last, by [`super::label::labels`].
    pub fn draw(&self, out: &mut String, layer: &Layer) {
        match layer {
            Layer::Line { points, style, .. } => self.line(out, points, look(*style)),
            Layer::Points { points, style, .. } => self.points(out, points, *style),
            Layer::Band { points, style, .. } => self.band(out, points, look(*style)),
            Layer::Bars { bars, style, .. } => self.bars(out, bars, look(*style)),
            Layer::Horizontal { at, style, .. } => {
                if let Some(y) = self.at_y(*at) {
                    let ends = [(self.left, y), (self.left + self.width, y)];
                    stroke(out, &path(&ends), look(*style));
                }
            }
            Layer::Span { from, to, style, .. } => self.span(out, *from, *to, look(*style)),
            Layer::Label { .. } => {}
        }
    }

    fn line(&self, out: &mut String, points: &[(f64, f64)], look: Look) {
        let mut d = String::new();
        let mut run: Vec<(f64, f64)> = vec![];
        let mut lone = String::new();
        let mut end = |run: &mut Vec<(f64, f64)>| {
            match run.as_slice() {
                [] => {}
                // A line of one point would not show at all.
                [one] => mark(&mut lone, *one, Look { marker: Marker::Disc, ..look }, 1.2),
                many => d.push_str(&path(many)),
            }
            run.clear();
        };
        for p in points {
            match self.at(*p) {
                Some(q) => run.push(q),
                None => end(&mut run),
            }
        }
        end(&mut run);
        if !d.is_empty() {
            stroke(out, &d, look);
        }
        out.push_str(&lone);
    }

    fn points(&self, out: &mut String, points: &[(f64, f64)], style: Style) {
        let places: Vec<(f64, f64)> = points.iter().filter_map(|p| self.at(*p)).collect();
        let size = match places.len() {
            0..=60 if matches!(style, Style::Reference | Style::Limit) => 5.0,
            0..=60 => 2.9,
            61..=400 => 1.9,
            _ => 1.1,
        };
        for place in places {
            mark(out, place, look(style), size);
        }
    }

    fn band(&self, out: &mut String, points: &[(f64, f64, f64)], look: Look) {
        let mut run: Vec<(f64, f64, f64)> = vec![];
        let mut end = |run: &mut Vec<(f64, f64, f64)>| {
            if run.len() > 1 {
                let mut edge: Vec<(f64, f64)> = run.iter().map(|p| (p.0, p.1)).collect();
                edge.extend(run.iter().rev().map(|p| (p.0, p.2)));
                let _ = writeln!(
                    out,
                    "<path d=\"{}Z\" fill=\"{}\" fill-opacity=\"{}\"/>",
                    path(&edge),
                    look.colour,
                    look.fill_opacity
                );
            }
            run.clear();
        };
        for (x, low, high) in points {
            match (self.at_x(*x), self.at_y_or_below(*low), self.at_y_or_below(*high)) {
                (Some(x), Some(low), Some(high)) => run.push((x, low, high)),
                _ => end(&mut run),
            }
        }
        end(&mut run);
    }

    fn bars(&self, out: &mut String, bars: &[(f64, f64, f64)], look: Look) {
        let floor = self.at_y_or_below(0.0).unwrap_or(self.top + self.height);
        let mut d = String::new();
        for (from, to, height) in bars {
            let (Some(a), Some(b), Some(h)) = (self.at_x(*from), self.at_x(*to), self.at_y_or_below(*height))
            else {
                continue;
            };
            let _ = write!(d, "M{} {}V{}H{}V{}Z", px(a), px(floor), px(h), px(b), px(floor));
        }
        if !d.is_empty() {
            let _ = writeln!(
                out,
                "<path d=\"{d}\" fill=\"{0}\" fill-opacity=\"{1}\" stroke=\"{0}\" stroke-width=\"0.6\"/>",
                look.colour,
                look.fill_opacity.max(0.3)
            );
        }
    }

    fn span(&self, out: &mut String, from: f64, to: f64, look: Look) {
        let (Some(a), Some(b)) = (self.at_x(from), self.at_x(to)) else { return };
        let (a, b) = (a.min(b).max(self.left), a.max(b).min(self.left + self.width));
        if b < self.left || a > self.left + self.width {
            return;
        }
        // A short gap in a long record is drawn wide enough to be seen.
        let b = b.max(a + 1.0);
        let _ = writeln!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>",
            px(a),
            px(self.top),
            px(b - a),
            px(self.height),
            look.colour,
            look.fill_opacity
        );
    }
}

/// The `d` of a path through points.
fn path(points: &[(f64, f64)]) -> String {
    let mut d = String::with_capacity(points.len() * 12);
    for (i, (x, y)) in points.iter().enumerate() {
        let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { "L" }, px(*x), px(*y));
    }
    d
}

fn stroke(out: &mut String, d: &str, look: Look) {
    let dash = dash(look);
    let _ = writeln!(
        out,
        "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}/>",
        look.colour, look.width
    );
}

/// The attribute for the dash pattern, empty for solid lines.
pub fn dash(look: Look) -> String {
    if look.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", look.dash) }
}

/// Draws one marker.
pub fn mark(out: &mut String, (x, y): (f64, f64), look: Look, r: f64) {
    let c = look.colour;
    let p = |dx: f64, dy: f64| format!("{} {}", px(x + dx), px(y + dy));
    let _ = match look.marker {
        Marker::Disc => writeln!(out, "<circle cx=\"{}\" cy=\"{}\" r=\"{r}\" fill=\"{c}\"/>", px(x), px(y)),
        Marker::Square => {
            writeln!(out, "<path d=\"M{}L{}L{}L{}Z\" fill=\"{c}\"/>", p(-r, -r), p(r, -r), p(r, r), p(-r, r))
        }
        Marker::Triangle => {
            writeln!(
                out,
                "<path d=\"M{}L{}L{}Z\" fill=\"{c}\"/>",
                p(0.0, -1.2 * r),
                p(1.1 * r, r),
                p(-1.1 * r, r)
            )
        }
        Marker::Diamond => writeln!(
            out,
            "<path d=\"M{}L{}L{}L{}Z\" fill=\"#fff\" stroke=\"{c}\" stroke-width=\"1.6\"/>",
            p(0.0, -r),
            p(r, 0.0),
            p(0.0, r),
            p(-r, 0.0)
        ),
        Marker::Ceiling => writeln!(
            out,
            "<path d=\"M{}L{}M{}L{}\" stroke=\"{c}\" stroke-width=\"2\"/>",
            p(-1.6 * r, 0.0),
            p(1.6 * r, 0.0),
            p(0.0, 0.0),
            p(0.0, 1.4 * r)
        ),
        Marker::Cross => writeln!(
            out,
            "<path d=\"M{}L{}M{}L{}\" stroke=\"{c}\" stroke-width=\"1.5\"/>",
            p(-r, -r),
            p(r, r),
            p(-r, r),
            p(r, -r)
        ),
    };
}

/// Extent of the data of panels along one axis.
///
/// Bands, and on a logarithmic axis terms, follow the data rather than stretch the axis: on a logarithmic axis they are
/// given half a decade of room, and more only when there is nothing else to show.
pub fn extent(panels: &[&Panel], scale: Scale, ordinate: bool) -> Option<(f64, f64)> {
    let fits = |v: &f64| v.is_finite() && (scale != Scale::Log || *v > 0.0);
    let mut main: Option<(f64, f64)> = None;
    let mut side: Option<(f64, f64)> = None;
    let grow = |range: &mut Option<(f64, f64)>, v: f64| {
        if fits(&v) {
            *range = Some(range.map_or((v, v), |(a, b)| (a.min(v), b.max(v))));
        }
    };
    for layer in panels.iter().flat_map(|p| &p.layers) {
        match layer {
            Layer::Line { points, style, .. } | Layer::Points { points, style, .. } => {
                let follows =
                    scale == Scale::Log && matches!(style, Style::Term(_) | Style::UnresolvedTerm(_));
                let range = if follows { &mut side } else { &mut main };
                points.iter().filter(|p| !p.0.is_nan() && !p.1.is_nan()).for_each(|p| {
                    grow(range, if ordinate { p.1 } else { p.0 });
                });
            }
            Layer::Band { points, .. } => {
                for (x, low, high) in points {
                    if ordinate {
                        grow(&mut side, *low);
                        grow(&mut side, *high);
                    } else {
                        grow(&mut side, *x);
                    }
                }
            }
            Layer::Bars { bars, .. } => {
                for (from, to, height) in bars {
                    if ordinate {
                        grow(&mut main, 0.0);
                        grow(&mut main, *height);
                    } else {
                        grow(&mut main, *from);
                        grow(&mut main, *to);
                    }
                }
            }
            Layer::Horizontal { at, .. } if ordinate => grow(&mut main, *at),
            Layer::Span { from, to, .. } if !ordinate => {
                grow(&mut side, *from);
                grow(&mut side, *to);
            }
            _ => {}
        }
    }
    match (main, side) {
        (Some((a, b)), Some((c, d))) if ordinate && scale == Scale::Log => {
            let room = 10f64.sqrt();
            Some((a.min(c.max(a / room)), b.max(d.min(b * room))))
        }
        (Some((a, b)), Some((c, d))) if ordinate => {
            let room = 0.35 * (b - a);
            if room > 0.0 && room.is_finite() {
                Some((a.min(c.max(a - room)), b.max(d.min(b + room))))
            } else {
                Some((a.min(c), b.max(d)))
            }
        }
        (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
        (a, b) => a.or(b),
    }
}
