//! A device at work: its link, what it was asked, what it said last.

use crate::clock::seconds;
use crate::clock_steps::ClockSteps;
use crate::fault::Fault;
use crate::inbox::{Sender, after};
use crate::link::Connection;
use crate::motion::Asked;
use crate::parts::Row;
use crate::protocol::{self, Hello, Said};
use crate::setup::{Bench, Demand, Device, Language, Text, VALUE_PLACE};
use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::time::Duration;

/// Largest distance between the stamp of a driver and the arrival of its line.
const FURTHEST_STAMP: Duration = Duration::from_secs(60);
/// Time after which a device that has said nothing so far is asked again.
const RETRY_PAUSE: Duration = Duration::from_secs(1);
/// Most characters of an unreadable line that are kept.
const MAX_SHOWN: usize = 200;

/// Something that was asked of a device and is not answered.
#[derive(Debug, Clone)]
struct Pending {
    id: u64,
    asked_ns: i64,
    what: Question,
}

#[derive(Debug, Clone, PartialEq)]
enum Question {
    /// Where it is.
    Poll,
    /// A command.
    Command(String),
    /// To go into the safe state.
    Safe(String),
}

/// What was asked for, and since when it is not there.
#[derive(Debug, Clone)]
struct Wanted {
    value: f64,
    pace_per_s: f64,
    set_ns: i64,
    is_reached: bool,
    off_since_ns: Option<i64>,
    /// What was read when it was asked for first; it may be read until the value was reached.
    began_at: Option<f64>,
}

/// What a line told.
#[derive(Debug, PartialEq)]
pub(crate) enum Told {
    /// A row of the recording.
    Row(Row),
    /// A quantity is where it was asked to be.
    Reached(String, f64),
    /// An event of the device.
    Event(String, String),
    /// The clock of the device made a step, s.
    ClockStep(f64),
    /// A line that is none, shortened.
    Unreadable(String),
    /// It introduced itself.
    Hello,
}

/// What came of a safe state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SafeState {
    /// The device said that it is safe.
    Confirmed,
    /// The commands were sent; the device answers none.
    Sent,
    /// It could not be told, or did not confirm.
    Failed,
}

impl SafeState {
    /// Its name in the events.
    pub fn name(self) -> &'static str {
        match self {
            SafeState::Confirmed => "confirmed",
            SafeState::Sent => "sent",
            SafeState::Failed => "failed",
        }
    }
}

/// A device at work.
pub(crate) struct Machine<'b> {
    pub device: &'b Device,
    pub hello: Option<Hello>,
    pub safe: Option<SafeState>,
    link: Option<Connection>,
    /// Names of the columns, in the order of a row.
    columns: Vec<String>,
    heard_ns: i64,
    pending: VecDeque<Pending>,
    next_poll_ns: i64,
    next_id: u64,
    wanted: BTreeMap<String, Wanted>,
    latest: BTreeMap<String, f64>,
    steps: ClockSteps,
}

