//! Messages of ROS 1 and ROS 2 with numbers in them.

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// Common Data Representation of ROS 2, with its byte order stated in each message.
    Cdr,
    /// ROS 1: little endian, nothing aligned.
    Ros1,
}

/// One item of a message.
#[derive(Debug)]
enum Item {
    /// `std_msgs/Header`.
    Header,
    /// A number of 8 bytes, with its name and unit.
    Number(&'static str, Option<&'static str>),
    /// A number of 4 bytes.
    Single(&'static str),
    /// Numbers of 8 bytes that are passed over.
    Skip(usize),
}

/// A type of message.
#[derive(Debug)]
pub(crate) struct Layout {
    /// Package and name, without the `msg/` between them.
    name: &'static str,
    items: &'static [Item],
}

/// Every type that is read.
static LAYOUTS: &[Layout] = &[
    Layout {
        name: "sensor_msgs/Imu",
        items: &[
            Item::Header,
            Item::Number("orientation.x", Some("1")),
            Item::Number("orientation.y", Some("1")),
            Item::Number("orientation.z", Some("1")),
            Item::Number("orientation.w", Some("1")),
            Item::Skip(9),
            Item::Number("angular_velocity.x", Some("rad/s")),
            Item::Number("angular_velocity.y", Some("rad/s")),
            Item::Number("angular_velocity.z", Some("rad/s")),
            Item::Skip(9),
            Item::Number("linear_acceleration.x", Some("m/s^2")),
            Item::Number("linear_acceleration.y", Some("m/s^2")),
            Item::Number("linear_acceleration.z", Some("m/s^2")),
            Item::Skip(9),
        ],
    },
    Layout {
        name: "sensor_msgs/Temperature",
        items: &[Item::Header, Item::Number("temperature", Some("degC")), Item::Number("variance", None)],
    },
    Layout {
        name: "sensor_msgs/MagneticField",
        items: &[
            Item::Header,
            Item::Number("magnetic_field.x", Some("T")),
            Item::Number("magnetic_field.y", Some("T")),
            Item::Number("magnetic_field.z", Some("T")),
            Item::Skip(9),
        ],
    },
    Layout {
        name: "geometry_msgs/Vector3Stamped",
        items: &[
            Item::Header,
            Item::Number("vector.x", None),
            Item::Number("vector.y", None),
            Item::Number("vector.z", None),
        ],
    },
    Layout { name: "std_msgs/Float64", items: &[Item::Number("data", None)] },
    Layout { name: "std_msgs/Float32", items: &[Item::Single("data")] },
];

/// Most numbers of a message.
pub(crate) const MAX_NUMBERS: usize = 16;

/// A message that was read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Message {
    /// Stamp of the header: seconds and nanoseconds from 1970.
    pub stamp: Option<(i64, u32)>,
    /// Numbers in the order of the layout.
    pub numbers: [f64; MAX_NUMBERS],
}

impl Layout {
    /// The layout of a type, as ROS 1 (`sensor_msgs/Imu`) or ROS 2 (`sensor_msgs/msg/Imu`) names it.
    pub fn of(type_name: &str) -> Option<&'static Layout> {
        let plain = type_name.replacen("/msg/", "/", 1);
        LAYOUTS.iter().find(|l| l.name == plain)
    }

    /// True for the messages of an inertial measurement unit.
    pub fn is_imu(&self) -> bool {
        self.name == "sensor_msgs/Imu"
    }

    /// True when messages have a header with a stamp.
    pub fn has_header(&self) -> bool {
        self.items.iter().any(|i| matches!(i, Item::Header))
    }

    /// Names and units of the numbers.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, Option<&'static str>)> {
        self.items.iter().filter_map(|i| match i {
            Item::Number(name, unit) => Some((*name, *unit)),
            Item::Single(name) => Some((*name, None)),
            Item::Header | Item::Skip(_) => None,
        })
    }

    /// Reads a message; nothing when it ends early or its encoding is not known.
    pub fn read(&self, data: &[u8], encoding: Encoding) -> Option<Message> {
        let mut fields = Fields::start(data, encoding)?;
        let mut message = Message { stamp: None, numbers: [f64::NAN; MAX_NUMBERS] };
        let mut places = message.numbers.iter_mut();
        for item in self.items {
            match item {
                Item::Header => message.stamp = Some(fields.header()?),
                Item::Number(..) => *places.next()? = f64::from_bits(fields.word(8)?),
                Item::Single(_) => *places.next()? = f64::from(f32::from_bits(fields.word(4)? as u32)),
                Item::Skip(n) => fields.skip(*n)?,
            }
        }
        Some(message)
    }
}

/// Takes the fields of a message, one after the other.
struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Greatest alignment; 1 where nothing is aligned.
    alignment: usize,
    encoding: Encoding,
}

