//! Public recordings of real instruments against the numbers that were published or computed elsewhere for them.
//!
//! The recordings are not part of this repository (`docs/real-data.md` says where they are). The tests read the folder
//! named by `SAGNAC_REAL_DATA`; without it they say on stderr that they were skipped:
//!
//! `SAGNAC_REAL_DATA=... cargo test --test it real -- --nocapture`

mod clocks;
mod explain;
mod inspect;
mod kinds;
mod rate_table;
mod thermal;
