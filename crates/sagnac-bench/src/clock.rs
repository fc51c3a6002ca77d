//! The clock of a recording: the monotonic one of this computer, or that of an emulated bench, whose time goes as fast as it is
//! asked to.
//!
//! An emulated bench (a *twin*) is asked to go on to a time by `{"advance":NS}`. It moves everything to that time, sends what its
//! devices say until then, and answers `{"now":NS,"sent":{"gyro":120}}` with the lines that each device has sent altogether.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

/// Nanoseconds of a second.
pub const SECOND_NS: i64 = 1_000_000_000;
/// Longest time until a twin answers.
const TWIN_PATIENCE: Duration = Duration::from_secs(20);

/// A length of time, ns.
pub fn ns(length: Duration) -> i64 {
    i64::try_from(length.as_nanos()).unwrap_or(i64::MAX)
}

/// A time or a length, s.
pub fn seconds(ns: i64) -> f64 {
    ns as f64 / SECOND_NS as f64
}

/// Tells the time; threads that read from devices have copies.
#[derive(Debug, Clone)]
pub(crate) enum Stamps {
    /// Of this computer.
    Own(Monotonic),
    /// Of a twin.
    Twin(Arc<AtomicI64>),
}

impl Stamps {
    /// The time, ns.
    pub fn now_ns(&self) -> i64 {
        match self {
            Stamps::Own(clock) => clock.now_ns(),
            Stamps::Twin(now) => now.load(Ordering::SeqCst),
        }
    }
}

/// The monotonic clock of this computer. On Unix its numbers are those of `CLOCK_MONOTONIC`, which drivers can read too.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Monotonic {
    #[cfg(not(unix))]
    began: std::time::Instant,
}

impl Monotonic {
    fn new() -> Monotonic {
        Monotonic {
            #[cfg(not(unix))]
            began: std::time::Instant::now(),
        }
    }

    #[cfg(unix)]
    fn now_ns(self) -> i64 {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
        now.tv_sec * SECOND_NS + now.tv_nsec
    }

    #[cfg(not(unix))]
    fn now_ns(self) -> i64 {
        ns(self.began.elapsed())
    }
}

/// A clock of a recording.
#[derive(Debug)]
pub struct Clock(pub(crate) Kind);

/// Which clock it is.
#[derive(Debug)]
pub(crate) enum Kind {
    /// The monotonic clock of this computer.
    Own(Monotonic),
    /// The clock of an emulated bench.
    Twin(Twin),
}

impl Clock {
    /// The monotonic clock of this computer.
    pub fn own() -> Clock {
        Clock(Kind::Own(Monotonic::new()))
    }

    /// The clock of an emulated bench at `host:port`.
    ///
    /// # Errors
    /// A bench that cannot be reached.
    pub fn twin(address: &str) -> std::io::Result<Clock> {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(TWIN_PATIENCE))?;
        let mut twin = Twin { reader: BufReader::new(stream), now: Arc::new(AtomicI64::new(0)) };
        twin.advance(0)?;
        Ok(Clock(Kind::Twin(twin)))
    }

    /// What tells its time.
    pub(crate) fn stamps(&self) -> Stamps {
        match &self.0 {
            Kind::Own(clock) => Stamps::Own(*clock),
            Kind::Twin(twin) => Stamps::Twin(Arc::clone(&twin.now)),
        }
    }
}

/// The clock of an emulated bench.
#[derive(Debug)]
pub(crate) struct Twin {
    reader: BufReader<TcpStream>,
    now: Arc<AtomicI64>,
}

/// The answer of a twin.
#[derive(Deserialize)]
struct Advanced {
    now: i64,
    #[serde(default)]
    sent: BTreeMap<String, u64>,
}

impl Twin {
    /// Lets the bench go on to a time; gives the lines that each device has sent altogether.
    ///
    /// # Errors
    /// A bench that is gone.
    pub fn advance(&mut self, to_ns: i64) -> std::io::Result<BTreeMap<String, u64>> {
        writeln!(self.reader.get_mut(), "{{\"advance\":{to_ns}}}")?;
        let mut line = String::new();
        self.reader.read_line(&mut line)?;
        let Advanced { now, sent } = serde_json::from_str(&line)?;
        self.now.store(now, Ordering::SeqCst);
        Ok(sent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_own_clock_goes_on_and_lengths_are_kept() {
        let clock = Clock::own();
        let stamps = clock.stamps();
        let first = stamps.now_ns();
        std::thread::sleep(Duration::from_millis(2));
        let later = stamps.now_ns() - first;
        assert!((2_000_000..SECOND_NS * 60).contains(&later), "{later}");
        assert_eq!((ns(Duration::from_millis(1500)), seconds(1_500_000_000)), (1_500_000_000, 1.5));
        assert_eq!(ns(Duration::MAX), i64::MAX);
    }
}
