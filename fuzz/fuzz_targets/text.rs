//! Delimited text: the first byte chooses what the user decided, the rest is the file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::ingest::{ReadOptions, TextOptions};

fuzz_target!(|data: &[u8]| {
    let Some((&choice, text)) = data.split_first() else { return };
    let pick = |bit: u8| choice >> bit & 1 == 1;
    let text_options = TextOptions {
        delimiter: pick(0).then_some(if pick(1) { b';' } else { b',' }),
        decimal: pick(2).then_some(if pick(3) { b',' } else { b'.' }),
        header_line: pick(4).then_some(u64::from(pick(5))),
        comment: pick(6).then(|| "#".to_owned()),
        ..TextOptions::default()
    };
    let options = ReadOptions { text: text_options, ..ReadOptions::default() };
    sagnac_fuzz::with_file("r.csv", text, |path| sagnac_fuzz::read_all(path, &options, text.len()));
});
