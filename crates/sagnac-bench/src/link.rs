//! Links to devices: a connection, datagrams, a file that grows, a process. Each has a thread that reads lines.

use crate::inbox::{Sender, What};
use crate::setup::Link;
use std::fs::File;
use std::io::{BufRead, BufReader, Error, ErrorKind, Read, Result, Seek, SeekFrom, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Longest line, bytes.
const MAX_LINE: usize = 64 << 10;
/// Pause between two looks at a file, or at a request to end a thread.
const LOOK_PAUSE: Duration = Duration::from_millis(20);
/// Longest time that a write to a connection may take.
const WRITE_PATIENCE: Duration = Duration::from_secs(2);

/// A link that stands.
pub(crate) struct Connection {
    writer: Writer,
    is_over: Arc<AtomicBool>,
    child: Option<Child>,
}

enum Writer {
    Tcp(TcpStream),
    Udp(UdpSocket, Arc<Mutex<Option<SocketAddr>>>),
    Command(ChildStdin),
    None,
}

impl Connection {
    /// Opens a link. What a process says on standard error goes into the file `said`.
    ///
    /// # Errors
    /// A device that is not there.
    pub fn open(link: &Link, patience: Duration, said: &Path, sender: Sender) -> Result<Connection> {
        let is_over = Arc::new(AtomicBool::new(false));
        let over = Arc::clone(&is_over);
        let mut child = None;
        let writer = match link {
            Link::Tcp(address) => {
                let stream = connect(address, patience)?;
                let reader = stream.try_clone()?;
                read_on(move || lines(reader, &sender));
                Writer::Tcp(stream)
            }
            Link::Udp(address) => {
                let socket = UdpSocket::bind(address.as_str())?;
                socket.set_read_timeout(Some(LOOK_PAUSE))?;
                let peer = Arc::new(Mutex::new(None));
                let (reader, from) = (socket.try_clone()?, Arc::clone(&peer));
                read_on(move || datagrams(&reader, &from, &over, &sender));
                Writer::Udp(socket, peer)
            }
            Link::File(path) => {
                let file = File::open(path)?;
                read_on(move || tail(file, &over, &sender));
                Writer::None
            }
            Link::Command { words, folder } => {
                let mut started = start(words, folder, said)?;
                let (input, output) = (started.stdin.take(), started.stdout.take());
                child = Some(started);
                let (Some(input), Some(output)) = (input, output) else {
                    return Err(Error::from(ErrorKind::BrokenPipe));
                };
                read_on(move || lines(output, &sender));
                Writer::Command(input)
            }
        };
        Ok(Connection { writer, is_over, child })
    }

    /// Writes a line.
    ///
    /// # Errors
    /// A link that is broken, or that takes nothing.
    pub fn write(&mut self, line: &str) -> Result<()> {
        let line = format!("{line}\n");
        match &mut self.writer {
            Writer::Tcp(stream) => stream.write_all(line.as_bytes()),
            Writer::Udp(socket, peer) => {
                let peer = *peer.lock().unwrap_or_else(PoisonError::into_inner);
                let peer = peer.ok_or_else(|| Error::from(ErrorKind::NotConnected))?;
                socket.send_to(line.as_bytes(), peer).map(|_| ())
            }
            Writer::Command(input) => input.write_all(line.as_bytes()).and_then(|()| input.flush()),
            Writer::None => Err(Error::from(ErrorKind::Unsupported)),
        }
    }

    /// Ends the link. A process gets the end of its input, and time to end by itself.
    pub fn close(self, patience: Duration) {
        self.is_over.store(true, Ordering::SeqCst);
        if let Writer::Tcp(stream) = &self.writer {
            // An error says that it is over already.
            let _ = stream.shutdown(std::net::Shutdown::Both);
        }
        drop(self.writer);
        let Some(mut child) = self.child else { return };
        let began = Instant::now();
        while matches!(child.try_wait(), Ok(None)) {
            if began.elapsed() > patience {
                // An error says that it has ended meanwhile.
                let _ = child.kill();
                let _ = child.wait();
                return;
            }
            std::thread::sleep(LOOK_PAUSE);
        }
    }
}

/// A connection to one of the addresses of a name.
fn connect(address: &str, patience: Duration) -> Result<TcpStream> {
    let mut refused = Error::from(ErrorKind::AddrNotAvailable);
    for at in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&at, patience) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(WRITE_PATIENCE))?;
                return Ok(stream);
            }
            Err(e) => refused = e,
        }
    }
    Err(refused)
}

