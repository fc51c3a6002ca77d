//! A program that takes the parameters of a gyro, and the contents of its file.

use super::axis::Axis;
use super::form::Places;
use super::quantity::Quantity;

/// One program that takes the parameters of a gyro.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Name on the command line.
    pub id: &'static str,
    /// Key of its conventions in the locale tables.
    pub convention: &'static str,
    /// What begins a line of a comment in its format.
    pub comment: &'static str,
    /// The noise that it has places for.
    pub places: Places,
    /// Step at which it uses the values, s; `None`: that of the recording.
    pub step_s: Option<f64>,
    /// Its quantities.
    pub quantities: &'static [Quantity],
    /// Writes its file.
    pub write: fn(&Sheet<'_>) -> String,
}

/// Number of axes that a target has.
pub const AXES: usize = 3;

/// The contents of a file: the axes of a target with the values of its quantities, and the lines of its head.
#[derive(Debug)]
pub struct Sheet<'a> {
    /// The target.
    pub target: &'a Target,
    /// The unit, for formats that name it.
    pub unit: &'a str,
    /// x, y, z.
    pub axes: [&'a Axis; AXES],
    /// Step of the target, s.
    pub step_s: f64,
    /// Lines of the head, in words.
    pub head: Vec<String>,
}

impl Sheet<'_> {
    /// The values of a quantity on the axes; `None` where no axis states it. An axis that alone does not has 0.
    pub(super) fn values(&self, quantity: &Quantity) -> Option<[f64; AXES]> {
        let values = self.axes.map(|axis| (quantity.of)(axis, self.step_s));
        values.iter().any(Option::is_some).then(|| values.map(|v| v.unwrap_or(0.0)))
    }

    /// The quantities that the result states, with their values.
    pub(super) fn stated(&self) -> impl Iterator<Item = (&'static Quantity, [f64; AXES])> + '_ {
        self.target.quantities.iter().filter_map(|q| Some((q, self.values(q)?)))
    }

    /// The head as comments.
    pub(super) fn comments(&self) -> String {
        self.head.iter().map(|line| format!("{} {line}\n", self.target.comment)).collect()
    }
}
