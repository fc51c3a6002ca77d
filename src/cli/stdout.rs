//! Standard output. Every write and every flush is checked: what did not reach a disk that is full was not said, and the command
//! did not succeed. A reader that went away (`| head`) is no error.

use anstream::{AutoStream, ColorChoice};
use std::io::{self, ErrorKind, Write};
use std::sync::{Mutex, PoisonError};

/// The first failure of this process.
static FIRST_FAILURE: Mutex<Option<io::Error>> = Mutex::new(None);

/// Writes bytes as they are.
pub fn write(bytes: &[u8]) {
    let mut out = io::stdout().lock();
    check(out.write_all(bytes).and_then(|()| out.flush()));
}

/// Writes text with its control sequences, or without them where colours are not wanted.
pub fn write_styled(text: &str) {
    let mut out = AutoStream::new(io::stdout().lock(), choice());
    check(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
}

/// Takes note of what came of a write.
pub fn check(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        FIRST_FAILURE.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }
}

/// The first failure of this process, everything that waits written out; `None` where all was written.
pub fn failure() -> Option<io::Error> {
    check(io::stdout().lock().flush());
    FIRST_FAILURE.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// The choice of colours: `NO_COLOR`, `CLICOLOR`, `CLICOLOR_FORCE`, `TERM`, and whether standard output is a terminal.
pub fn choice() -> ColorChoice {
    AutoStream::choice(&io::stdout())
}
