//! Plots as data: axes, layers, bands. What is drawn is decided here; how it is drawn, in `report::svg`.

use crate::message::Note;
use crate::real;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// How an axis maps values to paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Proportional.
    Linear,
    /// Decades.
    Log,
    /// Proportional, with a unit as long on both axes and no marks: a polar plot brings its own. For both axes of a panel.
    Polar,
}

/// One axis: label, unit, scale and range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Key of the label in the locale tables, for example `axis.averaging_time`.
    pub label: Cow<'static, str>,
    /// Unit shown behind the label, empty for none.
    pub unit: String,
    /// Scale.
    pub scale: Scale,
    /// Fixed range; `None` fits the data.
    #[serde(with = "real")]
    pub range: Option<(f64, f64)>,
}

/// Part a layer plays in a figure. Colours, dashes and markers follow from it, chosen for the colour-blind and for
/// print without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Style {
    /// The measured data.
    Data,
    /// A second measured quantity on the same axes.
    SecondData,
    /// The fitted model as a whole.
    Model,
    /// One term of the model; the number tells terms apart.
    Term(u8),
    /// A term of the model that the record does not resolve: what it may hold at most.
    UnresolvedTerm(u8),
    /// One of several units on the same axes; the number tells them apart.
    Unit(u8),
    /// A limit; points are upper ones.
    Limit,
    /// Measured while the temperature rose: red.
    Heating,
    /// Measured while it fell: blue.
    Cooling,
    /// A reference line or point, such as the Russian 100-s value.
    Reference,
    /// Uncertain or left-out data, greyed.
    Muted,
}

/// One layer of a figure, drawn in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// A line through points; a non-finite point breaks it.
    Line {
        /// Points.
        #[serde(with = "real")]
        points: Vec<(f64, f64)>,
        /// Part it plays.
        style: Style,
        /// Key (`figure.*`) or plain text of the legend entry; empty for none.
        legend: String,
    },
    /// Marked points.
    Points {
        /// Points.
        #[serde(with = "real")]
        points: Vec<(f64, f64)>,
        /// Part they play.
        style: Style,
        /// Legend entry.
        legend: String,
    },
    /// A band between two curves over the same abscissae: (x, low, high).
    Band {
        /// Triples.
        #[serde(with = "real")]
        points: Vec<(f64, f64, f64)>,
        /// Part it plays.
        style: Style,
        /// Legend entry.
        legend: String,
    },
    /// Bars of a histogram: (from, to, height).
    Bars {
        /// Triples.
        #[serde(with = "real")]
        bars: Vec<(f64, f64, f64)>,
        /// Part they play.
        style: Style,
        /// Legend entry.
        legend: String,
    },
    /// A horizontal line over the whole width.
    Horizontal {
        /// Ordinate.
        #[serde(with = "real")]
        at: f64,
        /// Part it plays.
        style: Style,
        /// Legend entry.
        legend: String,
    },
    /// A shaded span of the abscissa over the whole height.
    Span {
        /// Start.
        #[serde(with = "real")]
        from: f64,
        /// End.
        #[serde(with = "real")]
        to: f64,
        /// Part it plays.
        style: Style,
        /// Legend entry.
        legend: String,
    },
    /// A word at a point.
    Label {
        /// Position.
        #[serde(with = "real")]
        at: (f64, f64),
        /// The word.
        text: Note,
    },
}

/// One pair of axes with its layers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Layers, drawn in order.
    pub layers: Vec<Layer>,
}

/// A figure: one or more panels, one above the other. Neighbours with the same abscissa share its range and words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Id, for example `sigma_tau`; also the stem of its file. A channel is appended when there are several.
    pub id: String,
    /// Key of the title in the locale tables.
    pub title: Cow<'static, str>,
    /// Channel shown behind the title, empty when there is one only.
    pub channel: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Numbers that belong under the figure, said behind its caption.
    pub remarks: Vec<Note>,
}
