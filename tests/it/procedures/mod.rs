//! Procedures, limits and manifests: what is read, what is refused, what the guide says of every key.

mod check_list;
mod compared;
mod conditions;
mod deciding;
mod derived;
mod external;
mod files;
mod manifest;
mod named_files;
mod phases;
#[cfg(unix)]
mod programs;
mod robustness;
