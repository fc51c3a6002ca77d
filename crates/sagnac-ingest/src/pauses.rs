//! Times between the stretches of a test in which nothing was to be recorded: they are no gaps of the recording.

/// Where a recording may pause.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pauses {
    /// Between its files.
    pub between_files: bool,
    /// Within a file, where nothing was recorded for so long, s; `None`: nowhere.
    pub from_s: Option<f64>,
}

/// The pauses of a recording while it is read.
#[derive(Debug, Default)]
pub(super) struct Paused {
    rule: Pauses,
    /// The next row that is used is the first of its file.
    joint: bool,
    /// There is a pause before the next row that is used.
    pending: bool,
    /// Times at which samples go on after a pause, s from the start of the recording.
    pub ends_s: Vec<f64>,
}

impl Paused {
    pub fn new(rule: Pauses) -> Paused {
        Paused { rule, ..Paused::default() }
    }

    /// Another file begins; true when a pause may stand before it.
    pub fn file_begins(&mut self) -> bool {
        self.joint = self.rule.between_files;
        self.joint
    }

    /// True when what is missing before the next row is a pause; `step_s` is its length, where known.
    pub fn takes(&mut self, step_s: Option<f64>) -> bool {
        let long = step_s.zip(self.rule.from_s).is_some_and(|(step, least)| step >= least);
        self.pending |= self.joint || long;
        self.joint || long
    }

    /// Rows are passed on, the first at a time.
    pub fn passed(&mut self, elapsed_s: f64) {
        self.joint = false;
        if std::mem::take(&mut self.pending) {
            self.ends_s.push(elapsed_s);
        }
    }
}
