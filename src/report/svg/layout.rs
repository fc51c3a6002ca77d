//! Where the panels of a figure stand, with their axes and legends.

use super::axis::{Direction, Ruled};
use super::layer::{Plot, extent};
use super::legend::Legend;
use super::write::{FONT, width};
use crate::figure::{Axis, Figure, Layer, Panel, Scale};
use crate::i18n::{Lang, lookup};

/// Width of the view box, px. The height follows from the content.
pub const WIDTH: f64 = 760.0;
const RIGHT: f64 = 18.0;
const TITLE: f64 = 26.0;
const BELOW: f64 = 44.0;
const BETWEEN: f64 = 14.0;
/// Distance of marks from the sides of the frame, as a share of what they extend over.
const BESIDE: f64 = 0.02;

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
    /// Abscissa and ordinate of each panel.
    axes: Vec<(Ruled, Ruled)>,
}

impl Layout {
    /// Lays a figure out.
    pub fn new(figure: &Figure, lang: Lang) -> Layout {
        let panels: Vec<&Panel> = figure.panels.iter().collect();
        let height = match panels.len() {
            0 | 1 if panels.iter().any(|p| p.x.scale == Scale::Polar) => 420.0,
            0 | 1 => 300.0,
            2 => 182.0,
            _ => 134.0,
        };
        let ordinates: Vec<Ruled> = panels
            .iter()
            .map(|p| Ruled::new(&p.y, extent(&[p], p.y.scale, true), Direction::Up, height, lang))
            .collect();
        let labels = ordinates.iter().flat_map(|r| &r.ticks).filter_map(|t| t.label.as_ref());
        let widest = labels.map(|l| width(l, FONT)).fold(20.0, f64::max);
        let left = (widest + 32.0).min(160.0);
        let across = WIDTH - left - RIGHT;
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
        Layout { left, width: across, height, axes }
    }

    /// The legend of each panel.
    pub fn legends(&self, figure: &Figure, lang: Lang) -> Vec<Legend> {
        let say = |key: &str| lookup(lang, key).unwrap_or(key).to_owned();
        figure.panels.iter().map(|p| Legend::new(p, self.width, say)).collect()
    }

    /// Where each panel stands, and the height of the whole.
    pub fn plots(&self, figure: &Figure, legends: &[Legend]) -> (Vec<Plot<'_>>, f64) {
        let mut top = TITLE;
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
