use super::*;
use crate::layout::{ByteOrder, Sum};

/// 8 bytes: sync A5 5A, a counter of 4, CRC-16 big endian.
fn layout() -> Layout {
    let sum = Sum::of("crc16-xmodem").unwrap();
    let checksum = Checksum { sum, word: "crc16-xmodem", at: 6, from: 0, to: 6, order: ByteOrder::Big };
    Layout {
        header_bytes: 0,
        record_bytes: 8,
        sync: vec![0xa5, 0x5a],
        sample_rate_hz: None,
        checksum: Some(checksum),
        columns: vec![],
    }
}

fn record(n: u32) -> Vec<u8> {
    let mut bytes = vec![0xa5, 0x5a];
    bytes.extend_from_slice(&n.to_be_bytes());
    let crc = bytes.iter().fold(0u16, |mut crc, b| {
        crc ^= u16::from(*b) << 8;
        for _ in 0..8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 };
        }
        crc
    });
    bytes.extend_from_slice(&crc.to_be_bytes());
    bytes
}

fn stream(n: u32) -> Vec<u8> {
    (0..n).flat_map(record).collect()
}

/// Rows as counters, `None` where a row has no values; and what was found there. The bytes come in pieces.
fn scan(layout: &Layout, bytes: &[u8], piece: usize) -> (Vec<Option<u32>>, Vec<String>) {
    let mut scanner = Scanner::new(layout);
    let (mut rows, mut texts) = (Vec::new(), Vec::new());
    let mut pieces: Vec<(&[u8], bool)> = bytes.chunks(piece).map(|p| (p, false)).collect();
    pieces.push((&[], true));
    for (piece, end) in pieces {
        let mut cut = FramedRecords::default();
        scanner.take(piece, end, &mut cut);
        let bad: Vec<usize> = cut.bad.iter().map(|(i, _)| *i).collect();
        for (i, r) in cut.records.chunks(8).enumerate() {
            let n = u32::from_be_bytes([r[2], r[3], r[4], r[5]]);
            rows.push((!bad.contains(&i)).then_some(n));
        }
        texts.extend(cut.bad.into_iter().map(|(_, text)| text));
    }
    (rows, texts)
}

#[test]
fn sound_streams_come_whole_in_pieces_of_any_size() {
    let bytes = stream(50);
    let all: Vec<Option<u32>> = (0..50).map(Some).collect();
    for piece in [1, 3, 7, 8, 9, 64, 1000] {
        assert_eq!(scan(&layout(), &bytes, piece), (all.clone(), vec![]), "{piece}");
    }
}

#[test]
fn a_wrong_byte_costs_its_record_and_no_other() {
    for place in 0..8 {
        let mut bytes = stream(10);
        bytes[4 * 8 + place] ^= 0x10;
        for piece in [1, 8, 1000] {
            let (rows, texts) = scan(&layout(), &bytes, piece);
            let expected: Vec<Option<u32>> = (0..10).map(|i| (i != 4).then_some(i)).collect();
            assert_eq!(rows, expected, "byte {place}, {texts:?}");
            let told = if place < 2 { "sync @32 +8 B" } else { "crc16-xmodem" };
            assert!(texts.len() == 1 && texts[0].starts_with(told) && texts[0].contains("@32"), "{texts:?}");
        }
    }
}

#[test]
fn dropped_and_added_bytes_are_told_with_their_place() {
    let whole = stream(10);
    // Three bytes are missing from the record at byte 40: what is left of it is passed over.
    let mut dropped = whole.clone();
    dropped.drain(42..45);
    let (rows, texts) = scan(&layout(), &dropped, 1000);
    assert_eq!(rows, [Some(0), Some(1), Some(2), Some(3), Some(4), None, Some(6), Some(7), Some(8), Some(9)]);
    assert_eq!(texts, ["sync @40 +5 B"]);
    // Twenty foreign bytes between two records count as 2.5 records, three rows.
    let mut added = whole.clone();
    added.splice(40..40, [0x11; 20]);
    let (rows, texts) = scan(&layout(), &added, 5);
    assert_eq!(rows.iter().filter(|r| r.is_none()).count(), 3);
    assert_eq!(rows.iter().flatten().copied().collect::<Vec<_>>(), (0..10).collect::<Vec<_>>());
    assert!(texts.iter().all(|t| t == "sync @40 +20 B"), "{texts:?}");
    // A file that is cut off within its last record.
    let (rows, texts) = scan(&layout(), &whole[..77], 1000);
    assert_eq!((rows.len(), rows[9], texts[0].as_str()), (10, None, "5/8 B @72"));
}

#[test]
fn a_sync_word_alone_tells_bytes_that_were_dropped() {
    let layout = Layout { checksum: None, ..layout() };
    let mut bytes = stream(10);
    bytes.drain(44..45);
    let (rows, texts) = scan(&layout, &bytes, 6);
    assert_eq!(rows.iter().flatten().copied().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 6, 7, 8, 9]);
    assert_eq!((rows[5], texts), (None, vec!["sync @40 +7 B".to_owned()]));
}

#[test]
fn a_long_stretch_without_records_needs_no_memory() {
    let mut scanner = Scanner::new(&layout());
    let junk = vec![0xa5; 1 << 20];
    let mut told = 0;
    for _ in 0..8 {
        let mut cut = FramedRecords::default();
        scanner.take(&junk, false, &mut cut);
        told += cut.bad.len();
        assert!(scanner.pending.len() < 8);
    }
    let mut cut = FramedRecords::default();
    scanner.take(&record(7), true, &mut cut);
    assert_eq!(told + cut.bad.len(), 1 << 20, "one row for every eight bytes");
    assert_eq!(cut.records.len() / 8 - cut.bad.len(), 1);
}