impl<'b> Machine<'b> {
    /// Opens the link to a device.
    ///
    /// # Errors
    /// A device that is not there.
    pub fn open(
        device: &'b Device,
        folder: &Path,
        sender: Sender,
        now_ns: i64,
    ) -> Result<Machine<'b>, Fault> {
        let said = folder.join(format!("{}.log", device.id));
        let link = Connection::open(&device.link, device.patience, &said, sender)
            .map_err(|e| Fault::Unreachable { device: device.id.clone(), reason: e.to_string() })?;
        let columns = match &device.language {
            Language::Json => vec![],
            Language::Text(text) => kept_columns(text),
        };
        Ok(Machine {
            device,
            hello: None,
            safe: None,
            link: Some(link),
            columns,
            heard_ns: now_ns,
            pending: VecDeque::new(),
            next_poll_ns: now_ns,
            next_id: 1,
            wanted: BTreeMap::new(),
            latest: BTreeMap::new(),
            steps: ClockSteps::new(device.clock_step.as_secs_f64()),
        })
    }

    fn id(&self) -> String {
        self.device.id.clone()
    }

    fn text(&self) -> Option<&'b Text> {
        match &self.device.language {
            Language::Json => None,
            Language::Text(text) => Some(text),
        }
    }

    /// Names of the columns as they stand in a file.
    pub fn header(&self) -> Vec<String> {
        match &self.hello {
            Some(hello) => hello.channels.iter().map(protocol::Channel::column).collect(),
            None => self.columns.clone(),
        }
    }

    /// True where it may tell its own time.
    pub fn has_clock(&self) -> bool {
        self.text().is_none_or(|text| text.device_time.is_some())
    }

    /// True when it has introduced itself and said something.
    pub fn is_ready(&self) -> bool {
        (self.hello.is_some() || self.text().is_some()) && !self.latest.is_empty()
    }

    /// True where an answer is outstanding.
    pub fn is_asked(&self) -> bool {
        self.link.is_some() && !self.pending.is_empty()
            || self.device.language == Language::Json && self.hello.is_none()
    }

    /// True where what was asked of a quantity is there.
    pub fn has_reached(&self, quantity: &str) -> bool {
        self.wanted.get(quantity).is_none_or(|wanted| wanted.is_reached)
    }

    /// When it is next to be asked or is overdue, ns.
    pub fn next_ns(&self) -> i64 {
        let silent = after(self.heard_ns, self.device.heartbeat);
        let answer = self.pending.front().map_or(i64::MAX, |p| after(p.asked_ns, self.device.patience));
        let poll = if self.polls() && !self.is_polled() { self.next_poll_ns } else { i64::MAX };
        silent.min(answer).min(poll)
    }

    /// True where the answer to a question is outstanding.
    fn is_polled(&self) -> bool {
        self.pending.iter().any(|p| p.what == Question::Poll)
    }

    fn polls(&self) -> bool {
        self.link.is_some() && self.text().is_some_and(|text| !text.poll.is_empty())
    }

    /// Asks where it is, when that is due.
    ///
    /// # Errors
    /// A link that is broken.
    pub fn poll(&mut self, now_ns: i64) -> Result<(), Fault> {
        if !self.is_ready() {
            // It may not be switched on yet.
            self.pending.retain(|p| now_ns < after(p.asked_ns, RETRY_PAUSE));
        }
        let Some(text) =
            self.text().filter(|_| self.polls() && now_ns >= self.next_poll_ns && !self.is_polled())
        else {
            return Ok(());
        };
        // A poll that came too late is not made up for.
        self.next_poll_ns = after(self.next_poll_ns, text.period).max(now_ns);
        self.ask(&text.poll, Some(Question::Poll), now_ns)
    }

    /// Asks where it is once more, whenever it was asked last.
    ///
    /// # Errors
    /// A link that is broken.
    pub fn poll_now(&mut self, now_ns: i64) -> Result<(), Fault> {
        self.next_poll_ns = now_ns;
        self.poll(now_ns)
    }

    fn ask(&mut self, line: &str, answered: Option<Question>, now_ns: i64) -> Result<(), Fault> {
        let link = self.link.as_mut().ok_or_else(|| lost(self.device, "no connection"))?;
        link.write(line).map_err(|e| lost(self.device, &e.to_string()))?;
        if let Some(what) = answered {
            self.pending.push_back(Pending { id: self.next_id, asked_ns: now_ns, what });
        }
        self.next_id += 1;
        Ok(())
    }

    /// Asks for a value.
    ///
    /// # Errors
    /// A link that is broken.
    pub fn set(&mut self, demand: &Demand, asked: &Asked, now_ns: i64) -> Result<(), Fault> {
        let quantity = &asked.quantity;
        let (line, is_answered) = match self.text() {
            None => (protocol::set(self.next_id, quantity, asked.value), true),
            Some(text) => (demand.send.replace(VALUE_PLACE, &asked.value.to_string()), text.answer.is_some()),
        };
        let question = is_answered.then(|| Question::Command(line.clone()));
        self.ask(&line, question, now_ns)?;
        let found = self.latest.get(&demand.reads).copied();
        let before = self.wanted.get(quantity);
        let is_far = before.is_none_or(|w| demand.distance(w.value, asked.value) > demand.tolerance);
        let off_since_ns =
            before.and_then(|w| w.off_since_ns).filter(|_| !is_far).or(is_far.then_some(now_ns));
        let began_at = before.map_or(found, |w| w.began_at);
        let wanted = Wanted {
            value: asked.value,
            pace_per_s: asked.pace_per_s,
            set_ns: now_ns,
            is_reached: false,
            off_since_ns,
            began_at,
        };
        self.wanted.insert(quantity.clone(), wanted);
        Ok(())
    }

    /// Forgets what was asked of a quantity, which moves with another one now.
    pub fn release(&mut self, quantity: &str) {
        self.wanted.remove(quantity);
    }

    /// Takes a line.
    ///
    /// # Errors
    /// What ends the recording.
    pub fn take(&mut self, at_ns: i64, line: &str) -> Result<Vec<Told>, Fault> {
        match self.text() {
            None => self.take_json(at_ns, line),
            Some(text) => self.take_text(text, at_ns, line),
        }
    }

    fn take_json(&mut self, at_ns: i64, line: &str) -> Result<Vec<Told>, Fault> {
        let said = match protocol::parse(line) {
            Ok(said) => said,
            Err(reason) if self.hello.is_none() => {
                return Err(Fault::NoHello { device: self.id(), reason });
            }
            Err(_) => return Ok(vec![unreadable(line)]),
        };
        self.heard_ns = at_ns;
        match said {
            // A driver that was started anew for the safe state.
            Said::Hello(_) if self.hello.is_some() => Ok(vec![]),
            Said::Hello(hello) => {
                self.columns = hello.channels.iter().map(|channel| channel.id.clone()).collect();
                self.check_hello(&hello)?;
                self.hello = Some(hello);
                Ok(vec![Told::Hello])
            }
            Said::Sample { at_ns: stamped, device_s, values } => {
                // A stamp of another clock is none.
                let is_of_ours = |stamp: &i64| stamp.abs_diff(at_ns) <= FURTHEST_STAMP.as_nanos() as u64;
                let at_ns = stamped.filter(is_of_ours).unwrap_or(at_ns);
                let values =
                    self.columns.iter().map(|c| values.get(c).and_then(serde_json::Value::as_f64)).collect();
                self.row(at_ns, at_ns, device_s, values)
            }
            Said::Answer { id, refused } => {
                let place = self.pending.iter().position(|p| p.id == id);
                let question = place.and_then(|place| self.pending.remove(place)).map(|p| p.what);
                self.answered(question, refused)
            }
            Said::Event { is_fault: true, text, .. } => Err(Fault::Reported { device: self.id(), text }),
            Said::Event { name, text, .. } => Ok(vec![Told::Event(name, text)]),
            Said::Alive => Ok(vec![]),
        }
    }

    /// The hello has what the bench relies on.
    fn check_hello(&self, hello: &Hello) -> Result<(), Fault> {
        let wrong = |reason: String| Err(Fault::NoHello { device: self.id(), reason });
        for Demand { quantity, reads, limits: [low, high], .. } in &self.device.demands {
            let Some(command) = hello.commands.iter().find(|command| command.id == *quantity) else {
                return wrong(format!("it has no command {quantity}"));
            };
            if command.min.is_some_and(|min| min > *low) || command.max.is_some_and(|max| max < *high) {
                return wrong(format!("its own limits of {quantity} are narrower than those of the bench"));
            }
            if !self.columns.contains(reads) {
                return wrong(format!("it has no channel {reads}"));
            }
        }
        Ok(())
    }

    fn take_text(&mut self, text: &Text, at_ns: i64, line: &str) -> Result<Vec<Told>, Fault> {
        let question = self.pending.front().cloned();
        match question {
            Some(Pending { what: Question::Poll, asked_ns, .. }) => {
                self.pending.pop_front();
                let Some(numbers) = numbers_of(text, line) else { return Ok(vec![unreadable(line)]) };
                self.heard_ns = at_ns;
                // It was measured between question and answer.
                self.numbers(text, asked_ns + (at_ns - asked_ns) / 2, asked_ns, numbers)
            }
            Some(Pending { what, .. }) => {
                self.pending.pop_front();
                self.heard_ns = at_ns;
                let is_fine = text.answer.as_deref().is_some_and(|answer| line.starts_with(answer));
                let refused = (!is_fine).then(|| line.to_owned());
                self.answered(Some(what), refused)
            }
            None if text.poll.is_empty() => match numbers_of(text, line) {
                Some(numbers) => {
                    self.heard_ns = at_ns;
                    self.numbers(text, at_ns, at_ns, numbers)
                }
                None => Ok(vec![unreadable(line)]),
            },
            None => Ok(vec![unreadable(line)]),
        }
    }

    fn numbers(
        &mut self,
        text: &Text,
        at_ns: i64,
        as_of_ns: i64,
        numbers: Vec<f64>,
    ) -> Result<Vec<Told>, Fault> {
        let (mut values, mut device_s) = (vec![], None);
        for (name, value) in text.columns.iter().zip(numbers) {
            if Some(name) == text.device_time.as_ref() {
                device_s = Some(value);
            } else if name != LEFT_OUT {
                values.push(Some(value));
            }
        }
        self.row(at_ns, as_of_ns, device_s, values)
    }

    fn answered(&mut self, question: Option<Question>, refused: Option<String>) -> Result<Vec<Told>, Fault> {
        match (question, refused) {
            (Some(Question::Safe(_)), None) => self.safe = Some(SafeState::Confirmed),
            (Some(Question::Safe(_)), Some(_)) => self.safe = Some(SafeState::Failed),
            (Some(Question::Command(command)), Some(answer)) => {
                return Err(Fault::Refused { device: self.id(), command, answer });
            }
            _ => {}
        }
        Ok(vec![])
    }

    /// Takes a row that was measured at a time, and not before another.
    fn row(
        &mut self,
        at_ns: i64,
        as_of_ns: i64,
        device_s: Option<f64>,
        values: Vec<Option<f64>>,
    ) -> Result<Vec<Told>, Fault> {
        for (column, value) in self.columns.iter().zip(&values) {
            if let Some(value) = value {
                self.latest.insert(column.clone(), *value);
            }
        }
        let mut told = vec![];
        for demand in &self.device.demands {
            let (quantity, found) = (&demand.quantity, self.latest.get(&demand.reads).copied());
            let Some((wanted, found)) = self.wanted.get_mut(quantity).zip(found) else { continue };
            let [low, high] = demand.limits;
            let is_on_its_way =
                wanted.began_at.is_some_and(|began| (began.min(low)..=began.max(high)).contains(&found));
            if !demand.tolerates(found) && !is_on_its_way {
                let (device, quantity) = (self.device.id.clone(), quantity.clone());
                return Err(Fault::BeyondLimit { device, quantity, found, limits: demand.limits });
            }
            let lag = wanted.pace_per_s.abs() * demand.within.as_secs_f64();
            if demand.distance(wanted.value, found) > demand.tolerance + lag {
                wanted.off_since_ns.get_or_insert(at_ns);
            } else if as_of_ns > wanted.set_ns {
                wanted.off_since_ns = None;
                wanted.began_at = None;
                if !wanted.is_reached {
                    wanted.is_reached = true;
                    told.push(Told::Reached(quantity.clone(), wanted.value));
                }
            }
        }
        told.extend(device_s.and_then(|s| self.steps.take(at_ns, s)).map(Told::ClockStep));
        told.push(Told::Row(Row { at_ns, device_s, values }));
        Ok(told)
    }

    /// What is overdue: a word of the device, an answer, a quantity that is not where it was asked to be.
    ///
    /// # Errors
    /// What ends the recording.
    pub fn check(&self, now_ns: i64) -> Result<(), Fault> {
        let device = || self.id();
        let silence_ns = now_ns - self.heard_ns;
        if silence_ns > crate::clock::ns(self.device.heartbeat) {
            return Err(Fault::Silent { device: device(), seconds: seconds(silence_ns) });
        }
        if let Some(Pending { what, asked_ns, .. }) = self.pending.front()
            && now_ns > after(*asked_ns, self.device.patience)
        {
            let command = match what {
                Question::Poll => self.text().map_or_else(String::new, |text| text.poll.clone()),
                Question::Command(command) | Question::Safe(command) => command.clone(),
            };
            return Err(Fault::Refused { device: device(), command, answer: "-".to_owned() });
        }
        for demand in &self.device.demands {
            let Some(wanted) = self.wanted.get(&demand.quantity) else { continue };
            let Some(off_ns) = wanted.off_since_ns.map(|since| now_ns - since) else { continue };
            if off_ns > crate::clock::ns(demand.within) {
                return Err(Fault::NotReached {
                    device: device(),
                    quantity: demand.quantity.clone(),
                    wanted: wanted.value,
                    found: self.latest.get(&demand.reads).copied().unwrap_or(f64::NAN),
                    seconds: seconds(off_ns),
                });
            }
        }
        Ok(())
    }

    /// The link has ended.
    pub fn lose(&mut self, reason: &str) -> Fault {
        if let Some(link) = self.link.take() {
            link.close(Duration::ZERO);
        }
        self.pending.clear();
        lost(self.device, reason)
    }

    /// Asks for the safe state, over a new connection where the old one is lost.
    pub fn make_safe(&mut self, folder: &Path, sender: Sender, now_ns: i64) {
        self.pending.clear();
        self.wanted.clear();
        if self.link.is_none() {
            let said = folder.join(format!("{}.log", self.device.id));
            self.link = Connection::open(&self.device.link, self.device.patience, &said, sender).ok();
        }
        let (lines, is_answered) = match self.text() {
            None => (vec![protocol::safe(self.next_id)], true),
            Some(text) => (text.safe.clone(), text.answer.is_some()),
        };
        self.safe = Some(if is_answered { SafeState::Failed } else { SafeState::Sent });
        for line in &lines {
            if self.ask(line, is_answered.then(|| Question::Safe(line.clone())), now_ns).is_err() {
                self.safe = Some(SafeState::Failed);
                self.pending.clear();
                return;
            }
        }
    }

    /// True where its link stands.
    pub fn is_linked(&self) -> bool {
        self.link.is_some()
    }

    /// True where an answer about the safe state is outstanding.
    pub fn is_making_safe(&self) -> bool {
        self.link.is_some() && self.pending.iter().any(|p| matches!(p.what, Question::Safe(_)))
    }

    /// Ends the link.
    pub fn close(&mut self) {
        if let Some(link) = self.link.take() {
            link.close(self.device.patience);
        }
    }
}

/// Name of a number that is left out.
const LEFT_OUT: &str = "-";

fn kept_columns(text: &Text) -> Vec<String> {
    let is_kept = |name: &&String| *name != LEFT_OUT && Some(*name) != text.device_time.as_ref();
    text.columns.iter().filter(is_kept).cloned().collect()
}

/// The numbers of a line, as many as there are columns.
fn numbers_of(text: &Text, line: &str) -> Option<Vec<f64>> {
    protocol::numbers(line).filter(|numbers| numbers.len() == text.columns.len())
}

fn lost(device: &Device, reason: &str) -> Fault {
    Fault::Lost { device: device.id.clone(), reason: reason.to_owned() }
}

fn unreadable(line: &str) -> Told {
    Told::Unreadable(line.chars().take(MAX_SHOWN).collect())
}

/// The machine and the demand of a quantity.
pub(crate) fn mover<'m, 'b>(
    machines: &'m mut [Machine<'b>],
    bench: &'b Bench,
    quantity: &str,
) -> Option<(&'m mut Machine<'b>, &'b Demand)> {
    let (device, demand) = bench.demands().get(quantity).copied()?;
    machines.iter_mut().find(|machine| machine.device.id == device.id).map(|machine| (machine, demand))
}
