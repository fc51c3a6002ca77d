//! Raw records under a layout with a sync word, a checksum, packed bits and every size of number.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::ingest::ReadOptions;

const LAYOUT: &str = r#"
format = "layout/1"
record_bytes = 24
sync = "AA 55"
[checksum]
type = "crc16-ccitt"
[[field]]
name = "n"
type = "u16"
[[field]]
name = "low"
type = "u16"
offset = 4
mask = 0x0fff
[[field]]
name = "t"
type = "u32"
offset = 6
unit = "us"
rolls_over = "4294.967296 s"
[[field]]
name = "rate"
type = "i24"
scale = 0.01
unit = "deg/h"
[[field]]
name = "x"
type = "f64"
offset = 13
"#;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::with_file("layout.toml", LAYOUT.as_bytes(), |layout| {
        let options = ReadOptions {
            layout: Some(sagnac::ingest::raw::LayoutFile::at(layout.to_owned())),
            ..ReadOptions::default()
        };
        sagnac_fuzz::with_file("r.bin", data, |path| sagnac_fuzz::read_all(path, &options, data.len()));
    });
});
