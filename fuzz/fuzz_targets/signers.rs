//! What a folder says of itself, and who may sign it: lists of signers, moments in them, lists of hashes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sagnac::output::{checksums, read_checksums};
use sagnac::signing::{Signers, moment};

fuzz_target!(|text: &str| {
    sagnac_fuzz::watched(text.len(), || {
        let lines = text.split('\n').count();
        let signers = Signers::of_text(text);
        assert!(signers.passed_over.iter().all(|bad| (1..=lines).contains(&bad.line)), "{signers:?}");
        if let Some(hashes) = read_checksums(text) {
            assert_eq!(checksums(&hashes), text);
        }
        let _ = moment(text);
    });
});
