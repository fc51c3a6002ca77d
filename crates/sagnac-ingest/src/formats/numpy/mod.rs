//! NumPy: single arrays and archives of them.

mod array;
mod dtype;
mod literal;
mod npy;
mod npz;

pub(super) use npy::Npy;
pub(super) use npz::Npz;