impl<'a> Fields<'a> {
    fn start(data: &'a [u8], encoding: Encoding) -> Option<Fields<'a>> {
        if encoding == Encoding::Ros1 {
            return Some(Fields { bytes: data, at: 0, big_endian: false, alignment: 1, encoding });
        }
        // Representation and options, before the bytes that alignment counts from.
        let (head, bytes) = data.split_at_checked(4)?;
        let (big_endian, alignment) = match head {
            [0, 0, ..] => (true, 8),
            [0, 1, ..] => (false, 8),
            [0, 6, ..] => (true, 4),
            [0, 7, ..] => (false, 4),
            _ => return None,
        };
        Some(Fields { bytes, at: 0, big_endian, alignment, encoding })
    }

    fn word(&mut self, len: usize) -> Option<u64> {
        let to = len.min(self.alignment);
        let start = self.at.checked_next_multiple_of(to)?;
        let end = start.checked_add(len)?;
        let bytes = self.bytes.get(start..end)?;
        self.at = end;
        let push = |word: u64, b: &u8| word << 8 | u64::from(*b);
        Some(if self.big_endian { bytes.iter().fold(0, push) } else { bytes.iter().rev().fold(0, push) })
    }

    fn skip(&mut self, numbers: usize) -> Option<()> {
        self.word(8)?;
        let rest = numbers.checked_sub(1)?.checked_mul(8)?;
        self.at = self.at.checked_add(rest).filter(|at| *at <= self.bytes.len())?;
        Some(())
    }

    /// Stamp of a header; what else is in it is passed over.
    fn header(&mut self) -> Option<(i64, u32)> {
        let ros1 = self.encoding == Encoding::Ros1;
        if ros1 {
            self.word(4)?;
        }
        let seconds = self.word(4)? as u32;
        // ROS 2 counts seconds with a sign, ROS 1 without.
        let seconds = if ros1 { i64::from(seconds) } else { i64::from(seconds as i32) };
        let nanoseconds = self.word(4)? as u32;
        let length = usize::try_from(self.word(4)?).ok()?;
        self.at = self.at.checked_add(length).filter(|at| *at <= self.bytes.len())?;
        Some((seconds, nanoseconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A temperature message as its encoding writes it: stamp 5 s 7 ns, the given frame, 25.5 degC, variance 0.25.
    fn temperature(encoding: Encoding, kind: u8, frame: &str) -> Vec<u8> {
        let big = kind.is_multiple_of(2) && encoding == Encoding::Cdr;
        let word = |v: u32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let double = |v: f64| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        let mut body: Vec<u8> = Vec::new();
        if encoding == Encoding::Ros1 {
            body.extend(word(1));
        }
        body.extend(word(5));
        body.extend(word(7));
        let end = usize::from(encoding == Encoding::Cdr);
        body.extend(word((frame.len() + end) as u32));
        body.extend(frame.bytes());
        body.extend(std::iter::repeat_n(0, end));
        let align = match (encoding, kind) {
            (Encoding::Ros1, _) => 1,
            (_, 0 | 1) => 8,
            _ => 4,
        };
        while !body.len().is_multiple_of(align) {
            body.push(0xaa);
        }
        body.extend(double(25.5));
        body.extend(double(0.25));
        if encoding == Encoding::Cdr { [vec![0, kind, 0, 0], body].concat() } else { body }
    }

    #[test]
    fn numbers_are_found_behind_a_frame_of_any_length() {
        let layout = Layout::of("sensor_msgs/msg/Temperature").unwrap();
        for frame in ["", "i", "imu", "imu_", "imu_link", "a frame with a long name"] {
            for (encoding, kind) in [
                (Encoding::Cdr, 0),
                (Encoding::Cdr, 1),
                (Encoding::Cdr, 6),
                (Encoding::Cdr, 7),
                (Encoding::Ros1, 1),
            ] {
                let bytes = temperature(encoding, kind, frame);
                let message = layout.read(&bytes, encoding).unwrap();
                assert_eq!(message.stamp, Some((5, 7)), "{frame} {kind}");
                assert_eq!(message.numbers.get(..2), Some(&[25.5, 0.25][..]), "{frame} {kind}");
                for cut in 0..bytes.len() {
                    assert_eq!(layout.read(&bytes[..cut], encoding), None, "{frame} {kind} {cut}");
                }
            }
        }
    }

    #[test]
    fn an_unknown_representation_is_not_guessed() {
        let layout = Layout::of("std_msgs/msg/Float64").unwrap();
        assert_eq!(layout.read(&[0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], Encoding::Cdr), None);
    }

    #[test]
    fn no_layout_has_more_numbers_than_fit() {
        assert!(LAYOUTS.iter().all(|l| l.numbers().count() <= MAX_NUMBERS));
    }
}
