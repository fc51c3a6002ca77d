//! Numbers as a C header: what firmware includes.

use std::fmt::Write;

/// A header with the numbers of one channel.
pub struct CHeader {
    channel: String,
    text: String,
}

impl CHeader {
    /// A header without numbers; `guard` names its kind of table.
    pub fn new(guard: &str, channel: &str) -> CHeader {
        let upper = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
        let channel: String = channel.chars().map(upper).collect();
        let text = format!("#ifndef SAGNAC_{guard}_{channel}_H\n#define SAGNAC_{guard}_{channel}_H\n\n");
        CHeader { channel, text }
    }

    /// Adds a number.
    pub fn define(&mut self, key: &str, value: f64) {
        let _ = writeln!(self.text, "#define COMP_{}_{key} {value:.9e}", self.channel);
    }

    /// Adds a count.
    pub fn count(&mut self, key: &str, count: usize) {
        let _ = writeln!(self.text, "#define COMP_{}_{key} {count}", self.channel);
    }

    /// Adds a list of numbers.
    pub fn array(&mut self, key: &str, values: &[f64]) {
        let list = values.iter().map(|x| format!("{x:.9e}")).collect::<Vec<_>>().join(", ");
        let declared = format!("static const double COMP_{}_{key}[{}]", self.channel, values.len());
        let _ = writeln!(self.text, "{declared} = {{{list}}};");
    }

    /// Adds an empty line.
    pub fn gap(&mut self) {
        self.text.push('\n');
    }

    /// The text of the header.
    pub fn finish(mut self) -> String {
        self.text.push_str("\n#endif\n");
        self.text
    }
}
