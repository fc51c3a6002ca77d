//! `#[derive(Table)]`: a struct that is a table of a TOML file. Each field is a key; its doc comment is the text of guide,
//! schema and editors, and one attribute has its unit, range, default and example. Reading fills the struct by the same
//! description, so that no key is described and not read, and no default stands twice.
//!
//! ```text
//! /// A supply voltage that must hold over the whole evaluated window.
//! #[derive(Table)]
//! #[table("conditions.supply")]
//! pub struct SupplyCondition {
//!     /// Channel with the role `supply`.
//!     #[key(id, example = "supply")]
//!     pub channel: String,
//!     /// Maximum difference from it.
//!     #[key(difference = "V", above = 0, example = "0.25 V")]
//!     pub tolerance_v: f64,
//! }
//! ```
//!
//! On the struct, `#[table("name")]` has the path of the table, empty for a file as a whole; `format = "procedure/1"` behind
//! it adds the key `format`. Without the attribute the struct is a group of keys that several tables share.
//!
//! On a field, `#[key(...)]` takes
//! - what the value is, where the type does not say it: `quantity = "unit"`, `difference = "unit"` (the offset of a
//!   temperature scale does not count), `unit_of = "key"` (the unit follows from another key), `choice = WORDS`, `id`,
//!   `remark` (a text that may be blank), `one_or_several` (one table or a list of them), `kind = EXPRESSION`;
//! - the range of a number: `min`, `max`, `above`, or `range = CONSTANT`;
//! - whether it must be there: `default = VALUE`, `optional` for a table whose keys then have their defaults, `required` for
//!   an `Option` or a `Vec`. An `Option` or a `Vec` may be left out, anything else must be there;
//! - `example = VALUE`, and `name = "key"` where the field is named otherwise. A field that ends in its unit, `warm_up_s`, has
//!   the key without it, `warm_up`. A value that is no literal of Rust is written `toml("2030-12-31")`.
//!
//! Fields that are no keys: `#[key(flatten)]` for a group of keys, `#[key(span)]` for the place of the table, `#[key(section)]`
//! for the table as it was read, with the places of its values. A second paragraph of a doc comment is for readers of the source alone.

mod attributes;
mod expand;
mod literal;

use proc_macro::TokenStream;
use syn::{DeriveInput, Error, parse_macro_input};

/// Describes a struct as a table of a TOML file and reads it; the crate's page has the attributes.
#[proc_macro_derive(Table, attributes(table, key))]
pub fn table(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    expand::table(&input).unwrap_or_else(Error::into_compile_error).into()
}
