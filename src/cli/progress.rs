//! Progress on stderr, when it is a terminal and the work takes more than about a second.

use crate::i18n::{Lang, Localize, Note, visible};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// A progress bar that stays silent for short work and where nobody watches.
pub struct Progress {
    bar: ProgressBar,
    began: Instant,
    shown: bool,
}

impl Progress {
    /// Begins, hidden.
    pub fn new() -> Progress {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) =
            ProgressStyle::with_template("{msg:18} {bar:32} {percent:>3} % {bytes_per_sec} {eta}")
        {
            bar.set_style(style);
        }
        Progress { bar, began: Instant::now(), shown: false }
    }

    /// The same for work that is counted in steps, and not in bytes.
    pub fn of_steps() -> Progress {
        let progress = Progress::new();
        if let Ok(style) = ProgressStyle::with_template("{msg:28} {bar:32} {percent:>3} % {eta}") {
            progress.bar.set_style(style);
        }
        progress
    }

    /// Another piece of work begins.
    pub fn name(&mut self, message: &str) {
        self.bar.set_message(visible(message).into_owned());
        self.bar.reset_eta();
    }

    /// Says how far the work is.
    pub fn update(&mut self, message: &str, done: u64, total: u64) {
        if !self.shown && self.began.elapsed() > Duration::from_secs(1) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.set_message(visible(message).into_owned());
            self.shown = true;
        }
        self.bar.set_length(total.max(done));
        self.bar.set_position(done);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Progress of several pieces of work, one after the other.
pub struct Watch {
    bar: Progress,
    doing: &'static str,
    said: String,
    lang: Lang,
}

impl Watch {
    /// Begins, hidden.
    pub fn new(lang: Lang) -> Watch {
        Watch { bar: Progress::of_steps(), doing: "", said: String::new(), lang }
    }

    /// Says what is done, and how far it is.
    pub fn of(&mut self, p: crate::mismatch::Progress) {
        if p.doing != self.doing {
            self.doing = p.doing;
            self.said = Note::new(p.doing).say(self.lang);
            self.bar.name(&self.said);
        }
        self.bar.update(&self.said, p.done, p.total);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish();
    }
}
