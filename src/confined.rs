//! Processes that reach only what they need: files by the kernel, a short environment, an end in time.

use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// Variables of the environment that a process gets: where programs are, and the language of their messages.
const KEPT_VARIABLES: [&str; 2] = ["PATH", "LANG"];

/// Pause between two looks at a process.
const END_POLL: Duration = Duration::from_millis(10);

/// Longest wait for the rest of what a process wrote, once it has ended.
const REST_OF_OUTPUT: Duration = Duration::from_secs(1);

/// Most of standard error that is kept, bytes.
const MAX_SAID_BYTES: usize = 16 << 10;

/// Files that a process may reach besides those that any program needs to start.
#[derive(Debug, Clone, Copy)]
pub struct Reach<'a> {
    /// Files and folders that it may read.
    pub read: &'a [&'a Path],
    /// Folders in which it may write too.
    pub write: &'a [&'a Path],
}

/// What the kernel keeps a process from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Kept {
    /// Files that it need not reach.
    pub files: bool,
    /// Connections by TCP.
    pub network: bool,
}

/// A process to run.
#[derive(Debug)]
pub struct Task<'a> {
    /// Program and arguments.
    pub command: &'a [OsString],
    /// Folder that it starts in.
    pub folder: &'a Path,
    /// What it reads from standard input.
    pub input: Vec<u8>,
    /// Longest run.
    pub patience: Duration,
    /// Most that it may write to standard output, bytes.
    pub max_output_bytes: usize,
    /// What it may reach.
    pub reach: Reach<'a>,
}

/// How a process ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// By itself, or by a signal that is not ours.
    Own(ExitStatus),
    /// It took too long.
    Late,
    /// It wrote too much.
    TooMuch,
}

/// A process that has ended.
#[derive(Debug)]
pub struct Ended {
    /// How.
    pub end: End,
    /// What it wrote to standard output.
    pub out: Vec<u8>,
    /// The beginning of what it said on standard error.
    pub said: String,
    /// What the kernel kept it from.
    pub kept: Kept,
}

/// Runs a process to its end. What it left running in its process group ends with it.
///
/// # Errors
/// A program that cannot be started.
pub fn run(task: Task<'_>) -> io::Result<Ended> {
    let Some((program, arguments)) = task.command.split_first() else {
        return Err(io::ErrorKind::InvalidInput.into());
    };
    let mut command = Command::new(program);
    command.args(arguments).current_dir(task.folder).env_clear();
    let variables = KEPT_VARIABLES.into_iter().filter_map(|name| Some((name, std::env::var_os(name)?)));
    command.envs(variables).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let (mut child, kept) = started(&mut command, &task.reach)?;
    let began = Instant::now();
    if let Some(mut pipe) = child.stdin.take() {
        // A program that does not read it may have ended by now: its answer tells.
        std::thread::spawn(move || pipe.write_all(&task.input));
    }
    let written = child.stdout.take().map(|pipe| beginning(pipe, task.max_output_bytes + 1, false));
    let said = child.stderr.take().map(|pipe| beginning(pipe, MAX_SAID_BYTES, true));
    let mut out = None;
    let too_much = |out: &Option<Vec<u8>>| out.as_ref().is_some_and(|o| o.len() > task.max_output_bytes);
    let end = loop {
        out = out.or_else(|| written.as_ref()?.try_recv().ok());
        if too_much(&out) {
            break Some(End::TooMuch);
        }
        if has_ended(&mut child)? {
            break None;
        }
        if began.elapsed() > task.patience {
            break Some(End::Late);
        }
        std::thread::sleep(END_POLL);
    };
    end_group(&mut child);
    let status = child.wait()?;
    let rest = |pipe: Option<Receiver<Vec<u8>>>| pipe.and_then(|p| p.recv_timeout(REST_OF_OUTPUT).ok());
    let out = out.or_else(|| rest(written));
    let end = end.unwrap_or(if too_much(&out) { End::TooMuch } else { End::Own(status) });
    let said = String::from_utf8_lossy(&rest(said).unwrap_or_default()).trim().to_owned();
    Ok(Ended { end, out: out.unwrap_or_default(), said, kept })
}

/// Starts a process within its reach. The rules bind the thread that sets them and what it starts, so it is one of its own.
fn started(command: &mut Command, reach: &Reach<'_>) -> io::Result<(Child, Kept)> {
    std::thread::scope(|scope| {
        let confined = scope.spawn(|| {
            let kept = confine(reach);
            command.spawn().map(|child| (child, kept))
        });
        confined.join().unwrap_or_else(|_| Err(io::ErrorKind::Other.into()))
    })
}

/// Reads the beginning of a pipe on a thread of its own; `drained` reads on to its end without keeping it.
fn beginning(mut pipe: impl Read + Send + 'static, bytes: usize, drained: bool) -> Receiver<Vec<u8>> {
    let (send, receive) = mpsc::channel();
    std::thread::spawn(move || {
        let mut kept = vec![];
        let _ = (&mut pipe).take(bytes as u64).read_to_end(&mut kept);
        let _ = send.send(kept);
        if drained {
            let _ = io::copy(&mut pipe, &mut io::sink());
        }
    });
    receive
}

