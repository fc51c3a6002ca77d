//! Every format of the registry on the same bytes, and `inspect`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::ingest::ReadOptions;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::with_file("r.bin", data, |path| {
        let _ =
            sagnac::acceptance::inspect::inspect(path, Some(10.0), sagnac::i18n::Lang::Ru, &mut |_, _| {});
        for format in sagnac::ingest::FORMATS {
            let options = ReadOptions { format: Some(format.id().to_owned()), ..ReadOptions::default() };
            sagnac_fuzz::read_all(path, &options, data.len());
        }
    });
});
