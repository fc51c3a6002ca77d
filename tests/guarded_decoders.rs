//! A decoder that panics on damaged content is an error of the file and no panic of the program.

mod support;

use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{IngestErrorKind, open};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use tempfile::tempdir;

static SEEN: AtomicU64 = AtomicU64::new(0);

#[test]
fn a_panic_of_a_decoder_is_a_damaged_file() {
    // A panic that is not caught in time is seen by the hook that was there before.
    std::panic::set_hook(Box::new(|_| {
        SEEN.fetch_add(1, Ordering::Relaxed);
    }));
    let sound = std::fs::read(support::shipped("tests/bad-input/recording/sound.parquet")).unwrap();
    let dir = tempdir().unwrap();
    let path = dir.path().join("r.parquet");
    let (mut gave_up, mut read, mut refused) = (0, 0, 0);
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
                }
            }
        }
    }
    let _ = std::panic::take_hook();
    assert_eq!(SEEN.load(Ordering::Relaxed), 0, "panics that nobody caught");
    assert!(gave_up > 0, "no decoder panicked: {read} read, {refused} refused");
    println!("{read} read, {refused} refused, {gave_up} of them by a panic of the decoder");
}
