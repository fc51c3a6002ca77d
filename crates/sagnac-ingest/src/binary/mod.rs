//! What the readers of binary files share: numbers of fixed width, records that follow each other, columns that lie
//! somewhere in a file, and the names of scalars that tell a sample rate.

pub(super) mod at;
pub(super) mod choose;
pub(super) mod column_stream;
pub(super) mod number_type;
pub(super) mod rate;
pub(super) mod records;
