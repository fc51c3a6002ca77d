use super::*;

const IMU: &str = r#"
format = "layout/1"
header_bytes = 64
record_bytes = 32
byte_order = "big"
sync = "AA55"
sample_rate = "2 kHz"

[checksum]
type = "crc16-ccitt"
from = 2

[[field]]
name = "flags"
type = "u8"
mask = 0xF0
shift = 4

[[field]]
name = "mode"
type = "u8"
offset = 2
mask = 0x0F

[[field]]
name = "stamp"
type = "u32"
offset = 4
unit = "us"
rolls_over = "4294.967296 s"

[[field]]
name = "gyro"
type = "i24"
count = 3
scale = 0.5
offset_value = 1
unit = "deg/h"
"#;

#[test]
fn a_layout_says_where_everything_stands() {
    let layout = parse("imu.toml", IMU.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((layout.header_bytes, layout.record_bytes), (64, 32));
    assert_eq!((layout.sync.as_slice(), layout.sample_rate_hz), (&[0xaa, 0x55][..], Some(2000.0)));
    assert_eq!(
        layout.names().collect::<Vec<_>>(),
        ["flags", "mode", "stamp", "gyro[0]", "gyro[1]", "gyro[2]"]
    );
    let offsets: Vec<usize> = layout.columns.iter().map(|c| c.field.offset).collect();
    assert_eq!(offsets, [2, 2, 4, 8, 11, 14]);
    assert_eq!(layout.columns[0].field.bits, Some((0xf0, 4)));
    assert_eq!(layout.columns[2].rollover_s, Some(4294.967296));
    assert_eq!(layout.columns[5].field.conversion, Affine { factor: 0.5, offset: 1.0 });
    let checksum = layout.checksum.unwrap();
    assert_eq!((checksum.at, checksum.from, checksum.to), (30, 2, 30));
}

#[test]
fn the_length_of_a_record_follows_from_its_fields() {
    let text =
        "format = \"layout/1\"\n[checksum]\ntype = \"sum8\"\n[[field]]\nname = \"a\"\ntype = \"f64\"\n";
    let layout = parse("l", text.as_bytes()).unwrap();
    assert_eq!((layout.record_bytes, layout.checksum.unwrap().at), (9, 8));
}
