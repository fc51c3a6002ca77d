//! The file formats, each in its own module behind a cargo feature of the same name, and the list of them all.

#[cfg(feature = "bag")]
mod bag;
#[cfg(feature = "hdf5")]
mod hdf5;
#[cfg(feature = "json")]
mod json;
#[cfg(any(feature = "json", feature = "text", feature = "ulog", feature = "xlsx"))]
mod loaded;
#[cfg(feature = "matlab")]
mod matlab;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "text")]
mod novatel;
#[cfg(feature = "numpy")]
mod numpy;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "raw")]
mod raw;
#[cfg(feature = "text")]
mod sample_list;
#[cfg(feature = "xlsx")]
mod spreadsheet;
#[cfg(feature = "rosbag2")]
mod sqlite_bag;
#[cfg(feature = "tdms")]
mod tdms;
#[cfg(feature = "text")]
mod text;
#[cfg(any(feature = "mcap", feature = "bag", feature = "rosbag2"))]
mod topics;
#[cfg(feature = "ulog")]
mod ulog;

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
    #[cfg(feature = "rosbag2")]
    &sqlite_bag::SqliteBag,
    #[cfg(feature = "ulog")]
    &ulog::ULog,
    #[cfg(feature = "xlsx")]
    &spreadsheet::Spreadsheet,
    #[cfg(feature = "json")]
    &json::JsonObjects,
    #[cfg(feature = "text")]
    &sample_list::SampleList,
    #[cfg(feature = "text")]
    &novatel::RawImu,
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
pub(crate) static FEATURES: [FormatFeature; 16] = [
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
    FormatFeature {
        id: "rosbag2",
        feature: "rosbag2",
        recognises: |f| f.head.starts_with(b"SQLite format 3\0"),
    },
    FormatFeature { id: "ulog", feature: "ulog", recognises: |f| f.head.starts_with(b"ULog\x01\x12\x35") },
    FormatFeature {
        id: "xlsx",
        feature: "xlsx",
        recognises: |f| f.head.starts_with(b"PK\x03\x04") && f.head.windows(3).any(|w| w == b"xl/"),
    },
    FormatFeature {
        id: "json",
        feature: "json",
        recognises: |f| f.head.trim_ascii_start().starts_with(b"{\""),
    },
    FormatFeature { id: "slist", feature: "text", recognises: |f| f.head.starts_with(b"TIMESERIES ") },
    FormatFeature {
        id: "rawimu",
        feature: "text",
        recognises: |f| f.head.starts_with(b"%RAWIMU") || f.head.starts_with(b"#RAWIMU"),
    },
    FormatFeature { id: "csv", feature: "text", recognises: |f| !f.head.contains(&0) },
];

/// The formats whose feature is off.
pub(crate) fn left_out() -> impl Iterator<Item = &'static FormatFeature> {
    FEATURES.iter().filter(|known| FORMATS.iter().all(|f| f.id() != known.id))
}
