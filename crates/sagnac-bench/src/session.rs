//! A recording from beginning to end.

use crate::clock::{Clock, ns, seconds};
use crate::device::{Machine, SafeState, Told, mover};
use crate::fault::Fault;
use crate::inbox::{Inbox, Item, What, after};
use crate::journal::{EVENTS_FILE, Event, Journal};
use crate::manifest::{self, MANIFEST_FILE};
use crate::motion::{Leg, Motion, TABLE_ANGLE, TABLE_RATE};
use crate::parts::Parts;
use crate::setup::{Bench, Device};
use sagnac_base::message::{Arg, Note, note};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest pause of the loop while nothing is due.
const IDLE_PAUSE: Duration = Duration::from_millis(200);
/// Most unreadable lines of a device that are entered.
const MAX_UNREADABLE: usize = 100;
/// Time for the last readings.
const LAST_READINGS: Duration = Duration::from_millis(500);

/// What is to be recorded.
pub struct Order<'a> {
    /// The bench.
    pub bench: &'a Bench,
    /// The schedule; empty without one.
    pub legs: Vec<Leg>,
    /// Length of a recording without a schedule; `None`: until it is asked to end.
    pub duration: Option<Duration>,
    /// Folder of the recording, which is empty.
    pub folder: &'a Path,
    /// Serial number of the unit, over the one that it states.
    pub serial: Option<&'a str>,
    /// Date and time of the computer, RFC 3339.
    pub at: &'a str,
}

/// How a recording ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// With its schedule or its length.
    Complete,
    /// It was asked to.
    Asked,
    /// Something went wrong.
    Fault(Fault),
}

/// What came of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// How it ended.
    pub end: End,
    /// True where it began: every device was there.
    pub began: bool,
    /// What went wrong and did not end it.
    pub remarks: Vec<Fault>,
    /// The devices with a safe state, and what came of it.
    pub safe: Vec<(String, SafeState)>,
    /// Parts of the unit.
    pub parts: usize,
    /// Rows of the unit.
    pub rows: u64,
    /// Length, s.
    pub length_s: f64,
}

/// Records. Whatever ends it, every device that has a safe state is brought into it first.
///
/// `is_asked` says whether it is to end, `tell` is told what happens.
pub fn record(
    order: &Order<'_>,
    clock: Clock,
    is_asked: &dyn Fn() -> bool,
    tell: &mut dyn FnMut(Note),
) -> Summary {
    let mut session = Session::new(order, clock, is_asked, tell);
    let end = session.run();
    session.finish(end.unwrap_or_else(End::Fault))
}

struct Session<'o> {
    order: &'o Order<'o>,
    clock: Clock,
    inbox: Inbox,
    machines: Vec<Machine<'o>>,
    parts: Vec<Parts>,
    motion: Motion,
    journal: Option<Journal>,
    began_ns: Option<i64>,
    remarks: Vec<Fault>,
    unreadable: BTreeMap<usize, usize>,
    /// Devices beside the unit of which the manifest names parts; `None` before it is written.
    named: Option<usize>,
    is_safe: bool,
    is_asked: &'o dyn Fn() -> bool,
    tell: &'o mut dyn FnMut(Note),
}

