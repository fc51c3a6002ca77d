//! Progress on standard error, where somebody watches and the work takes more than about a second.

use crate::i18n::{Lang, Localize, Note, note, visible};
use crate::report::number::limit_digits;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle, TermLike};
use std::fmt::Write as _;
use std::io::{IsTerminal, Write};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time after which progress is shown; work that is done sooner shows none.
const SHOWN_AFTER: Duration = Duration::from_secs(1);
/// Time between two states of a bar to which nothing was reported.
const REDRAW_INTERVAL: Duration = Duration::from_millis(250);
/// The variable that turns progress off (`never`), or on for a log (`always`).
const PROGRESS_VARIABLE: &str = "SAGNAC_PROGRESS";

/// The place that progress is shown in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Display {
    /// Nowhere.
    Never,
    /// On standard error, a terminal.
    Terminal,
    /// On standard error, whatever it is: a line for each state.
    Lines,
}

impl Display {
    /// The place where progress is shown, unless the user wants quiet: by `SAGNAC_PROGRESS`, and by what standard error is.
    pub fn unless(quiet: bool) -> Display {
        let asked = std::env::var(PROGRESS_VARIABLE).unwrap_or_default();
        let terminal = std::io::stderr().is_terminal();
        match asked.as_str() {
            _ if quiet => Display::Never,
            "never" => Display::Never,
            "always" if !terminal => Display::Lines,
            _ if terminal => Display::Terminal,
            _ => Display::Never,
        }
    }
}

/// The unit that work is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Bytes of files.
    Bytes,
    /// Rows of a recording.
    Rows,
    /// Units of a lot.
    Units,
    /// Steps of a calculation.
    Steps,
    /// Nothing: only the time that has passed is shown.
    Time,
}

/// A bar that stays hidden for short work and where nobody watches.
pub struct Progress {
    bar: ProgressBar,
    lang: Lang,
    doing: Option<(Measure, String)>,
    /// The time after which the bar is shown, and its place; taken when the work begins.
    pending: Option<(Duration, ProgressDrawTarget)>,
    /// Ends the thread that shows the bar.
    reveal: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Begins, hidden.
    pub fn new(display: Display, lang: Lang) -> Progress {
        let pending = match display {
            Display::Never => None,
            Display::Terminal => Some((SHOWN_AFTER, ProgressDrawTarget::stderr())),
            Display::Lines => {
                let log = Box::new(Log(std::io::stderr()));
                Some((Duration::ZERO, ProgressDrawTarget::term_like_with_hz(log, 2)))
            }
        };
        Progress::shown(pending, lang)
    }

    /// One that is never shown.
    pub fn silent(lang: Lang) -> Progress {
        Progress::new(Display::Never, lang)
    }

    fn shown(pending: Option<(Duration, ProgressDrawTarget)>, lang: Lang) -> Progress {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        Progress { bar, lang, doing: None, pending, reveal: None }
    }

    /// Shows the bar when its time has come.
    fn reveal(&mut self) {
        let Some((patience, target)) = self.pending.take() else { return };
        let bar = self.bar.clone();
        let show = move || {
            bar.set_draw_target(target);
            bar.tick();
            bar.enable_steady_tick(REDRAW_INTERVAL);
        };
        if patience.is_zero() {
            return show();
        }
        let (stop, stopped) = channel();
        let wait = move || {
            if stopped.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
                show();
            }
        };
        self.reveal = Some((stop, std::thread::spawn(wait)));
    }

    /// The language.
    pub fn lang(&self) -> Lang {
        self.lang
    }

    /// Says what is done, and how much of how much.
    pub fn update(&mut self, doing: &str, measure: Measure, done: u64, total: u64) {
        if self.doing.as_ref().is_none_or(|d| d.0 != measure || d.1 != doing) {
            self.bar.reset();
            self.bar.set_message(visible(doing).into_owned());
            self.bar.set_style(style(measure, self.lang));
            self.doing = Some((measure, doing.to_owned()));
        }
        self.bar.set_length(total.max(done));
        self.bar.set_position(done);
        self.reveal();
    }

    /// Says what is done, of which nothing tells how long it takes.
    pub fn stage(&mut self, key: &'static str) {
        let doing = Note::new(key).say(self.lang);
        self.update(&doing, Measure::Time, 0, 0);
    }

    /// Says how far reading a file is; what follows it is evaluation.
    pub fn reading(&mut self, label: &str, done: u64, total: u64) {
        if done >= total && total > 0 {
            self.stage("progress.evaluating");
        } else {
            self.update(label, Measure::Bytes, done, total);
        }
    }

    /// Says how far an explanation is.
    pub fn explaining(&mut self, p: crate::mismatch::Progress) {
        let measure = if p.doing == "explain.progress.reading" { Measure::Bytes } else { Measure::Steps };
        let doing = Note::new(p.doing).say(self.lang);
        self.update(&doing, measure, p.done, p.total);
    }

    /// Prints something above the bar.
    pub fn beside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        self.pending = None;
        if let Some((stop, thread)) = self.reveal.take() {
            drop(stop);
            // It never panics, and waits no longer than for the message just sent.
            let _ = thread.join();
        }
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// The line of a bar.
fn style(measure: Measure, lang: Lang) -> ProgressStyle {
    let template = match measure {
        Measure::Time => "{msg} {spinner} {passed}",
        Measure::Units => "{msg} {bar:24} {pos}/{len} · {rate} · {left}",
        _ => "{msg} {bar:24} {percent:>3} % · {rate} · {left}",
    };
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = out.write_str(&rate(state.per_sec(), measure, lang));
        })
        .with_key("left", move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let known = state.pos() > 0;
            let time = if known { clock(state.eta().as_secs()) } else { "–".to_owned() };
            let _ = out.write_str(&note!("progress.left", time).say(lang));
        })
        .with_key("passed", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = out.write_str(&clock(state.elapsed().as_secs()));
        })
}

