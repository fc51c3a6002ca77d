//! Parquet: the bytes as they are, between the marks of the format.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::ingest::ReadOptions;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::with_file("r.parquet", data, |path| {
        sagnac_fuzz::read_all(path, &ReadOptions::default(), data.len())
    });
    if !data.starts_with(b"PAR1") {
        let framed = [b"PAR1", data, b"PAR1"].concat();
        sagnac_fuzz::with_file("r.parquet", &framed, |path| {
            sagnac_fuzz::read_all(path, &ReadOptions::default(), framed.len());
        });
    }
});
