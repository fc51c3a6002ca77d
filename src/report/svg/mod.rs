//! Figures as SVG: self-contained, deterministic, with title and description for those who do not see them, colours
//! and dashes for the colour-blind and for print without colour.

mod axis;
mod label;
mod layer;
mod layout;
mod legend;
mod pointer;
mod style;
mod write;

use crate::figure::{Figure, Panel};
use crate::i18n::{Lang, lookup};
use layer::Plot;
pub use layout::Canvas;
use layout::{Layout, ends_abscissa};
pub(crate) use pointer::readings;
use std::fmt::Write;
pub(crate) use write::escape;
use write::{Anchor, FONT, px, text, width};

/// A figure as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// The drawing.
    pub svg: String,
    /// Width and height on paper, mm.
    pub size_mm: (f64, f64),
}

/// Draws a figure for a page.
pub fn render(figure: &Figure, lang: Lang) -> String {
    draw(figure, Canvas::Page, lang).svg
}

/// Draws a figure.
///
/// Data that cannot be drawn (nothing, one point, a constant, NaN, values without a logarithm) gives axes without it.
pub fn draw(figure: &Figure, canvas: Canvas, lang: Lang) -> Drawing {
    let say = |key: &str| lookup(lang, key).unwrap_or(key).to_owned();
    let id: String =
        figure.id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' }).collect();
    let layout = Layout::new(figure, canvas, lang);
    let legends = layout.legends(figure, lang);

    let mut body = String::new();
    let mut title = say(&figure.title);
    if !figure.channel.is_empty() {
        title = format!("{title} · {}", figure.channel);
    }
    if canvas.is_titled() {
        let shown = write::cut(&title, 14.0, canvas.width() - 10.0);
        text(&mut body, (0.0, 15.0), Anchor::Start, 14.0, " font-weight=\"600\"", &shown);
    }

    let mut description = vec![];
    let (plots, height) = layout.plots(figure, &legends);
    for (i, ((panel, plot), legend)) in figure.panels.iter().zip(&plots).zip(&legends).enumerate() {
        legend.draw(&mut body, layout.left, plot.top - legend.height() - 4.0);
        let place = Place {
            clip: format!("{id}-{i}"),
            ends_abscissa: ends_abscissa(figure, i),
            width: canvas.width(),
        };
        draw_panel(&mut body, plot, panel, &place, lang);
        description.push(format!("{} / {}: {}", plot.y.title, plot.x.title, legend.words().join("; ")));
    }
    let svg = page(&id, &title, &description.join(". "), (canvas, height), &body);
    Drawing { svg, size_mm: (canvas.millimetres(canvas.width()), canvas.millimetres(height)) }
}

/// Size of the words of an ordinate on two lines, px.
const SMALL: f64 = 10.0;

/// A panel in its drawing.
struct Place {
    /// Id of what cuts its layers off.
    clip: String,
    /// True where the words of the abscissa stand below it.
    ends_abscissa: bool,
    /// Width of the drawing, px.
    width: f64,
}

/// A panel with its axes, its layers cut off at the frame, and its words.
fn draw_panel(body: &mut String, plot: &Plot<'_>, panel: &Panel, place: &Place, lang: Lang) {
    let clip = &place.clip;
    axes(body, plot, place);
    let _ = writeln!(
        body,
        "<clipPath id=\"{clip}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>",
        px(plot.left),
        px(plot.top),
        px(plot.width),
        px(plot.height)
    );
    let _ = writeln!(body, "<g clip-path=\"url(#{clip})\">");
    for layer in &panel.layers {
        plot.draw(body, layer);
    }
    body.push_str("</g>\n");
    frame(body, plot);
    label::labels(body, plot, panel, lang);
}

/// The drawing around its body, with title and description for those who do not see it.
fn page(id: &str, title: &str, description: &str, (canvas, height): (Canvas, f64), body: &str) -> String {
    let mut out = String::with_capacity(body.len() + 700);
    let (across, size) = match canvas {
        Canvas::Page => (canvas.width(), String::new()),
        Canvas::Paper { width_mm } => {
            let size = format!("width=\"{width_mm}mm\" height=\"{:.2}mm\" ", canvas.millimetres(height));
            (canvas.width(), size)
        }
    };
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {size}viewBox=\"0 0 {} {}\" role=\"img\" \
         aria-labelledby=\"{id}-title {id}-desc\" font-family=\"system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', \
         Arial, sans-serif\" fill=\"#111\">",
        px(across),
        px(height)
    );
    let _ = writeln!(out, "<title id=\"{id}-title\">{}</title>", escape(title));
    let _ = writeln!(out, "<desc id=\"{id}-desc\">{}</desc>", escape(description));
    let _ = writeln!(out, "<rect width=\"{}\" height=\"{}\" fill=\"#fff\"/>", px(across), px(height));
    out.push_str(body);
    out.push_str("</svg>\n");
    out
}

