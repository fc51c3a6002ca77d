//! The protocol `bench/1`: one JSON object a line, in both directions. Members that are not known are passed over.

use serde::Deserialize;
use serde_json::{Map, Value, json};

/// Version of the protocol.
const PROTOCOL_VERSION: u64 = 1;
/// Most channels of a device.
pub const MAX_CHANNELS: usize = 256;

/// A line of a device.
#[derive(Debug, Clone, PartialEq)]
pub enum Said {
    /// It introduces itself.
    Hello(Hello),
    /// A row of numbers, by channel.
    Sample {
        /// Its stamp by the monotonic clock of this computer, ns, where the driver stamps.
        at_ns: Option<i64>,
        /// Its stamp by the clock of the device, s.
        device_s: Option<f64>,
        /// The numbers.
        values: Map<String, Value>,
    },
    /// An answer.
    Answer {
        /// Number of what is answered.
        id: u64,
        /// Why it was refused; `None` where it was carried out.
        refused: Option<String>,
    },
    /// Something happened.
    Event {
        /// True of a fault.
        is_fault: bool,
        /// What it is called.
        name: String,
        /// In words.
        text: String,
    },
    /// The device is there and has nothing to say.
    Alive,
}

/// How a device introduces itself.
#[derive(Debug, Clone, PartialEq, Deserialize, Default)]
pub struct Hello {
    /// Name.
    #[serde(default)]
    pub name: String,
    /// Model.
    #[serde(default)]
    pub model: String,
    /// Serial number.
    #[serde(default)]
    pub serial: String,
    /// What it sends.
    #[serde(default)]
    pub channels: Vec<Channel>,
    /// What it can be asked to move.
    #[serde(default)]
    pub commands: Vec<Command>,
}

/// A channel.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Channel {
    /// Name of its column, with its unit.
    pub id: String,
    /// Unit, where the name has none.
    #[serde(default)]
    pub unit: String,
}

/// A quantity that a device moves.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Command {
    /// Name with its unit.
    pub id: String,
    /// Lowest value that it takes.
    #[serde(default)]
    pub min: Option<f64>,
    /// Highest value.
    #[serde(default)]
    pub max: Option<f64>,
}

impl Channel {
    /// Its column in a file.
    pub fn column(&self) -> String {
        if self.unit.is_empty() { self.id.clone() } else { format!("{} [{}]", self.id, self.unit) }
    }
}

/// Reads a line.
///
/// # Errors
/// What is wrong with it, in English.
pub fn parse(line: &str) -> Result<Said, String> {
    let value: Value = serde_json::from_str(line).map_err(|e| e.to_string())?;
    let Value::Object(mut members) = value else { return Err("no JSON object".to_owned()) };
    if let Some(version) = members.remove("v")
        && version.as_u64() != Some(PROTOCOL_VERSION)
    {
        return Err(format!("version {version} of the protocol is not known"));
    }
    if let Some(hello) = members.remove("hello") {
        return hello_of(hello).map(Said::Hello);
    }
    let text_of = |value: Option<&Value>| value.and_then(Value::as_str).unwrap_or_default().to_owned();
    if let Some(id) = members.get("id").and_then(Value::as_u64) {
        let is_ok = members.get("ok").and_then(Value::as_bool) == Some(true);
        let refused = (!is_ok).then(|| text_of(members.get("error")));
        return Ok(Said::Answer { id, refused });
    }
    if let Some(event) = members.get("event") {
        let name = text_of(Some(event));
        let text = text_of(members.get("text"));
        return Ok(Said::Event { is_fault: name == "fault", name, text });
    }
    if members.contains_key("alive") {
        return Ok(Said::Alive);
    }
    let at_ns = members.remove("t").and_then(|t| t.as_i64());
    let device_s = members.remove("u").and_then(|u| u.as_f64());
    Ok(Said::Sample { at_ns, device_s, values: members })
}

