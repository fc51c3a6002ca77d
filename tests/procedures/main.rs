//! Procedures, limits and manifests: what is read, what is refused, what the guide says of every key.

mod files;
mod manifest;
mod phases;
mod robustness;
#[path = "../support/mod.rs"]
mod support;
