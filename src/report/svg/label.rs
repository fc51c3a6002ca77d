//! Words at points of a panel, placed where they cover no curve, no mark and no other word.

use super::layer::Plot;
use super::write::{Anchor, px, text, width};
use crate::figure::{Layer, Panel};
use crate::i18n::Lang;
use crate::report::translator::Translator;
use std::f64::consts::PI;
use std::fmt::Write;

const SIZE: f64 = 11.0;
/// Clear space that words keep from what is drawn, px.
const CLEAR: f64 = 2.5;
/// Distances from the point that are tried, px; the nearest free place is taken.
const DISTANCES: [f64; 9] = [6.0, 10.0, 16.0, 24.0, 34.0, 46.0, 60.0, 78.0, 100.0];
/// Directions that are tried at each distance, in sixteenths of a turn: above first, then below, then beside.
const DIRECTIONS: [u8; 16] = [2, 6, 14, 10, 4, 12, 0, 8, 1, 3, 5, 7, 9, 11, 13, 15];
/// Distance from which a thin line leads from the words to their point, px.
const LED: f64 = 20.0;

/// An upright rectangle on paper.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rect {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Rect {
    fn grown(self, by: f64) -> Rect {
        Rect {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2.0 * by,
            height: self.height + 2.0 * by,
        }
    }

    fn contains(&self, (x, y): (f64, f64)) -> bool {
        x >= self.left && x <= self.left + self.width && y >= self.top && y <= self.top + self.height
    }

    fn overlaps(&self, other: &Rect) -> bool {
        self.left < other.left + other.width
            && other.left < self.left + self.width
            && self.top < other.top + other.height
            && other.top < self.top + self.height
    }

    /// True where a straight stroke touches it (Liang and Barsky).
    fn is_crossed(&self, (a, b): ((f64, f64), (f64, f64))) -> bool {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (p, q) in [
            (-dx, a.0 - self.left),
            (dx, self.left + self.width - a.0),
            (-dy, a.1 - self.top),
            (dy, self.top + self.height - a.1),
        ] {
            if p == 0.0 {
                if q < 0.0 {
                    return false;
                }
            } else if p < 0.0 {
                from = from.max(q / p);
            } else {
                to = to.min(q / p);
            }
        }
        from <= to
    }

    /// The point of its edge that is nearest to a point outside.
    fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (x.clamp(self.left, self.left + self.width), y.clamp(self.top, self.top + self.height))
    }
}

/// What words must not cover: strokes and marks, in px.
struct Drawn {
    strokes: Vec<((f64, f64), (f64, f64))>,
    marks: Vec<(f64, f64)>,
}

impl Drawn {
    fn of(plot: &Plot<'_>, panel: &Panel) -> Drawn {
        let mut drawn = Drawn { strokes: vec![], marks: vec![] };
        for layer in &panel.layers {
            match layer {
                Layer::Line { points, .. } => {
                    let places: Vec<Option<(f64, f64)>> = points.iter().map(|p| plot.at(*p)).collect();
                    let ends = places.windows(2).filter_map(|w| w[0].zip(w[1]));
                    drawn.strokes.extend(ends);
                }
                Layer::Points { points, .. } => {
                    drawn.marks.extend(points.iter().filter_map(|p| plot.at(*p)));
                }
                Layer::Horizontal { at, .. } => {
                    let right = plot.left + plot.width;
                    drawn.strokes.extend(plot.at_y(*at).map(|y| ((plot.left, y), (right, y))));
                }
                Layer::Bars { bars, .. } => {
                    let top = |b: &(f64, f64, f64)| {
                        let y = plot.at_y(b.2)?;
                        Some(((plot.at_x(b.0)?, y), (plot.at_x(b.1)?, y)))
                    };
                    drawn.strokes.extend(bars.iter().filter_map(top));
                }
                Layer::Band { .. } | Layer::Span { .. } | Layer::Label { .. } => {}
            }
        }
        drawn
    }

    fn is_covered_by(&self, place: &Rect) -> bool {
        self.marks.iter().any(|m| place.grown(3.0).contains(*m))
            || self.strokes.iter().any(|s| place.is_crossed(*s))
    }
}

/// Draws the words of a panel. Words for which no place is free are left out: a table has their number.
pub fn labels(out: &mut String, plot: &Plot<'_>, panel: &Panel, lang: Lang) {
    let words = Translator { lang };
    let frame = Rect { left: plot.left, top: plot.top, width: plot.width, height: plot.height }.grown(-3.0);
    let drawn = Drawn::of(plot, panel);
    let mut taken: Vec<Rect> = vec![];
    let mut leads: Vec<((f64, f64), (f64, f64))> = vec![];
    for layer in &panel.layers {
        let Layer::Label { at, text: said } = layer else { continue };
        let Some(point) = plot.at(*at).filter(|_| plot.x.holds(at.0) && plot.y.holds(at.1)) else { continue };
        let said = words.say(said);
        let size = (width(&said, SIZE), SIZE + 2.0);
        // The line that leads from the point to far words.
        let lead =
            |place: &Rect, distance: f64| (distance >= LED).then(|| (point, place.grown(1.0).nearest(point)));
        let free = |(place, distance): &(Rect, f64)| {
            let clear = place.grown(CLEAR);
            frame.contains((place.left, place.top))
                && frame.contains((place.left + place.width, place.top + place.height))
                && !taken.iter().any(|t| t.overlaps(&clear))
                && !leads.iter().any(|l| clear.is_crossed(*l))
                && !lead(place, *distance).is_some_and(|l| taken.iter().any(|t| t.is_crossed(l)))
                && !drawn.is_covered_by(&clear)
        };
        let Some((place, distance)) = places(point, size).find(free) else { continue };
        if let Some((point, (x, y))) = lead(&place, distance) {
            leads.push((point, (x, y)));
            let _ = writeln!(
                out,
                "<path d=\"M{} {}L{} {}\" stroke=\"#777\" stroke-width=\"0.7\" fill=\"none\"/>",
                px(point.0),
                px(point.1),
                px(x),
                px(y)
            );
        }
        taken.push(place);
        let look = " fill=\"#111\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\" stroke-linejoin=\"round\"";
        text(out, (place.left, place.top + SIZE - 1.0), Anchor::Start, SIZE, look, &said);
    }
}

