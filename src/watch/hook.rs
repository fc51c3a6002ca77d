//! The hook command: it is told of a test by JSON on its standard input.

use super::process::Process;
use crate::i18n::{Note, io_reason, note};
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Longest run of a hook command.
const PATIENCE: Duration = Duration::from_secs(60);
/// Pause after the first failure; each further one doubles it.
const FIRST_PAUSE: Duration = Duration::from_secs(10);
/// Longest pause.
const LONGEST_PAUSE: Duration = Duration::from_secs(3600);
/// Most characters of what it says that are shown.
const MAX_SHOWN_CHARACTERS: usize = 300;

/// Tells a command of something, in a folder.
///
/// # Errors
/// A note on why it is not told: not started, failed, or took too long.
pub fn tell(command: &[String], folder: &Path, event: &impl Serialize) -> Result<(), Note> {
    let Some((program, arguments)) = command.split_first() else { return Ok(()) };
    let failed = |e: std::io::Error| {
        note!("watch.hook_not_started", program = program.as_str(), reason = io_reason(&e))
    };
    let mut json = serde_json::to_vec(event).map_err(|e| failed(e.into()))?;
    json.push(b'\n');
    let mut process =
        Process::start(Command::new(program).args(arguments).current_dir(folder).stdin(Stdio::piped()))
            .map_err(failed)?;
    // A command that does not read it may have ended by now: its exit code tells.
    if let Some(mut input) = process.child.stdin.take() {
        let _ = input.write_all(&json);
    }
    let ended = process.wait(Some(PATIENCE), || false).map_err(failed)?;
    let said: String = ended.said.chars().take(MAX_SHOWN_CHARACTERS).collect();
    let program = program.as_str();
    match ended.status {
        Some(status) if status.success() => Ok(()),
        Some(status) => {
            let code = status.code().map_or_else(|| status.to_string(), |code| code.to_string());
            Err(note!("watch.hook_failed", program, code, said))
        }
        None => Err(note!("watch.hook_slow", program, seconds = PATIENCE.as_secs())),
    }
}

/// Pause after so many failures in a row.
pub fn pause(failures: u32) -> Duration {
    let factor = 2_u32.saturating_pow(failures.saturating_sub(1).min(20));
    FIRST_PAUSE.saturating_mul(factor).min(LONGEST_PAUSE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    fn command(script: &str) -> Vec<String> {
        ["sh", "-c", script].map(str::to_owned).to_vec()
    }

    #[cfg(unix)]
    #[test]
    fn a_command_is_told_in_its_folder_and_a_failure_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let event = serde_json::json!({"serial": "SN-1; rm -rf /"});
        tell(&command("cat > told.json"), folder.path(), &event).unwrap();
        let told = std::fs::read_to_string(folder.path().join("told.json")).unwrap();
        assert_eq!(told, "{\"serial\":\"SN-1; rm -rf /\"}\n");
        let error = tell(&command("echo no network >&2; exit 7"), folder.path(), &event).unwrap_err();
        assert_eq!((&error.args["code"], &error.args["said"]), (&"7".into(), &"no network".into()));
        let error = tell(&["/nowhere/hook".to_owned()], folder.path(), &event).unwrap_err();
        assert_eq!(error.id, "watch.hook_not_started");
        tell(&[], folder.path(), &event).unwrap();
    }

    #[test]
    fn pauses_double_up_to_an_hour() {
        let seconds: Vec<u64> = [1, 2, 3, 9, 40].map(|n| pause(n).as_secs()).to_vec();
        assert_eq!(seconds, [10, 20, 40, 2560, 3600]);
    }
}
