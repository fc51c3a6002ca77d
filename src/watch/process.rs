//! A process that is waited for: ended where it is asked for or takes too long, what it says on standard error kept.

use std::fs::File;
use std::io::{Read, Result, Seek, SeekFrom};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Pause between two looks at a process.
const POLL: Duration = Duration::from_millis(20);
/// Most of standard error that is kept, bytes.
const MAX_SAID_BYTES: u64 = 16 << 10;

/// The end of a process.
#[derive(Debug)]
pub struct Ended {
    /// How it ended; `None` where it was ended from here.
    pub status: Option<ExitStatus>,
    /// The beginning of what it said on standard error.
    pub said: String,
}

/// A process that was started, in a group of its own: a request to end that a terminal sends does not reach it.
#[derive(Debug)]
pub struct Process {
    /// The process.
    pub child: std::process::Child,
    said: File,
}

impl Process {
    /// Starts a process without standard output.
    ///
    /// # Errors
    /// A program that cannot be started.
    pub fn start(command: &mut Command) -> Result<Process> {
        let said = tempfile::tempfile()?;
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let child = command.stdout(Stdio::null()).stderr(said.try_clone()?).spawn()?;
        Ok(Process { child, said })
    }

    /// Waits for its end, for `patience` at the most, and not on where `stop` says so.
    ///
    /// # Errors
    /// A process that cannot be waited for.
    pub fn wait(mut self, patience: Option<Duration>, stop: impl Fn() -> bool) -> Result<Ended> {
        let began = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait()? {
                break Some(status);
            }
            if stop() || patience.is_some_and(|patience| began.elapsed() > patience) {
                self.child.kill()?;
                self.child.wait()?;
                break None;
            }
            std::thread::sleep(POLL);
        };
        let mut said = vec![];
        self.said.seek(SeekFrom::Start(0))?;
        self.said.take(MAX_SAID_BYTES).read_to_end(&mut said)?;
        Ok(Ended { status, said: String::from_utf8_lossy(&said).trim().to_owned() })
    }
}
