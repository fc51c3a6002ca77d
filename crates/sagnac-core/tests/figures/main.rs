//! Figures of whole computations on small records, held against stored ones: what no closed form tells is to stay as it is.
//!
//! `SAGNAC_WRITE_FIGURES=1` stores them anew; the difference is to be read before it is committed.

mod effects;
mod measurands;
mod noise;
mod stored;
#[path = "../../../sagnac-explain/src/effect/kinds/truths.rs"]
mod truths;

// The truths name the catalogue as the crate itself does.
use sagnac_core::effect;
