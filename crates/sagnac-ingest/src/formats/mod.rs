//! The file formats, each in its own module behind a cargo feature of the same name, and the list of them all.

#[cfg(feature = "bag")]
mod bag;
#[cfg(feature = "hdf5")]
mod hdf5;
#[cfg(feature = "matlab")]
mod matlab;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "numpy")]
mod numpy;
#[cfg(feature = "parquet")]
mod parquet;
pub mod raw;
#[cfg(feature = "tdms")]
mod tdms;
#[cfg(feature = "text")]
mod text;
#[cfg(any(feature = "mcap", feature = "bag"))]
mod topics;

use crate::format::Format;

/// Every format that is compiled in, the most particular first: raw records only where a layout is given, text last,
/// because it takes whatever looks like lines.
pub static FORMATS: &[&dyn Format] = &[
    #[cfg(feature = "raw")]
    &raw::Raw,
    #[cfg(feature = "parquet")]
    &parquet::Parquet,
    #[cfg(feature = "numpy")]
    &numpy::Npy,
    #[cfg(feature = "numpy")]
    &numpy::Npz,
    #[cfg(feature = "hdf5")]
    &hdf5::Hdf5,
    #[cfg(feature = "matlab")]
    &matlab::Mat,
    #[cfg(feature = "tdms")]
    &tdms::Tdms,
    #[cfg(feature = "mcap")]
    &mcap::Mcap,
    #[cfg(feature = "bag")]
    &bag::RosBag,
    #[cfg(feature = "text")]
    &text::DelimitedText,
];
