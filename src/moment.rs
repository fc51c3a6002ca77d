//! The moment it is.

use chrono::{DateTime, Utc};
use std::time::SystemTime;

/// The moment by the clock of the computer, which may be set to a time before 1970.
pub fn now() -> DateTime<Utc> {
    of_clock(SystemTime::now())
}

fn of_clock(time: SystemTime) -> DateTime<Utc> {
    time.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_clock_before_1970_tells_a_moment() {
        let early = SystemTime::UNIX_EPOCH - Duration::from_millis(1500);
        assert_eq!(of_clock(early).to_rfc3339(), "1969-12-31T23:59:58.500+00:00");
    }
}
