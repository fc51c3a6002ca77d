//! An emulated bench: a rate table, a chamber, a supply and a gyro, each behind its own connection, and a clock that goes on when it
//! is asked to. The gyro is `sagnac simulate` with what table and chamber do to it; nothing here is of the recorder.

use serde_json::json;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};

/// Step of the motions, s.
const STEP_S: f64 = 0.05;
/// Acceleration of the table, deg/s².
const ACCELERATION: f64 = 50.0;
/// Time constants of the chamber behind its set point and of the unit behind the chamber, s.
const CHAMBER_S: f64 = 20.0;
const UNIT_S: f64 = 30.0;

/// Something that goes wrong at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trouble {
    /// The cable of the gyro is pulled out.
    GyroCable,
    /// The gyro says nothing any more, its connection stands.
    GyroSilent,
    /// The table does not move any more, whatever it is told.
    TableStuck,
    /// The cable of the table is pulled out; it can be reached again.
    TableCable,
    /// The clock of the gyro is put forward, s.
    ClockStep(f64),
    /// The chamber keeps its temperature.
    ChamberFrozen,
    /// The supply goes up, V.
    Overvoltage(f64),
}

/// A unit: what `sagnac simulate` made of its noise, and how its scale factor depends on the temperature.
#[derive(Debug, Clone, Default)]
pub struct Unit {
    /// Rate at rest, deg/h, sample after sample.
    pub simulated: Vec<f64>,
    /// Deviation of the scale factor at 25 degC, ppm.
    pub error_ppm: f64,
    /// Its change with temperature, ppm/degC.
    pub per_degree_ppm: f64,
}

/// Samples of the gyro in a second.
pub const HZ: f64 = 2.0;

struct World {
    at_s: f64,
    angle: f64,
    rate: f64,
    demand: f64,
    is_stuck: bool,
    set_point: f64,
    chamber: f64,
    is_frozen: bool,
    unit_temp: f64,
    volts: f64,
    samples: usize,
    turned: f64,
    device_ahead_s: f64,
    is_silent: bool,
    gyro: Option<TcpStream>,
    table: Option<TcpStream>,
    sent: BTreeMap<&'static str, u64>,
    troubles: Vec<(f64, Trouble)>,
    unit: Unit,
    heard: Vec<String>,
}

impl World {
    /// Goes on to a time; the gyro says what it measures until then.
    fn advance(&mut self, to_s: f64) {
        while self.at_s < to_s - 1e-9 {
            let next_sample = self.samples as f64 / HZ;
            let next = (self.at_s + STEP_S).min(to_s).min(next_sample.max(self.at_s + 1e-6));
            self.step(next - self.at_s);
            self.at_s = next;
            if self.at_s >= next_sample - 1e-9 {
                self.sample();
            }
            while let Some((_, trouble)) = self.troubles.iter().copied().find(|(at, _)| *at <= self.at_s) {
                self.troubles.retain(|(_, t)| *t != trouble);
                self.suffer(trouble);
            }
        }
    }

    fn step(&mut self, dt: f64) {
        let before = self.rate;
        if !self.is_stuck {
            self.rate += (self.demand - self.rate).clamp(-ACCELERATION * dt, ACCELERATION * dt);
        }
        let turned = 0.5 * (before + self.rate) * dt;
        self.angle += turned;
        self.turned += turned;
        if !self.is_frozen {
            self.chamber += (self.set_point - self.chamber) * (1.0 - (-dt / CHAMBER_S).exp());
        }
        self.unit_temp += (self.chamber - self.unit_temp) * (1.0 - (-dt / UNIT_S).exp());
    }

    /// A sample is the mean of the rate since the last one.
    fn sample(&mut self) {
        let turned = std::mem::take(&mut self.turned);
        let number = self.samples;
        self.samples += 1;
        if self.volts < 4.5 || self.is_silent {
            return;
        }
        let off = self.unit_temp - 25.0;
        let factor = 1.0 + 1e-6 * (self.unit.error_ppm + self.unit.per_degree_ppm * off);
        let rest = self.unit.simulated[number % self.unit.simulated.len()];
        let rate = 3600.0 * turned * HZ * factor + rest;
        let line = json!({
            "t": (self.at_s * 1e9).round() as i64,
            "u": 1e5 + self.at_s * 1.000_01 + self.device_ahead_s,
            "rate_deg_h": (rate * 1e4).round() / 1e4,
            "temp_degC": (self.unit_temp * 1e2).round() / 1e2,
        });
        let Some(gyro) = &mut self.gyro else { return };
        if writeln!(gyro, "{line}").is_ok() {
            *self.sent.entry("gyro").or_default() += 1;
        }
    }