impl<'o> Session<'o> {
    fn new(
        order: &'o Order<'o>,
        clock: Clock,
        is_asked: &'o dyn Fn() -> bool,
        tell: &'o mut dyn FnMut(Note),
    ) -> Session<'o> {
        let inbox = Inbox::new(&clock, order.bench.devices.iter().map(|d| d.id.clone()));
        Session {
            order,
            clock,
            inbox,
            machines: vec![],
            parts: vec![],
            motion: Motion::new(vec![]),
            journal: None,
            began_ns: None,
            remarks: vec![],
            unreadable: BTreeMap::new(),
            named: None,
            is_safe: false,
            is_asked,
            tell,
        }
    }

    fn run(&mut self) -> Result<End, Fault> {
        let folder = self.order.folder;
        let journal = Journal::begin(folder).map_err(|e| disk(&folder.join(EVENTS_FILE), &e))?;
        self.journal = Some(journal);
        for (place, device) in self.order.bench.devices.iter().enumerate() {
            if (self.is_asked)() {
                return Ok(End::Asked);
            }
            let now = self.inbox.now_ns();
            let machine = Machine::open(device, folder, self.inbox.sender(place), now)?;
            self.parts.push(self.parts_of(&machine));
            self.machines.push(machine);
        }
        // A unit that the bench switches on says nothing before.
        let begin = self.order.bench.begin();
        let is_switched_on = !begin.is_empty();
        if !self
            .wait_until_ready(&|device| !(is_switched_on && device.is_unit && device.demands.is_empty()))?
        {
            return Ok(End::Asked);
        }
        self.begin()?;
        if is_switched_on && !self.switch_on(begin)? {
            return Ok(End::Asked);
        }
        if !self.wait_until_ready(&|_| true)? {
            return Ok(End::Asked);
        }
        (self.tell)(note!("bench_said.begins", devices = self.machines.len()));
        self.motion = Motion::new(self.order.legs.clone());
        self.go_through()
    }

    /// The parts of a device, as far as its columns are known.
    fn parts_of(&self, machine: &Machine<'_>) -> Parts {
        let length_ns = ns(self.order.bench.part);
        Parts::new(self.order.folder, &machine.device.id, &machine.header(), machine.has_clock(), length_ns)
    }

    /// Sets what is set before a schedule begins; false where it is asked to end.
    fn switch_on(&mut self, begin: BTreeMap<String, f64>) -> Result<bool, Fault> {
        self.motion = Motion::new(vec![Leg::at_rest(Duration::ZERO, begin)]);
        while !self.motion.is_done() {
            if (self.is_asked)() {
                return Ok(false);
            }
            let now = self.inbox.now_ns();
            self.machines.iter().filter(|m| m.is_ready()).try_for_each(|machine| machine.check(now))?;
            self.machines.iter_mut().try_for_each(|machine| machine.poll(now))?;
            self.move_on(now)?;
            self.listen(after(now, IDLE_PAUSE))?;
        }
        Ok(true)
    }

    /// Waits until devices have said something; false where it is asked to end.
    fn wait_until_ready(&mut self, who: &dyn Fn(&Device) -> bool) -> Result<bool, Fault> {
        let began = self.inbox.now_ns();
        loop {
            if (self.is_asked)() {
                return Ok(false);
            }
            let now = self.inbox.now_ns();
            let is_late =
                |m: &&Machine<'_>| who(m.device) && !m.is_ready() && now > after(began, m.device.patience);
            if let Some(late) = self.machines.iter().find(is_late) {
                let reason = if late.is_asked() { "no answer" } else { "no reading" };
                return Err(Fault::NoHello { device: late.device.id.clone(), reason: reason.to_owned() });
            }
            if self.machines.iter().all(|m| m.is_ready() || !who(m.device)) {
                return Ok(true);
            }
            self.machines.iter_mut().try_for_each(|machine| machine.poll(now))?;
            self.listen(after(now, IDLE_PAUSE))?;
        }
    }

    /// The recording begins: rows of the unit count from now on, readings of the others from the last one before.
    fn begin(&mut self) -> Result<(), Fault> {
        let now = self.inbox.now_ns();
        for (parts, machine) in self.parts.iter_mut().zip(&self.machines) {
            if machine.device.is_unit { parts.begin_at(now) } else { parts.begin(now) }
        }
        self.began_ns = Some(now);
        self.enter(Event::Begin { at: self.order.at })
    }

    fn go_through(&mut self) -> Result<End, Fault> {
        let began = self.inbox.now_ns();
        let mut part_ends = after(began, self.order.bench.part);
        // A recording without a schedule goes on when what is set first was reached.
        let ends =
            self.order.duration.filter(|_| self.order.legs.is_empty()).map(|length| after(began, length));
        loop {
            if (self.is_asked)() {
                return Ok(End::Asked);
            }
            let now = self.inbox.now_ns();
            self.machines.iter().try_for_each(|machine| machine.check(now))?;
            self.machines.iter_mut().try_for_each(|machine| machine.poll(now))?;
            self.move_on(now)?;
            if now >= part_ends {
                self.write(false)?;
                part_ends = after(now, self.order.bench.part);
            }
            let is_over =
                ends.map_or(!self.order.legs.is_empty() && self.motion.is_done(), |ends| now >= ends);
            if is_over {
                return Ok(End::Complete);
            }
            let due = self.machines.iter().map(Machine::next_ns).chain(self.motion.next_ns()).chain(ends);
            let until = due.min().unwrap_or(i64::MAX).min(part_ends).min(after(now, IDLE_PAUSE * 5));
            // What is due at a moment is seen just behind it.
            self.listen(until.max(now) + 1)?;
        }
    }

    /// Carries the schedule on.
    fn move_on(&mut self, now: i64) -> Result<(), Fault> {
        let (bench, machines) = (self.order.bench, &self.machines);
        let mut legs = vec![];
        let reached = |quantity: &str| machines.iter().all(|machine| machine.has_reached(quantity));
        let asked = self.motion.go_on(now, reached, |number, length_s| legs.push((number, length_s)));
        for (number, seconds) in legs {
            self.enter(Event::Leg { number, seconds })?;
            (self.tell)(note!("bench_said.leg", number, length = Arg::span(seconds)));
        }
        for asked in asked {
            let Some((machine, demand)) = mover(&mut self.machines, bench, &asked.quantity) else { continue };
            machine.set(demand, &asked, now)?;
            if asked.quantity == TABLE_RATE && asked.value != 0.0 {
                self.machines.iter_mut().for_each(|machine| machine.release(TABLE_ANGLE));
            }
            let device =
                bench.demands().get(asked.quantity.as_str()).map(|(d, _)| d.id.clone()).unwrap_or_default();
            self.enter(Event::Set { device: &device, quantity: &asked.quantity, value: asked.value })?;
        }
        Ok(())
    }

    /// Takes what devices say until a time.
    fn listen(&mut self, until_ns: i64) -> Result<(), Fault> {
        let is_asked = self.machines.iter().any(Machine::is_asked);
        for item in self.inbox.until(&mut self.clock, until_ns, is_asked)? {
            self.take(item)?;
        }
        Ok(())
    }

    fn take(&mut self, Item { device: place, at_ns, what }: Item) -> Result<(), Fault> {
        let Some(machine) = self.machines.get_mut(place) else { return Ok(()) };
        let told = match what {
            What::Ended(reason) => return Err(machine.lose(&reason)),
            What::Line(line) => machine.take(at_ns, &line)?,
        };
        for told in told {
            self.take_told(place, told)?;
        }
        Ok(())
    }

    fn take_told(&mut self, place: usize, told: Told) -> Result<(), Fault> {
        let device = self.id(place);
        match told {
            Told::Row(row) => {
                if let Some(parts) = self.parts.get_mut(place) {
                    parts.push(row);
                }
                Ok(())
            }
            Told::Hello => {
                let begun = self.machines.get(place).map(|machine| self.parts_of(machine));
                if let Some((parts, begun)) = self.parts.get_mut(place).zip(begun) {
                    *parts = begun;
                }
                let hello = self.machines.get(place).and_then(|m| m.hello.clone()).unwrap_or_default();
                let (name, model, serial) = (&hello.name, &hello.model, &hello.serial);
                self.enter(Event::Device { device: &device, name, model, serial })
            }
            Told::Reached(quantity, value) => {
                self.enter(Event::Reached { device: &device, quantity: &quantity, value })
            }
            Told::Event(name, text) => self.enter(Event::Told { device: &device, name: &name, text: &text }),
            Told::ClockStep(seconds) => {
                let fault = Fault::ClockStep { device, seconds };
                self.enter(Event::Wrong(&fault))?;
                (self.tell)(fault.note());
                self.remarks.push(fault);
                Ok(())
            }
            Told::Unreadable(line) => {
                let count = self.unreadable.entry(place).or_default();
                *count += 1;
                if *count > MAX_UNREADABLE {
                    return Ok(());
                }
                self.enter(Event::Unreadable { device: &device, line: &line })
            }
        }
    }

    fn id(&self, place: usize) -> String {
        self.machines.get(place).map(|machine| machine.device.id.clone()).unwrap_or_default()
    }

    fn enter(&mut self, event: Event<'_>) -> Result<(), Fault> {
        let now = self.inbox.now_ns();
        let t_s = seconds(now - self.began_ns.unwrap_or(now));
        let Some(journal) = &mut self.journal else { return Ok(()) };
        journal.add(t_s, event).map_err(|e| disk(&self.order.folder.join(EVENTS_FILE), &e))
    }

    /// Writes the rows so far; those of the unit as far as the other devices have been read, or all.
    ///
    /// The manifest is there before the first part of the unit, and each device in it has a part: a recording can be read at any
    /// moment.
    fn write(&mut self, all: bool) -> Result<(), Fault> {
        let Some(zero) = self.began_ns else { return Ok(()) };
        let disk_of = |(path, e): (PathBuf, std::io::Error)| disk(&path, &e);
        let (mut units, mut others): (Vec<_>, Vec<_>) =
            self.parts.iter_mut().zip(&self.machines).partition(|(_, machine)| machine.device.is_unit);
        let mut to = i64::MAX;
        for (parts, _) in &mut others {
            parts.write(i64::MAX, zero).map_err(disk_of)?;
            to = to.min(parts.latest.as_ref().map_or(i64::MAX, |row| row.at_ns));
        }
        let folder = self.order.folder;
        for (unit, machine) in &mut units {
            let beside: Vec<&Parts> =
                others.iter().map(|(parts, _)| &**parts).filter(|p| p.written > 0).collect();
            if self.named != Some(beside.len()) {
                let stated = machine.hello.as_ref().map(|hello| hello.serial.as_str());
                let serial = self.order.serial.or(stated.filter(|serial| !serial.is_empty()));
                manifest::write(folder, serial, unit, &beside)
                    .map_err(|e| disk(&folder.join(MANIFEST_FILE), &e))?;
                self.named = Some(beside.len());
            }
            unit.write(if all { i64::MAX } else { to }, zero).map_err(disk_of)?;
        }
        let Some(journal) = &mut self.journal else { return Ok(()) };
        journal.sync().map_err(|e| disk(&folder.join(EVENTS_FILE), &e))
    }

    /// Brings every device into its safe state, and waits until those that answer have said so.
    fn make_safe(&mut self) {
        if std::mem::replace(&mut self.is_safe, true) {
            return;
        }
        let now = self.inbox.now_ns();
        let mut patience = Duration::ZERO;
        let (standing, lost): (Vec<_>, Vec<_>) = self
            .machines
            .iter_mut()
            .enumerate()
            .filter(|(_, machine)| machine.device.has_safe_state)
            .partition(|(_, machine)| machine.is_linked());
        // A connection that must be made anew may take its time.
        for (place, machine) in standing.into_iter().chain(lost) {
            machine.make_safe(self.order.folder, self.inbox.sender(place), now);
            patience = patience.max(machine.device.patience);
        }
        let began = Instant::now();
        while self.machines.iter().any(Machine::is_making_safe) && began.elapsed() < patience {
            self.hear();
        }
    }

    /// Takes what devices say meanwhile; what goes wrong changes nothing any more.
    fn hear(&mut self) {
        for item in self.inbox.within(Duration::from_millis(20)) {
            // The first fault is the one that is told.
            let _ = self.take(item);
        }
    }

    /// The last readings, so that the rows of the unit lie between readings of the others.
    fn read_last(&mut self) {
        let now = self.inbox.now_ns();
        for machine in &mut self.machines {
            // A device that is gone has no further reading.
            let _ = machine.poll_now(now);
        }
        let began = Instant::now();
        while self.machines.iter().any(Machine::is_asked) && began.elapsed() < LAST_READINGS {
            self.hear();
        }
    }

    fn finish(mut self, end: End) -> Summary {
        self.make_safe();
        if end == End::Complete || end == End::Asked {
            self.read_last();
        }
        let length_s = self.began_ns.map_or(0.0, |began| seconds(self.inbox.now_ns() - began));
        let mut end = end;
        if let Err(fault) = self.enter_end(&end).and_then(|()| self.write(true))
            && !matches!(end, End::Fault(_))
        {
            end = End::Fault(fault);
        }
        self.machines.iter_mut().for_each(Machine::close);
        let safe = self.machines.iter().filter_map(|m| Some((m.device.id.clone(), m.safe?))).collect();
        let place = self.machines.iter().position(|machine| machine.device.is_unit);
        let unit = place.and_then(|place| self.parts.get(place));
        Summary {
            end,
            began: self.began_ns.is_some(),
            remarks: std::mem::take(&mut self.remarks),
            safe,
            parts: unit.map_or(0, |parts| parts.written),
            rows: unit.map_or(0, |parts| parts.rows_written),
            length_s,
        }
    }

    fn enter_end(&mut self, end: &End) -> Result<(), Fault> {
        if let End::Fault(fault) = end {
            self.enter(Event::Wrong(fault))?;
        }
        let safe: Vec<(String, SafeState)> =
            self.machines.iter().filter_map(|m| Some((m.device.id.clone(), m.safe?))).collect();
        for (device, state) in &safe {
            self.enter(Event::Safe { device, state: state.name() })?;
        }
        let how = match end {
            End::Complete => "complete",
            End::Asked => "asked",
            End::Fault(_) => "fault",
        };
        self.enter(Event::End { how })
    }
}

impl Drop for Session<'_> {
    /// A recording that ends by a panic leaves the bench safe too.
    fn drop(&mut self) {
        self.make_safe();
    }
}

fn disk(path: &Path, e: &std::io::Error) -> Fault {
    Fault::Disk { path: path.display().to_string(), reason: e.to_string() }
}