/// The speed of the work.
fn rate(per_second: f64, measure: Measure, lang: Lang) -> String {
    let (key, value) = match measure {
        Measure::Bytes => ("progress.bytes", per_second / 1e6),
        Measure::Rows => ("progress.rows", per_second),
        Measure::Units => ("progress.units", 60.0 * per_second),
        Measure::Steps | Measure::Time => ("progress.steps", per_second),
    };
    let value = if value > 0.0 { limit_digits(value, 3, lang) } else { "–".to_owned() };
    Note::new(key).with("value", value).say(lang)
}

/// A time as `m:ss` or `h:mm:ss`.
fn clock(seconds: u64) -> String {
    let mut out = String::new();
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    let _ = match hours {
        0 => write!(out, "{minutes}:{:02}", seconds % 60),
        _ => write!(out, "{hours}:{minutes:02}:{:02}", seconds % 60),
    };
    out
}

/// A log in place of a terminal: every state is a line of its own, and nothing is cleared.
#[derive(Debug)]
struct Log<W>(W);

impl<W> TermLike for Log<W>
where
    W: std::fmt::Debug + Send + Sync,
    for<'a> &'a W: Write,
{
    fn width(&self) -> u16 {
        100
    }

    fn move_cursor_up(&self, _: usize) -> std::io::Result<()> {
        Ok(())
    }

    fn move_cursor_down(&self, _: usize) -> std::io::Result<()> {
        Ok(())
    }

    fn move_cursor_right(&self, _: usize) -> std::io::Result<()> {
        Ok(())
    }

    fn move_cursor_left(&self, _: usize) -> std::io::Result<()> {
        Ok(())
    }

    fn write_line(&self, line: &str) -> std::io::Result<()> {
        self.write_str(line)
    }

    fn write_str(&self, text: &str) -> std::io::Result<()> {
        match text.trim() {
            "" => Ok(()),
            line => writeln!(&self.0, "{line}"),
        }
    }

    fn clear_line(&self) -> std::io::Result<()> {
        Ok(())
    }

    fn flush(&self) -> std::io::Result<()> {
        (&self.0).flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Text that was drawn.
    #[derive(Debug, Clone, Default)]
    struct Drawn(Arc<Mutex<Vec<u8>>>);

    impl Write for &Drawn {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    fn drawn(patience: Duration, lang: Lang, work: impl FnOnce(&mut Progress)) -> String {
        let drawn = Drawn::default();
        let target = ProgressDrawTarget::term_like_with_hz(Box::new(Log(drawn.clone())), 100);
        let mut progress = Progress::shown(Some((patience, target)), lang);
        work(&mut progress);
        progress.finish();
        String::from_utf8(drawn.0.lock().unwrap().clone()).unwrap()
    }

    fn reading(progress: &mut Progress) {
        for i in 0..=20 {
            progress.reading("reading", i * 1_000_000, 40_000_000);
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    #[test]
    fn a_long_reading_shows_rate_and_remaining_time() {
        let text = drawn(Duration::ZERO, Lang::En, reading);
        let states: Vec<&str> = text.lines().filter(|l| l.contains('█')).collect();
        let told = |l: &&str| l.contains(" % · ") && l.contains(" MB/s · ") && l.ends_with(" left");
        assert!(states.len() > 3 && states.iter().all(|l| told(&l.trim_end())), "{text}");
        assert!(!states.iter().any(|l| l.contains('–')), "{text}");
        let text = drawn(Duration::ZERO, Lang::Ru, reading);
        assert!(text.contains(" МБ/с") && text.contains("осталось 0:0"), "{text}");
    }

    #[test]
    fn short_work_shows_nothing() {
        assert_eq!(drawn(Duration::from_secs(60), Lang::En, reading), "");
    }

    #[test]
    fn what_follows_the_reading_is_evaluation_and_units_are_counted() {
        let text = drawn(Duration::ZERO, Lang::En, |p| {
            p.reading("reading", 7, 7);
            std::thread::sleep(Duration::from_millis(50));
        });
        assert!(text.contains("evaluating"), "{text}");
        let text = drawn(Duration::ZERO, Lang::En, |p| {
            p.update("testing", Measure::Units, 3, 40);
            std::thread::sleep(Duration::from_millis(50));
        });
        assert!(text.contains("3/40") && text.contains("units/min"), "{text}");
    }

    #[test]
    fn times_and_rates_are_short() {
        assert_eq!([clock(5), clock(65), clock(3725)], ["0:05", "1:05", "1:02:05"]);
        assert_eq!(rate(12_345_678.0, Measure::Bytes, Lang::En), "12.3 MB/s");
        assert_eq!(rate(0.5, Measure::Units, Lang::Ru), "30 изделий/мин");
        assert_eq!(rate(0.0, Measure::Rows, Lang::En), "– rows/s");
    }
}
