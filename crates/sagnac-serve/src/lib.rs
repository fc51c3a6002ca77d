//! The pages and the programming interface of a test bench: an operator scans a serial number and sees a verdict.
//!
//! This package knows no analysis. A test is a process of the program itself, `sagnac run … --out …`, so that its numbers are
//! those of the command line, and what a page shows of its result is given by the program ([`Harness`]).
//!
//! Everything that the server keeps lies in its data folder:
//!
//! ```text
//! queue.jsonl           a line for each test that was ordered, and one for its end, synced before it is answered
//! recordings/           recordings to choose from, beside those of other folders
//! procedures/           own procedures and limits
//! uploads/RANDOM/       a recording that was uploaded
//! results/ID/           the result of a test, as `sagnac run` writes it
//! running/ID/           lock and messages of the process of a test
//! ```
//!
//! | module | contents |
//! |---|---|
//! | `listener` | connections; the threat model stands there |
//! | `guard`, `token` | who may ask for what |
//! | `routes`, `api`, `pages` | requests and their answers |
//! | `intake`, `recordings`, `catalogue`, `uploads` | from a request to an order: files and tests by name |
//! | `queue`, `journal`, `worker`, `events` | orders, their processes, and what is told of them |
#![forbid(unsafe_code)]

mod api;
mod catalogue;
mod client;
mod events;
mod guard;
mod harness;
mod intake;
mod journal;
mod listener;
mod lots;
mod openapi;
mod order;
mod pages;
mod queue;
mod recordings;
mod refusal;
mod results;
mod routes;
mod serve;
mod setup;
mod texts;
mod token;
mod uploads;
mod worker;

pub use harness::{Harness, LocalText, Next, Outcome, Quantity};
pub use serve::{Server, StartError};
pub use setup::{Listen, ProxyError, PublicOrigin, Rule, Setup, Shipped};
pub use texts::Lang;
