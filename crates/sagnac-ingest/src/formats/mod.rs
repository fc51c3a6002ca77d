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
#[cfg(feature = "raw")]
mod raw;
#[cfg(feature = "tdms")]
mod tdms;
#[cfg(feature = "text")]
mod text;
#[cfg(any(feature = "mcap", feature = "bag"))]
mod topics;

use crate::format::{Candidate, Format};

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

/// A format with the cargo feature that compiles it in.
pub(crate) struct FormatFeature {
    /// Id of the format.
    pub id: &'static str,
    /// Name of the feature.
    pub feature: &'static str,
    /// True when a file seems to be of the format; asked only where the format itself is left out.
    pub recognises: fn(&Candidate) -> bool,
}

/// Every format, compiled in or not, in the order of [`FORMATS`].
pub(crate) static FEATURES: [FormatFeature; 10] = [
    FormatFeature { id: "raw", feature: "raw", recognises: |f| f.options.layout.is_some() },
    FormatFeature { id: "parquet", feature: "parquet", recognises: |f| f.head.starts_with(b"PAR1") },
    FormatFeature { id: "npy", feature: "numpy", recognises: |f| f.head.starts_with(b"\x93NUMPY") },
    FormatFeature {
        id: "npz",
        feature: "numpy",
        recognises: |f| {
            let first_name = f.head.get(30..f.head.len().min(286)).unwrap_or_default();
            f.head.starts_with(b"PK\x03\x04") && first_name.windows(4).any(|name| name == b".npy")
        },
    },
    FormatFeature { id: "hdf5", feature: "hdf5", recognises: |f| f.head.starts_with(b"\x89HDF\r\n\x1a\n") },
    FormatFeature {
        id: "mat",
        feature: "matlab",
        recognises: |f| matches!(f.head.get(126..128), Some(b"IM" | b"MI")) && f.head.starts_with(b"MATLAB"),
    },
    FormatFeature { id: "tdms", feature: "tdms", recognises: |f| f.head.starts_with(b"TDSm") },
    FormatFeature { id: "mcap", feature: "mcap", recognises: |f| f.head.starts_with(b"\x89MCAP0\r\n") },
    FormatFeature { id: "rosbag", feature: "bag", recognises: |f| f.head.starts_with(b"#ROSBAG") },
    FormatFeature { id: "csv", feature: "text", recognises: |f| !f.head.contains(&0) },
];

/// The formats whose feature is off.
pub(crate) fn left_out() -> impl Iterator<Item = &'static FormatFeature> {
    FEATURES.iter().filter(|known| FORMATS.iter().all(|f| f.id() != known.id))
}
