//! How each part of a figure looks: colours of Okabe and Ito, told apart without colour by dash and marker.

use crate::figure::Style;

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle.
    Disc,
    /// Filled square.
    Square,
    /// Open diamond.
    Diamond,
    /// Filled triangle.
    Triangle,
    /// Oblique cross.
    Cross,
    /// A bar with a stroke below it: what lies below is allowed.
    Ceiling,
}

/// Stroke, dash and marker of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Colour, `#rrggbb`.
    pub colour: &'static str,
    /// Dash pattern, empty for a solid line.
    pub dash: &'static str,
    /// Width of lines, px.
    pub width: f64,
    /// Marker of points.
    pub marker: Marker,
    /// Opacity of an area filled with the colour.
    pub fill_opacity: f64,
}

/// Colour and dash of the terms of a model, in the order of their numbers.
const TERMS: [(&str, &str, Marker); 8] = [
    ("#009e73", "2 2.5", Marker::Triangle),
    ("#cc79a7", "8 2.5 2 2.5", Marker::Square),
    ("#b87900", "11 3.5", Marker::Diamond),
    ("#2f8fc4", "1.2 2.6", Marker::Cross),
    ("#6b4c9a", "5 2 1.2 2 1.2 2", Marker::Disc),
    ("#5b5b5b", "4 4", Marker::Square),
    ("#7a8b00", "9 2 1.2 2", Marker::Triangle),
    ("#c1440e", "3 1.6 3 5", Marker::Diamond),
];

/// Dash of a term that the record does not resolve: sparser than that of any other.
const UNRESOLVED: &str = "3 7";

/// The look of a part.
pub fn look(style: Style) -> Look {
    let plain = Look { colour: "#0072b2", dash: "", width: 1.5, marker: Marker::Disc, fill_opacity: 0.18 };
    match style {
        Style::Data => plain,
        Style::SecondData => Look { colour: "#d55e00", marker: Marker::Square, ..plain },
        Style::Model => Look { colour: "#111111", dash: "7 3", marker: Marker::Cross, ..plain },
        Style::Term(n) | Style::Unit(n) => {
            let (colour, dash, marker) = TERMS[usize::from(n) % TERMS.len()];
            Look { colour, dash, width: 1.4, marker, ..plain }
        }
        Style::UnresolvedTerm(n) => {
            let term = look(Style::Term(n));
            Look { dash: UNRESOLVED, width: 1.1, ..term }
        }
        Style::Limit => {
            Look { colour: "#a50026", dash: "12 4", width: 1.8, marker: Marker::Ceiling, fill_opacity: 0.10 }
        }
        Style::Reference => Look { colour: "#111111", dash: "3 3", marker: Marker::Diamond, ..plain },
        Style::Heating => Look { colour: "#c1121f", marker: Marker::Triangle, ..plain },
        Style::Cooling => Look { colour: "#1d5fa8", marker: Marker::Disc, ..plain },
        Style::Muted => {
            Look { colour: "#8a8a8a", dash: "", width: 1.3, marker: Marker::Disc, fill_opacity: 0.20 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_differ_in_colour_and_in_dash() {
        for (i, a) in TERMS.iter().enumerate() {
            for b in &TERMS[i + 1..] {
                assert!(a.0 != b.0 && a.1 != b.1, "{a:?} {b:?}");
            }
        }
        let (warm, cold) = (look(Style::Heating), look(Style::Cooling));
        assert!(warm.colour != cold.colour && warm.marker != cold.marker);
        assert_eq!(look(Style::Term(0)), look(Style::Term(TERMS.len() as u8)));
    }
}
