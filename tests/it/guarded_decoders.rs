//! A decoder that panics on damaged content is an error of the file and no panic of the program.

use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{IngestErrorKind, decoder_is_running, open};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use tempfile::tempdir;

static CAUGHT: AtomicU64 = AtomicU64::new(0);
static MISSED: AtomicU64 = AtomicU64::new(0);

#[test]
fn a_panic_of_a_decoder_is_a_damaged_file() {
    std::panic::set_hook(Box::new(|_| {
        let counter = if decoder_is_running() { &CAUGHT } else { &MISSED };
        counter.fetch_add(1, Ordering::Relaxed);
    }));
    let sound = std::fs::read(crate::support::shipped("tests/bad-input/recording/sound.parquet")).unwrap();
    let dir = tempdir().unwrap();
    let path = dir.path().join("r.parquet");
    let (mut gave_up, mut read, mut refused) = (0, 0, 0);
    let mut panicking = Vec::new();
    for at in 4..sound.len() {
        let mut broken = sound.clone();
        broken[at] = 0xff;
        std::fs::write(&path, &broken).unwrap();
        let outcome = open(&path).and_then(|source| {
            let wanted: Vec<usize> =
                (0..source.columns().len()).filter(|i| source.columns()[*i].numeric).collect();
            source.read(&wanted, &mut |_| ControlFlow::Continue(()))
        });
        match outcome {
            Ok(_) => read += 1,
            Err(e) => {
                refused += 1;
                if e.say(Lang::En).contains("the decoder failed") {
                    assert_eq!(e.kind(), IngestErrorKind::Damaged);
                    gave_up += 1;
                    panicking = broken;
                }
            }
        }
    }
    let _ = std::panic::take_hook();
    assert_eq!(MISSED.load(Ordering::Relaxed), 0, "panics that nobody caught");
    // Once when the first values are looked at, once when the file is read.
    assert_eq!(CAUGHT.load(Ordering::Relaxed), 2 * gave_up, "reading sets no hook of its own");
    assert!(gave_up > 0, "no decoder panicked: {read} read, {refused} refused");
    println!("{read} read, {refused} refused, {gave_up} of them by a panic of the decoder");

    // The program says the same, and nothing of a panic: every run of it in the tests is checked for that.
    std::fs::write(&path, &panicking).unwrap();
    let said = crate::support::sagnac(dir.path(), &["inspect", "r.parquet"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert!(said.err.contains("the decoder failed"), "{}", said.err);
}