/// Grid, marks and words of the axes; the words of the abscissa on the last panel that shares it.
fn axes(out: &mut String, plot: &Plot<'_>, place: &Place) {
    let last = place.ends_abscissa;
    let (left, top) = (plot.left, plot.top);
    let (right, bottom) = (left + plot.width, top + plot.height);
    let (mut major, mut minor, mut words) = (String::new(), String::new(), String::new());
    for tick in &plot.x.ticks {
        let Some(x) = plot.x.place(tick.at).map(|p| left + p * plot.width) else { continue };
        let line = if tick.label.is_some() { &mut major } else { &mut minor };
        let _ = write!(line, "M{} {}V{}", px(x), px(top), px(bottom));
        if let (Some(label), true) = (&tick.label, last) {
            // The word of a mark at the very edge stays on the paper.
            let half = 0.5 * width(label, FONT);
            let x = x.clamp(half, (place.width - half).max(half));
            text(&mut words, (x, bottom + 16.0), Anchor::Middle, FONT, "", label);
        }
    }
    for tick in &plot.y.ticks {
        let Some(y) = plot.y.place(tick.at).map(|p| top + (1.0 - p) * plot.height) else { continue };
        let line = if tick.label.is_some() { &mut major } else { &mut minor };
        let _ = write!(line, "M{} {}H{}", px(left), px(y), px(right));
        if let Some(label) = &tick.label {
            text(&mut words, (left - 6.0, y + 4.0), Anchor::End, FONT, "", label);
        }
    }
    for (d, colour) in [(minor, "#f0f0f0"), (major, "#dcdcdc")] {
        if !d.is_empty() {
            let _ = writeln!(out, "<path d=\"{d}\" stroke=\"{colour}\" stroke-width=\"0.8\" fill=\"none\"/>");
        }
    }
    out.push_str(&words);
    if last {
        let words = write::cut(&plot.x.title, FONT, plot.width);
        text(out, (0.5 * (left + right), bottom + 35.0), Anchor::Middle, FONT, "", &words);
    }
    ordinate_title(out, plot);
}

/// The words of the ordinate, turned: on one line, or where they are too long, smaller and with the unit on a second line.
fn ordinate_title(out: &mut String, plot: &Plot<'_>) {
    let (title, room) = (plot.y.title.as_str(), plot.height + 16.0);
    let fits = width(title, FONT) <= room;
    let lines: Vec<(f64, f64, &str)> = match title.rsplit_once(", ").filter(|_| !fits) {
        Some((quantity, unit)) => vec![(9.0, SMALL, quantity), (20.0, SMALL, unit)],
        None => vec![(13.0, FONT, title)],
    };
    let y = plot.top + 0.5 * plot.height;
    for (x, size, line) in lines {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", px(x), px(y));
        text(out, (x, y), Anchor::Middle, size, &turn, &write::cut(line, size, room));
    }
}

fn frame(out: &mut String, plot: &Plot<'_>) {
    let _ = writeln!(
        out,
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444\"/>",
        px(plot.left),
        px(plot.top),
        px(plot.width),
        px(plot.height)
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Layer, Scale, Style};

    fn figure(scale: Scale, points: Vec<(f64, f64)>) -> Figure {
        let axis = Axis { label: "axis.a & b".into(), unit: "deg/h".into(), scale, range: None };
        let layers = vec![
            Layer::Line { points: points.clone(), style: Style::Data, legend: "<one>".into() },
            Layer::Points { points: points.clone(), style: Style::Data, legend: "<one>".into() },
            Layer::Band {
                points: points.iter().map(|p| (p.0, p.1 * 0.9, p.1 * 1.1)).collect(),
                style: Style::Muted,
                legend: "band".into(),
            },
            Layer::Bars { bars: vec![(0.0, 1.0, f64::NAN)], style: Style::Muted, legend: String::new() },
            Layer::Horizontal { at: f64::INFINITY, style: Style::Limit, legend: String::new() },
            Layer::Span { from: f64::NAN, to: 1.0, style: Style::Muted, legend: String::new() },
            Layer::Label { at: (1.0, 1.0), text: "word".into() },
        ];
        Figure {
            id: "a\"b".into(),
            title: "t".into(),
            channel: "x".into(),
            panels: vec![Panel { x: axis.clone(), y: axis, layers }],
            remarks: vec![],
        }
    }

    #[test]
    fn degenerate_data_draws_axes_and_no_nonsense() {
        let nan = f64::NAN;
        for scale in [Scale::Linear, Scale::Log] {
            for points in [
                vec![],
                vec![(1.0, 1.0)],
                vec![(nan, nan), (1.0, nan)],
                vec![(1.0, 5.0), (2.0, 5.0), (3.0, 5.0)],
                vec![(0.0, 0.0), (-1.0, -1.0)],
                vec![(1e300, 1e308), (-1e300, -1e308)],
                vec![(1.0, f64::INFINITY), (2.0, 1.0)],
            ] {
                let svg = render(&figure(scale, points.clone()), Lang::En);
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{scale:?} {points:?}\n{svg}");
                assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
                assert!(svg.contains("id=\"a-b-title\"") && !svg.contains("<one>"));
            }
        }
        let empty = Figure {
            id: "e".into(),
            title: "t".into(),
            channel: String::new(),
            panels: vec![],
            remarks: vec![],
        };
        assert!(render(&empty, Lang::En).contains("</svg>"));
    }

    #[test]
    fn a_gap_breaks_the_line() {
        let svg = render(
            &figure(Scale::Linear, vec![(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 1.0), (4.0, 2.0)]),
            Lang::En,
        );
        let line = svg.lines().find(|l| l.contains("stroke-linejoin=\"round\"/>") && l.contains("#0072b2"));
        assert_eq!(line.unwrap().matches('M').count(), 2, "{line:?}");
    }

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        let f = figure(Scale::Log, vec![(1.0, 2.0), (10.0, 3.0)]);
        assert_eq!(render(&f, Lang::En), render(&f, Lang::En));
    }
}
