//! A whole analysis of a small recording: no value that is no number may reach the result.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::with_file("r.csv", data, |path| sagnac_fuzz::analyse(path));
});
