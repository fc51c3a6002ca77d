//! Records a test bench: what devices say, by a monotonic clock, into parts that are written whole; and carries out a schedule
//! within declared limits, with a safe state at every end.
//!
//! A device is a process or a connection that speaks lines: JSON of the protocol `bench/1`, or texts with numbers. Nothing here
//! analyses anything. What is recorded is read by the same program as any other recording.
//!
//! ```text
//! recording.toml       manifest: the parts of the unit, and those of the other devices beside it
//! gyro-000001.csv      rows of at most a minute; appears whole or not at all
//! table-000001.csv
//! events.jsonl         what was commanded, what was reached, what went wrong
//! ```
//!
//! This is no interlock. Whoever may be hurt by a table or a chamber is protected by its own limits and switches; the limits here
//! keep a schedule from asking for what nobody meant.

pub mod clock;
mod clock_steps;
pub mod device;
pub mod fault;
mod inbox;
mod journal;
mod link;
mod manifest;
pub mod motion;
mod parts;
mod protocol;
pub mod session;
pub mod setup;

pub use clock::Clock;
pub use fault::Fault;
pub use manifest::MANIFEST_FILE;
pub use motion::Leg;
pub use session::{End, Order, Summary, record};
