//! NumPy: single arrays and archives of them.
//!
//! The header is read by a parser of our own: the crate `npyz` (0.9) brings a parser generator and whole numbers of any size
//! for it, gives records no offsets of their fields, and tells of a damaged header no byte of the file.

mod array;
mod dtype;
mod literal;
mod npy;
mod npz;

pub(super) use npy::Npy;
pub(super) use npz::Npz;