/// True for a process that has ended. It is not reaped, so that its group keeps its number until it is ended.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    use rustix::process::{WaitId, WaitIdOptions, waitid};
    let Some(pid) = pid(child) else { return Ok(true) };
    let how = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT | WaitIdOptions::NOHANG;
    Ok(waitid(WaitId::Pid(pid), how)?.is_some())
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    Ok(child.try_wait()?.is_some())
}

/// Ends a process with all of its group.
#[cfg(unix)]
fn end_group(child: &mut Child) {
    use rustix::process::{Signal, kill_process_group};
    if let Some(pid) = pid(child) {
        // One that has ended already leaves nobody to end.
        let _ = kill_process_group(pid, Signal::KILL);
    }
}

#[cfg(not(unix))]
fn end_group(child: &mut Child) {
    let _ = child.kill();
}

#[cfg(unix)]
fn pid(child: &Child) -> Option<rustix::process::Pid> {
    i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw)
}

/// Where programs, libraries and their settings are that any program needs in order to start.
#[cfg(target_os = "linux")]
const SYSTEM: [&str; 10] = [
    "/bin",
    "/sbin",
    "/usr",
    "/lib",
    "/lib64",
    "/etc/alternatives",
    "/etc/ld.so.cache",
    "/dev/urandom",
    "/dev/zero",
    "/sys/devices/system/cpu",
];

/// Confines this thread and what it starts as far as the kernel can, and gives how far that is.
#[cfg(target_os = "linux")]
pub fn confine(reach: &Reach<'_>) -> Kept {
    use landlock::ABI;
    // From the newest rules that are known here to the first version that also confines truncation.
    for (abi, network) in [(ABI::V6, true), (ABI::V4, true), (ABI::V3, false)] {
        if restrict(reach, abi, network).is_ok() {
            return Kept { files: true, network };
        }
    }
    Kept::default()
}

#[cfg(not(target_os = "linux"))]
pub fn confine(_reach: &Reach<'_>) -> Kept {
    Kept::default()
}

/// Confines this thread by one version of the rules, in full or not at all.
#[cfg(target_os = "linux")]
fn restrict(reach: &Reach<'_>, abi: landlock::ABI, network: bool) -> Result<(), landlock::RulesetError> {
    use landlock::{
        ABI, Access, AccessFs, AccessNet, CompatLevel, Compatible, Ruleset, RulesetAttr, RulesetCreatedAttr,
        Scope, path_beneath_rules,
    };
    let mut rules = Ruleset::default()
        .set_compatibility(CompatLevel::HardRequirement)
        .handle_access(AccessFs::from_all(abi))?;
    if network {
        rules = rules.handle_access(AccessNet::from_all(abi))?;
    }
    if abi >= ABI::V6 {
        // Neither signals to other processes nor sockets of theirs without a file.
        rules = rules.scope(Scope::from_all(abi))?;
    }
    rules
        .create()?
        .add_rules(path_beneath_rules(SYSTEM, AccessFs::from_read(abi)))?
        .add_rules(path_beneath_rules(reach.read, AccessFs::from_read(abi)))?
        .add_rules(path_beneath_rules(["/dev/null"], AccessFs::from_file(abi)))?
        .add_rules(path_beneath_rules(reach.write, AccessFs::from_all(abi)))?
        .restrict_self()
        .map(|_| ())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, folder: &Path, patience_s: f64) -> Ended {
        let command = ["/bin/sh", "-c", script].map(OsString::from);
        run(Task {
            command: &command,
            folder,
            input: b"asked\n".to_vec(),
            patience: Duration::from_secs_f64(patience_s),
            max_output_bytes: 100,
            reach: Reach { read: &[], write: &[folder] },
        })
        .unwrap()
    }

    #[test]
    fn a_process_is_asked_answers_and_ends_with_its_group() {
        let folder = tempfile::tempdir().unwrap();
        let ended = shell("read line; echo \"$line and told\"; echo why >&2; exit 7", folder.path(), 60.0);
        assert!(matches!(ended.end, End::Own(status) if status.code() == Some(7)), "{ended:?}");
        assert_eq!((ended.out.as_slice(), ended.said.as_str()), (b"asked and told\n".as_slice(), "why"));
        let began = Instant::now();
        let ended = shell("sleep 600 & sleep 600", folder.path(), 0.2);
        assert_eq!(ended.end, End::Late);
        // A process of the group that lived on would hold the pipe open.
        assert!(began.elapsed() < Duration::from_secs(20));
        assert_eq!(shell("while :; do echo much; done", folder.path(), 60.0).end, End::TooMuch);
        let ended = shell("env", folder.path(), 60.0);
        let said = String::from_utf8(ended.out).unwrap();
        assert!(!said.contains("CARGO") && !said.contains("HOME="), "{said}");
    }

    #[test]
    fn a_process_writes_in_its_folder_and_nowhere_else() {
        let (inside, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let at = outside.path().join("escaped");
        let ended = shell(&format!("echo x > own; echo x > '{}'", at.display()), inside.path(), 60.0);
        assert!(inside.path().join("own").is_file());
        assert_eq!(at.exists(), !ended.kept.files, "{ended:?}");
    }
}