    fn suffer(&mut self, trouble: Trouble) {
        let cut = |stream: &mut Option<TcpStream>| {
            if let Some(stream) = stream.take() {
                let _ = stream.shutdown(Shutdown::Both);
            }
        };
        match trouble {
            Trouble::GyroCable => cut(&mut self.gyro),
            Trouble::GyroSilent => self.is_silent = true,
            Trouble::TableStuck => self.is_stuck = true,
            Trouble::TableCable => cut(&mut self.table),
            Trouble::ClockStep(seconds) => self.device_ahead_s += seconds,
            Trouble::ChamberFrozen => self.is_frozen = true,
            Trouble::Overvoltage(volts) => self.volts = volts,
        }
    }

    /// What a device answers.
    fn answer(&mut self, device: &'static str, line: &str) -> Option<String> {
        self.heard.push(format!("{device}: {line}"));
        let number = || line.split([' ', ',', ';']).find_map(|word| word.parse::<f64>().ok());
        let last = || line.rsplit([' ', ',']).find_map(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
        Some(match (device, line) {
            ("table", ":READ:POS? 1;RATE? 1") => {
                format!("{:.6};{:.6}", self.angle.rem_euclid(360.0), self.rate)
            }
            ("table", line) if line.starts_with(":DEM:RATE 1,") => {
                self.demand = last();
                "OK".to_owned()
            }
            ("table", ":MODE:OFF 1") => {
                self.demand = 0.0;
                "OK".to_owned()
            }
            ("chamber", "TEMP?") => format!("{:.3} {:.3}", self.chamber, self.set_point),
            ("chamber", "STOP") => "ACK".to_owned(),
            ("chamber", _) => {
                self.set_point = number()?;
                "ACK".to_owned()
            }
            ("supply", "MEAS:VOLT?") => format!("{:.4}", self.volts),
            ("supply", line) => {
                self.volts = if line == "OUTP 0" { 0.0 } else { number()? };
                return None;
            }
            _ => "ERR".to_owned(),
        })
    }
}

/// A bench that can be reached.
pub struct Twin {
    world: Arc<Mutex<World>>,
    /// Address of its clock.
    pub clock: String,
    devices: BTreeMap<&'static str, String>,
}

impl Twin {
    /// A bench with a unit, and what goes wrong.
    pub fn new(unit: Unit, troubles: &[(f64, Trouble)]) -> Twin {
        let world = Arc::new(Mutex::new(World {
            at_s: 0.0,
            angle: 12.0,
            rate: 0.0,
            demand: 0.0,
            is_stuck: false,
            set_point: 25.0,
            chamber: 25.0,
            is_frozen: false,
            unit_temp: 25.0,
            volts: 0.0,
            samples: 1,
            turned: 0.0,
            device_ahead_s: 0.0,
            is_silent: false,
            gyro: None,
            table: None,
            sent: BTreeMap::new(),
            troubles: troubles.to_vec(),
            unit,
            heard: vec![],
        }));
        let clock = serve(&world, "clock");
        let devices = ["gyro", "table", "chamber", "supply"].map(|device| (device, serve(&world, device)));
        Twin { world, clock, devices: devices.into_iter().collect() }
    }

    fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap()
    }

    /// Rate that the table was told last, deg/s.
    pub fn demand(&self) -> f64 {
        self.world().demand
    }

    /// Voltage of the supply.
    pub fn volts(&self) -> f64 {
        self.world().volts
    }

    /// Commands that a device heard, but for questions.
    pub fn commands(&self, device: &str) -> Vec<String> {
        let begins = format!("{device}: ");
        let heard = self.world().heard.clone();
        heard
            .iter()
            .filter_map(|line| line.strip_prefix(&begins))
            .filter(|l| !l.contains('?'))
            .map(str::to_owned)
            .collect()
    }

