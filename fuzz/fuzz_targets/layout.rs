//! Layouts in TOML.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::file_of_keys(data, |bytes| sagnac::config::layout::parse("layout.toml", bytes));
});