/// Starts a process in a group of its own: what ends the recording from a terminal does not end the driver before its device is
/// safe.
fn start(words: &[String], folder: &Path, said: &Path) -> Result<Child> {
    let (program, arguments) = words.split_first().ok_or_else(|| Error::from(ErrorKind::InvalidInput))?;
    let mut command = Command::new(program);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let said = File::options().create(true).append(true).open(said)?;
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(said)
        .spawn()
}

fn read_on(work: impl FnOnce() + Send + 'static) {
    std::thread::spawn(work);
}

/// Reads lines to their end.
fn lines(source: impl Read, sender: &Sender) {
    let mut reader = BufReader::new(source);
    let mut line = vec![];
    let why = loop {
        line.clear();
        match reader.by_ref().take(MAX_LINE as u64 + 1).read_until(b'\n', &mut line) {
            Ok(0) => break "end of the connection".to_owned(),
            Ok(_) if line.len() > MAX_LINE => break format!("a line of more than {MAX_LINE} bytes"),
            // The last line may be cut.
            Ok(_) if !line.ends_with(b"\n") => {}
            Ok(_) => {
                if !put(&line, sender) {
                    return;
                }
            }
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) => break e.to_string(),
        }
    };
    sender.put(What::Ended(why));
}

/// Puts a line that is not blank; false where nobody listens any more.
fn put(line: &[u8], sender: &Sender) -> bool {
    let text = String::from_utf8_lossy(line);
    let text = text.trim();
    text.is_empty() || sender.put(What::Line(text.to_owned()))
}

fn datagrams(socket: &UdpSocket, peer: &Mutex<Option<SocketAddr>>, over: &AtomicBool, sender: &Sender) {
    let mut datagram = vec![0; MAX_LINE];
    while !over.load(Ordering::SeqCst) {
        match socket.recv_from(&mut datagram) {
            Ok((bytes, from)) => {
                *peer.lock().unwrap_or_else(PoisonError::into_inner) = Some(from);
                for line in datagram.get(..bytes).unwrap_or_default().split(|b| *b == b'\n') {
                    if !put(line, sender) {
                        return;
                    }
                }
            }
            Err(e)
                if matches!(
                    e.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) => {}
            Err(e) => {
                sender.put(What::Ended(e.to_string()));
                return;
            }
        }
    }
}

/// Reads the lines that are appended to a file from now on, and all of it where it is begun anew.
fn tail(mut file: File, over: &AtomicBool, sender: &Sender) {
    let mut line = vec![];
    let why = match file.seek(SeekFrom::End(0)) {
        Ok(mut at) => loop {
            if over.load(Ordering::SeqCst) {
                return;
            }
            match appended(&mut file, &mut at, &mut line, sender) {
                Ok(true) => {}
                Ok(false) => std::thread::sleep(LOOK_PAUSE),
                Err(e) => break e.to_string(),
            }
        },
        Err(e) => e.to_string(),
    };
    sender.put(What::Ended(why));
}

