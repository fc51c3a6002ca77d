//! Where the panels of a figure stand, with their axes and legends.

use super::axis::{Direction, Ruled};
use super::layer::{Plot, extent};
use super::legend::Legend;
use super::write::{FONT, width};
use crate::figure::{Axis, Figure, Layer, Panel, Scale};
use crate::i18n::{Lang, lookup};

/// Width of a drawing for a page, px. The height follows from the content.
const PAGE_WIDTH: f64 = 760.0;
/// CSS px in a millimetre, so that words of a drawing on paper have their size in points.
const PX_PER_MM: f64 = 96.0 / 25.4;
const RIGHT: f64 = 18.0;
const TITLE: f64 = 26.0;
/// Space above a drawing without a title, px: half a word at the highest mark stands there.
const UNTITLED: f64 = 4.0;
const BELOW: f64 = 44.0;
const BETWEEN: f64 = 14.0;
/// Distance of marks from the sides of the frame, as a share of what they extend over.
const BESIDE: f64 = 0.02;

/// Where a figure is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Canvas {
    /// On a page of a report, which scales it, with its title above.
    Page,
    /// On paper at its own size, without a title: a caption has it there.
    Paper {
        /// Width, mm.
        width_mm: f64,
    },
}

impl Canvas {
    /// Width of the view box, px.
    pub fn width(self) -> f64 {
        match self {
            Canvas::Page => PAGE_WIDTH,
            Canvas::Paper { width_mm } => width_mm * PX_PER_MM,
        }
    }

    /// A length of the view box on paper, mm.
    pub fn millimetres(self, px: f64) -> f64 {
        px / PX_PER_MM
    }

    /// True where the title stands above the panels.
    pub fn is_titled(self) -> bool {
        self == Canvas::Page
    }

    /// Height of a panel, one of so many, px: that of a page, or as much lower as a narrow paper is.
    fn panel_height(self, panels: usize, is_polar: bool) -> f64 {
        let (height, of_width) = match panels {
            0 | 1 if is_polar => (420.0, 0.8),
            0 | 1 => (300.0, 0.6),
            2 => (182.0, 0.42),
            _ => (134.0, 0.32),
        };
        match self {
            Canvas::Page => height,
            Canvas::Paper { .. } => f64::min(height, of_width * self.width()),
        }
    }
}

/// Whether the words of the abscissa stand below a panel: the next one has another, or there is none.
pub fn ends_abscissa(figure: &Figure, i: usize) -> bool {
    figure.panels.get(i + 1).is_none_or(|next| figure.panels.get(i).is_none_or(|p| next.x != p.x))
}

/// Extent of the data of panels along their abscissa; marks at its ends, and their intervals, stand clear of the frame.
fn breadth(panels: &[&Panel], scale: Scale) -> Option<(f64, f64)> {
    let is_marked = panels.iter().flat_map(|p| &p.layers).any(|l| matches!(l, Layer::Points { .. }));
    let (low, high) = extent(panels, scale, false)?;
    let room = if is_marked && scale == Scale::Linear { BESIDE * (high - low) } else { 0.0 };
    Some((low - room, high + room))
}

/// Where the panels of a figure stand, and their axes.
#[derive(Debug)]
pub struct Layout {
    /// Left edge of the panels, px.
    pub left: f64,
    width: f64,
    height: f64,
    above: f64,
    /// Abscissa and ordinate of each panel.
    axes: Vec<(Ruled, Ruled)>,
}

impl Layout {
    /// Lays a figure out.
    pub fn new(figure: &Figure, canvas: Canvas, lang: Lang) -> Layout {
        let panels: Vec<&Panel> = figure.panels.iter().collect();
        let is_polar = panels.iter().any(|p| p.x.scale == Scale::Polar);
        let height = canvas.panel_height(panels.len(), is_polar);
        let ordinates: Vec<Ruled> = panels
            .iter()
            .map(|p| Ruled::new(&p.y, extent(&[p], p.y.scale, true), Direction::Up, height, lang))
            .collect();
        let labels = ordinates.iter().flat_map(|r| &r.ticks).filter_map(|t| t.label.as_ref());
        let widest = labels.map(|l| width(l, FONT)).fold(20.0, f64::max);
        let left = (widest + 32.0).min(160.0);
        let across = canvas.width() - left - RIGHT;
        let abscissa = |p: &Panel, y: &Ruled| {
            if p.x.scale == Scale::Polar {
                // A unit is as long across as up.
                let (low, high) = y.range();
                let half = 0.5 * (high - low) * across / height;
                let axis = Axis { range: Some((-half, half)), ..p.x.clone() };
                return Ruled::new(&axis, None, Direction::Across, across, lang);
            }
            let same: Vec<&Panel> = panels.iter().copied().filter(|q| q.x == p.x).collect();
            Ruled::new(&p.x, breadth(&same, p.x.scale), Direction::Across, across, lang)
        };
        let axes = panels.iter().zip(ordinates).map(|(p, y)| (abscissa(p, &y), y)).collect();
        Layout { left, width: across, height, above: if canvas.is_titled() { TITLE } else { UNTITLED }, axes }
    }

    /// The legend of each panel.
    pub fn legends(&self, figure: &Figure, lang: Lang) -> Vec<Legend> {
        let say = |key: &str| lookup(lang, key).unwrap_or(key).to_owned();
        figure.panels.iter().map(|p| Legend::new(p, self.width, say)).collect()
    }

    /// Where each panel stands, and the height of the whole.
    pub fn plots(&self, figure: &Figure, legends: &[Legend]) -> (Vec<Plot<'_>>, f64) {
        let mut top = self.above;
        let mut plots = vec![];
        for (i, ((x, y), legend)) in self.axes.iter().zip(legends).enumerate() {
            top += legend.height() + 4.0;
            plots.push(Plot { left: self.left, top, width: self.width, height: self.height, x, y });
            // Another panel below words of an abscissa keeps its distance from them.
            let apart = if i + 1 < figure.panels.len() { BETWEEN } else { 0.0 };
            // A polar plot has no words below it.
            let has_words = ends_abscissa(figure, i) && !x.is_polar();
            top += self.height + if has_words { BELOW + apart } else { BETWEEN };
        }
        (plots, top)
    }
}
