//! What the readers of binary files share: records that follow each other, columns that lie somewhere in a file, and the
//! choice among arrays of different length.

#[cfg(any(feature = "matlab", feature = "numpy"))]
pub(crate) mod array_selection;
#[cfg(any(feature = "matlab", feature = "numpy"))]
pub(crate) mod column_stream;
#[cfg(any(feature = "matlab", feature = "numpy"))]
pub(crate) mod positioned_file;
pub(crate) mod records;