fn hello_of(value: Value) -> Result<Hello, String> {
    let hello: Hello = serde_json::from_value(value).map_err(|e| e.to_string())?;
    if hello.channels.len() > MAX_CHANNELS {
        return Err(format!("more than {MAX_CHANNELS} channels"));
    }
    let is_name = |text: &str| !text.is_empty() && !text.contains(['"', ',', '\n', '\r']);
    if let Some(odd) = hello.channels.iter().find(|c| !is_name(&c.id)) {
        return Err(format!("a channel cannot be called {:?}", odd.id));
    }
    Ok(hello)
}

/// A request to move something.
pub fn set(id: u64, quantity: &str, value: f64) -> String {
    json!({"v": PROTOCOL_VERSION, "id": id, "set": {quantity: value}}).to_string()
}

/// A request to go into the safe state.
pub fn safe(id: u64) -> String {
    json!({"v": PROTOCOL_VERSION, "id": id, "safe": true}).to_string()
}

/// The numbers of a line of text; `None` where one of them is none.
pub fn numbers(line: &str) -> Option<Vec<f64>> {
    let parts = line.split([',', ';', ' ', '\t']).filter(|part| !part.is_empty());
    let found =
        parts.map(|part| part.parse::<f64>().ok().filter(|v| v.is_finite())).collect::<Option<Vec<f64>>>()?;
    (!found.is_empty()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_told_apart_by_their_members() {
        let hello = r#"{"v":1,"hello":{"name":"fog","serial":"7","channels":[{"id":"rate","unit":"deg/h"},{"id":"temp_degC"}],
            "commands":[{"id":"table_rate_deg_s","min":-5,"max":5}],"more":1}}"#;
        let Ok(Said::Hello(hello)) = parse(hello) else { panic!() };
        assert_eq!(
            hello.channels.iter().map(Channel::column).collect::<Vec<_>>(),
            ["rate [deg/h]", "temp_degC"]
        );
        assert_eq!((hello.serial.as_str(), hello.commands[0].max), ("7", Some(5.0)));
        let Ok(Said::Sample { at_ns, device_s, values }) = parse(r#"{"t":5,"u":0.5,"rate":1.5}"#) else {
            panic!()
        };
        assert_eq!((at_ns, device_s, values["rate"].as_f64()), (Some(5), Some(0.5), Some(1.5)));
        assert_eq!(parse(r#"{"id":7,"ok":true}"#), Ok(Said::Answer { id: 7, refused: None }));
        let refused = Some("interlock".to_owned());
        assert_eq!(parse(r#"{"id":7,"ok":false,"error":"interlock"}"#), Ok(Said::Answer { id: 7, refused }));
        assert!(matches!(parse(r#"{"event":"fault","text":"hot"}"#), Ok(Said::Event { is_fault: true, .. })));
        assert!(matches!(parse(r#"{"event":"door"}"#), Ok(Said::Event { is_fault: false, .. })));
        assert_eq!(parse(r#"{"alive":true}"#), Ok(Said::Alive));
    }

    #[test]
    fn what_is_no_line_of_the_protocol_is_refused() {
        for wrong in ["", "7", "[1]", "{", r#"{"v":2,"rate":1}"#, r#"{"hello":{"channels":[{"id":"a,b"}]}}"#]
        {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
        let many: Vec<Value> = (0..=MAX_CHANNELS).map(|i| json!({"id": i.to_string()})).collect();
        assert!(parse(&json!({"hello": {"channels": many}}).to_string()).is_err());
    }

    #[test]
    fn numbers_stand_between_commas_semicolons_and_spaces() {
        assert_eq!(numbers("1.5;-2, 3e2\t4"), Some(vec![1.5, -2.0, 300.0, 4.0]));
        for wrong in ["", "OK", "1;x", "nan", "1;inf"] {
            assert_eq!(numbers(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn requests_are_lines() {
        assert_eq!(set(3, "table_rate_deg_s", 10.0), r#"{"id":3,"set":{"table_rate_deg_s":10.0},"v":1}"#);
        assert_eq!(safe(4), r#"{"id":4,"safe":true,"v":1}"#);
    }
}