    /// The file of the bench.
    pub fn bench(&self, part: &str) -> String {
        let at = |device: &str| &self.devices[device];
        format!(
            "format = \"bench/1\"\npart = \"{part}\"\n\
             [[device]]\nid = \"gyro\"\nunit_under_test = true\nlink = \"tcp\"\naddress = \"{}\"\nheartbeat = \"5 s\"\n\
             [[device]]\nid = \"table\"\nlink = \"tcp\"\naddress = \"{}\"\nlanguage = \"text\"\n\
             columns = [\"table_angle_deg\", \"table_rate_deg_s\"]\npoll = \":READ:POS? 1;RATE? 1\"\nperiod = \"1 s\"\n\
             answer = \"OK\"\nsafe = [\":DEM:RATE 1,0\", \":MODE:OFF 1\"]\n\
             [[device.move]]\nquantity = \"table_rate_deg_s\"\nsend = \":DEM:RATE 1,{{value}}\"\nlowest = -120\nhighest = 120\n\
             tolerance = 0.01\nwithin = \"20 s\"\n\
             [[device]]\nid = \"chamber\"\nlink = \"tcp\"\naddress = \"{}\"\nlanguage = \"text\"\n\
             columns = [\"chamber_temp_degC\", \"-\"]\npoll = \"TEMP?\"\nperiod = \"5 s\"\nheartbeat = \"30 s\"\n\
             answer = \"ACK\"\nsafe = [\"STOP\"]\n\
             [[device.move]]\nquantity = \"temp_degC\"\nsend = \"SET {{value}}\"\nreads = \"chamber_temp_degC\"\nlowest = -40\n\
             highest = 75\ntolerance = 0.3\nwithin = \"5 min\"\nfastest_per_h = 900\n\
             [[device]]\nid = \"supply\"\nlink = \"tcp\"\naddress = \"{}\"\nlanguage = \"text\"\ncolumns = [\"supply_v\"]\n\
             poll = \"MEAS:VOLT?\"\nperiod = \"10 s\"\nheartbeat = \"30 s\"\nsafe = [\"OUTP 0\"]\n\
             [[device.move]]\nquantity = \"supply_v\"\nsend = \"VOLT {{value}}\"\nlowest = 4.75\nhighest = 5.25\ntolerance = 0.1\n\
             within = \"30 s\"\nbegin = 5\n",
            at("gyro"),
            at("table"),
            at("chamber"),
            at("supply")
        )
    }
}

/// Listens for a device; gives its address.
fn serve(world: &Arc<Mutex<World>>, device: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let world = Arc::clone(world);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let world = Arc::clone(&world);
            std::thread::spawn(move || talk(&world, device, stream));
        }
    });
    address
}

fn talk(world: &Mutex<World>, device: &'static str, mut stream: TcpStream) {
    stream.set_nodelay(true).unwrap();
    let reader = BufReader::new(stream.try_clone().unwrap());
    if device == "gyro" {
        let mut world = world.lock().unwrap();
        let hello = json!({"v": 1, "hello": {"name": "emulated gyro", "model": "E-1", "serial": "SN-7",
            "channels": [{"id": "rate_deg_h"}, {"id": "temp_degC"}]}});
        writeln!(stream, "{hello}").unwrap();
        *world.sent.entry("gyro").or_default() += 1;
        world.gyro = Some(stream.try_clone().unwrap());
    }
    if device == "table" {
        world.lock().unwrap().table = Some(stream.try_clone().unwrap());
    }
    for line in reader.lines().map_while(Result::ok) {
        let mut world = world.lock().unwrap();
        let answer = if device == "clock" {
            let asked: serde_json::Value = serde_json::from_str(&line).unwrap();
            let to_ns = asked["advance"].as_i64().unwrap();
            world.advance(to_ns as f64 * 1e-9);
            Some(json!({"now": to_ns, "sent": world.sent}).to_string())
        } else {
            world.answer(device, &line)
        };
        let Some(answer) = answer else { continue };
        if device != "clock" {
            *world.sent.entry(device).or_default() += 1;
        }
        if writeln!(stream, "{answer}").is_err() {
            return;
        }
    }
}
