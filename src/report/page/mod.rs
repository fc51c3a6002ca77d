//! Pages of blocks: a document is described once, as headings, sentences, facts, tables and figures, and shown by every
//! form: HTML and Markdown through a template for each kind of block, the terminal, CSV.
//!
//! Nothing here knows what a page is of, nor any file.

mod block;
mod csv;
mod html;
mod markdown;
mod markup;
mod table;
mod terminal;
mod value;

pub use block::{
    Block, Facts, Figure, Footnotes, Head, Heading, Lead, Link, List, Method, Page, Reasons, Step, Steps,
};
pub use csv::csv;
pub use html::Html;
pub use markdown::Markdown;
pub use markup::{Markup, page as seen};
pub use table::{Align, Column, Layout, Listed, OnTerminal, Row, Table};
pub use terminal::terminal;
pub use value::{Detail, Detailed, Joined, Quantity, State, Value, joined};

#[cfg(test)]
mod tests;