/// Takes what was appended; false where nothing was.
fn appended(file: &mut File, at: &mut u64, line: &mut Vec<u8>, sender: &Sender) -> Result<bool> {
    if file.metadata()?.len() < *at {
        *at = file.seek(SeekFrom::Start(0))?;
        line.clear();
    }
    let mut block = [0; 1 << 14];
    let read = file.read(&mut block)?;
    *at += read as u64;
    for piece in block.get(..read).unwrap_or_default().split_inclusive(|b| *b == b'\n') {
        line.extend_from_slice(piece);
        if line.len() > MAX_LINE {
            return Err(Error::new(ErrorKind::InvalidData, format!("a line of more than {MAX_LINE} bytes")));
        }
        if line.ends_with(b"\n") {
            put(line, sender);
            line.clear();
        }
    }
    Ok(read > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Clock;
    use crate::inbox::Inbox;
    use std::net::TcpListener;

    /// What an inbox has within two seconds.
    fn heard(inbox: &mut Inbox, count: usize) -> Vec<String> {
        let (began, mut found) = (Instant::now(), vec![]);
        while found.len() < count && began.elapsed() < Duration::from_secs(5) {
            for item in inbox.within(Duration::from_millis(50)) {
                found.push(match item.what {
                    What::Line(line) => line,
                    What::Ended(_) => "ENDED".to_owned(),
                });
            }
        }
        found
    }

    fn opened(link: Link) -> (Connection, Inbox) {
        let inbox = Inbox::new(&Clock::own(), std::iter::once("a".to_owned()));
        let said = std::env::temp_dir().join("sagnac-bench-link-test.log");
        let open = Connection::open(&link, Duration::from_secs(2), &said, inbox.sender(0));
        (open.unwrap(), inbox)
    }

    #[test]
    fn a_connection_carries_lines_both_ways_and_tells_its_end() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let (mut link, mut inbox) = opened(Link::Tcp(listener.local_addr().unwrap().to_string()));
        let (mut far, _) = listener.accept().unwrap();
        far.write_all(b"one\r\n\ntwo\ncut").unwrap();
        link.write("three").unwrap();
        let mut said = String::new();
        BufReader::new(far.try_clone().unwrap()).read_line(&mut said).unwrap();
        assert_eq!(said, "three\n");
        drop(far);
        assert_eq!(heard(&mut inbox, 3), ["one", "two", "ENDED"]);
    }

    #[test]
    fn datagrams_are_answered_to_where_they_came_from() {
        let free = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let (mut link, mut inbox) = opened(Link::Udp(free.to_string()));
        assert!(link.write("early").is_err());
        let far = UdpSocket::bind("127.0.0.1:0").unwrap();
        far.send_to(b"one\ntwo", free).unwrap();
        assert_eq!(heard(&mut inbox, 2), ["one", "two"]);
        link.write("three").unwrap();
        let mut said = [0; 16];
        let bytes = far.recv(&mut said).unwrap();
        assert_eq!(&said[..bytes], b"three\n");
        link.close(Duration::ZERO);
    }

    #[test]
    fn a_file_is_read_from_its_end_on_and_anew_where_it_is_begun_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, "old\n").unwrap();
        let (link, mut inbox) = opened(Link::File(path.clone()));
        std::thread::sleep(Duration::from_millis(100));
        let mut file = File::options().append(true).open(&path).unwrap();
        file.write_all(b"one\ntw").unwrap();
        assert_eq!(heard(&mut inbox, 1), ["one"]);
        file.write_all(b"o\n").unwrap();
        assert_eq!(heard(&mut inbox, 1), ["two"]);
        std::fs::write(&path, "3\n").unwrap();
        assert_eq!(heard(&mut inbox, 1), ["3"]);
        link.close(Duration::ZERO);
    }

    #[cfg(unix)]
    #[test]
    fn a_process_is_given_the_end_of_its_input_and_ended_where_it_goes_on() {
        let words = |script: &str| Link::Command {
            words: ["sh", "-c", script].map(str::to_owned).to_vec(),
            folder: std::env::temp_dir(),
        };
        let (mut link, mut inbox) = opened(words("read a; echo \"got $a\"; cat > /dev/null"));
        link.write("it").unwrap();
        assert_eq!(heard(&mut inbox, 1), ["got it"]);
        let began = Instant::now();
        link.close(Duration::from_secs(5));
        assert!(began.elapsed() < Duration::from_secs(4));
        let (link, _inbox) = opened(words("exec sleep 60"));
        let began = Instant::now();
        link.close(Duration::from_millis(100));
        assert!(began.elapsed() < Duration::from_secs(10));
    }

    #[test]
    fn a_line_without_end_ends_the_link() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let (_link, mut inbox) = opened(Link::Tcp(listener.local_addr().unwrap().to_string()));
        let (mut far, _) = listener.accept().unwrap();
        // The other side may have gone before all of it is written.
        let _ = far.write_all(&vec![b'x'; 2 * MAX_LINE]);
        assert_eq!(heard(&mut inbox, 1), ["ENDED"]);
    }
}
