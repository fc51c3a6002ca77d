//! Packed text: the bytes packed by us, and taken for packed as they are.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::ingest::ReadOptions;
use std::io::Write;

fuzz_target!(|data: &[u8]| {
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let packed = gz.write_all(data).and_then(|()| gz.finish());
    let zst = zstd::encode_all(data, 1);
    let damaged = [&[0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3][..], data].concat();
    let damaged_zst = [&[0x28, 0xb5, 0x2f, 0xfd][..], data].concat();
    for bytes in packed.into_iter().chain(zst).chain([damaged, damaged_zst]) {
        // A packed file may hold many times its size; what is read is text in blocks of bounded size.
        sagnac_fuzz::with_file("r.csv.gz", &bytes, |path| {
            sagnac_fuzz::read_all(path, &ReadOptions::default(), bytes.len().max(data.len()));
        });
    }
});
