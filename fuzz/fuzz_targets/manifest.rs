//! Manifests in TOML, in a folder with nothing beside them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    sagnac_fuzz::file_of_keys(data, |bytes| {
        sagnac::config::manifest::parse(
            Path::new("manifest.toml"),
            "manifest.toml",
            bytes,
            Path::new("nowhere"),
        )
    });
});