/// The places about a point that are tried, nearest first, each with its distance.
fn places((x, y): (f64, f64), (w, h): (f64, f64)) -> impl Iterator<Item = (Rect, f64)> {
    DISTANCES.into_iter().flat_map(move |d| {
        DIRECTIONS.into_iter().map(move |sixteenth| {
            let (sin, cos) = (f64::from(sixteenth) * PI / 8.0).sin_cos();
            let left = x + d * cos + 0.5 * w * (cos - 1.0);
            let top = y - d * sin - 0.5 * h * (sin + 1.0);
            (Rect { left, top, width: w, height: h }, d)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Figure, Scale, Style};
    use crate::i18n::note;
    use crate::report::svg::render;

    const BOX: Rect = Rect { left: 10.0, top: 10.0, width: 20.0, height: 10.0 };

    #[test]
    fn a_stroke_touches_a_rectangle_or_passes_it() {
        for crossing in
            [((0.0, 0.0), (40.0, 40.0)), ((15.0, 12.0), (16.0, 13.0)), ((20.0, 0.0), (20.0, 40.0))]
        {
            assert!(BOX.is_crossed(crossing), "{crossing:?}");
        }
        for passing in [((0.0, 0.0), (9.0, 40.0)), ((0.0, 25.0), (40.0, 25.0)), ((0.0, 15.0), (15.0, 30.0))] {
            assert!(!BOX.is_crossed(passing), "{passing:?}");
        }
    }

    fn figure(layers: Vec<Layer>) -> Figure {
        let axis = |range| Axis {
            label: "axis.time".into(),
            unit: String::new(),
            scale: Scale::Linear,
            range: Some(range),
        };
        Figure {
            id: "f".into(),
            title: "t".into(),
            channel: String::new(),
            panels: vec![crate::figure::Panel { x: axis((0.0, 10.0)), y: axis((-1.0, 1.0)), layers }],
            remarks: vec![],
        }
    }

    fn wave(length: f64) -> Layer {
        let points = (0..=2000).map(|i| f64::from(i) / 200.0).map(|x| (x, (x / length).sin())).collect();
        Layer::Line { points, style: Style::Data, legend: String::new() }
    }

    fn label() -> Layer {
        Layer::Label { at: (5.0, 0.0), text: note!("figure_label.line", frequency = 1.5) }
    }

    #[test]
    fn words_stand_beside_a_curve_and_not_on_it() {
        let svg = render(&figure(vec![wave(0.4), label()]), Lang::En);
        let line = svg.lines().find(|l| l.contains("1.5\u{202f}Hz") || l.contains("1.5 Hz")).unwrap();
        let number = |name: &str| -> f64 {
            line.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let size = (width("1.5 Hz", SIZE), SIZE + 2.0);
        let place = Rect { left: number("x"), top: number("y") - SIZE + 1.0, width: size.0, height: size.1 };
        let d = svg.lines().find(|l| l.contains("#0072b2")).unwrap().split('"').nth(1).unwrap().to_owned();
        let points: Vec<(f64, f64)> = d[1..]
            .split('L')
            .map(|p| p.split_once(' ').unwrap())
            .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
            .collect();
        assert!(points.len() > 1500);
        assert!(!points.windows(2).any(|w| place.is_crossed((w[0], w[1]))), "{place:?}");
    }

    #[test]
    fn a_leading_line_crosses_no_words() {
        // Labels at one point push each other away, farther than a line is needed.
        let svg = render(&figure((0..14).map(|_| label()).collect()), Lang::En);
        let number = |line: &str, name: &str| -> f64 {
            line.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let size = (width("1.5 Hz", SIZE), SIZE + 2.0);
        let words = svg.lines().filter(|l| l.contains("1.5\u{202f}Hz") || l.contains("1.5 Hz"));
        let places: Vec<Rect> = words
            .map(|l| Rect {
                left: number(l, "x"),
                top: number(l, "y") - SIZE + 1.0,
                width: size.0,
                height: size.1,
            })
            .collect();
        let strokes: Vec<((f64, f64), (f64, f64))> = svg
            .lines()
            .filter(|l| l.contains("#777") && l.contains("stroke-width=\"0.7\""))
            .map(|l| {
                let d = l.split('"').nth(1).unwrap().trim_start_matches('M').replace('L', " ");
                let p: Vec<f64> = d.split(' ').map(|v| v.parse().unwrap()).collect();
                ((p[0], p[1]), (p[2], p[3]))
            })
            .collect();
        assert!(places.len() > 4 && !strokes.is_empty(), "{} words, {} lines", places.len(), strokes.len());
        for place in &places {
            assert!(!strokes.iter().any(|s| place.grown(-0.5).is_crossed(*s)), "{place:?}");
        }
    }

    #[test]
    fn words_without_a_free_place_are_left_out() {
        // A curve that fills the panel leaves no room.
        assert!(!render(&figure(vec![wave(0.004), label()]), Lang::En).contains("1.5 Hz"));
    }
}
