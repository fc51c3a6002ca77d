//! Formats that a figure is written in.

use crate::report::ReportError;
use crate::report::svg::Drawing;

/// A format of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// SVG.
    Svg,
    /// PDF with the letters of its fonts.
    Pdf,
    /// PNG, at the resolution that journals ask for line art.
    Png,
}

/// Every format with its name, which is also the ending of its files.
pub static FORMATS: &[(&str, Format)] = &[("svg", Format::Svg), ("pdf", Format::Pdf), ("png", Format::Png)];

/// Resolution of PNG, dots per inch.
#[cfg(feature = "pdf")]
const PNG_DPI: f64 = 600.0;

impl Format {
    /// The format of this name.
    pub fn named(id: &str) -> Option<Format> {
        FORMATS.iter().find(|(name, _)| *name == id).map(|(_, format)| *format)
    }

    /// A drawing in the format.
    ///
    /// # Errors
    /// [`ReportError::SvgOnly`] for all but SVG in a build without the typesetter, [`ReportError::Pdf`] for what it refuses.
    #[cfg(feature = "pdf")]
    pub fn written(self, drawing: &Drawing, title: &str) -> Result<Vec<u8>, ReportError> {
        let of = sagnac_pdf::Drawing { svg: &drawing.svg, size_mm: drawing.size_mm, title };
        match self {
            Format::Svg => return Ok(drawing.svg.clone().into_bytes()),
            Format::Pdf => sagnac_pdf::drawing_as_pdf(&of),
            Format::Png => sagnac_pdf::drawing_as_png(&of, PNG_DPI),
        }
        .map_err(|e| ReportError::Pdf(e.to_string()))
    }

    /// A drawing in the format.
    ///
    /// # Errors
    /// [`ReportError::SvgOnly`] for all but SVG.
    #[cfg(not(feature = "pdf"))]
    pub fn written(self, drawing: &Drawing, _: &str) -> Result<Vec<u8>, ReportError> {
        match self {
            Format::Svg => Ok(drawing.svg.clone().into_bytes()),
            Format::Pdf | Format::Png => Err(ReportError::SvgOnly),
        }
    }
}
