//! Broken files by their kinds.

mod layouts;
mod models;
mod procedures;
mod recordings;
