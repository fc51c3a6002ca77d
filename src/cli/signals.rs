//! Reaction to a request to end: unfinished files are removed first.

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// From now on, a signal that ends the program leaves no half-made folder or file behind. A signal that whoever started
/// the program has it ignore (`nohup`) stays ignored. A verb that ends by itself is left to do so.
pub fn tidy_up_on() {
    let wanted: Vec<i32> = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|s| !ignored(*s)).collect();
    let Ok(mut signals) = Signals::new(wanted) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if super::ending::request() {
                continue;
            }
            crate::output::abandon_all();
            // The parent learns that it was the signal.
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
}

/// True when a signal is ignored, as far as the system tells.
fn ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:")).map(str::trim);
    let mask = mask.and_then(|m| u64::from_str_radix(m, 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}
