//! The characters of a text file: UTF-8, UTF-16 or Windows-1251, found from its first bytes and turned into UTF-8 as the
//! bytes pass. UTF-8 itself passes untouched.

use crate::byte_stream::{ByteStream, Digested};
use crate::error::{IngestError, IngestErrorKind};
use crate::options::Encoding;
use sagnac_core::message::{Arg, Note, note};
use std::path::Path;

/// Bytes that are taken into the decoder at a time.
const RAW: usize = 256 << 10;

/// First bytes from which UTF-16 without a mark is recognised.
const PROBED: usize = 4096;

/// Share of the bytes beyond ASCII that must be Cyrillic letters for the text to be taken for Windows-1251.
const CYRILLIC_SHARE: f64 = 0.5;

/// An encoding with why it was taken.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoundEncoding {
    /// The encoding.
    pub encoding: Encoding,
    /// Why.
    pub reason: Note,
    /// A first byte that is no character of it, counted from 0.
    pub damaged_at: Option<usize>,
}

/// The name of an encoding as standards write it.
pub(super) fn name(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Utf8 => "UTF-8",
        Encoding::Utf16Le => "UTF-16LE",
        Encoding::Utf16Be => "UTF-16BE",
        Encoding::Windows1251 => "Windows-1251",
    }
}

fn mark(head: &[u8]) -> Option<Encoding> {
    match head {
        [0xef, 0xbb, 0xbf, ..] => Some(Encoding::Utf8),
        [0xff, 0xfe, ..] => Some(Encoding::Utf16Le),
        [0xfe, 0xff, ..] => Some(Encoding::Utf16Be),
        _ => None,
    }
}

/// Finds the encoding from the start of a file; `all`: the head is the whole file. `None`: this is no text.
pub(super) fn find(head: &[u8], all: bool) -> Option<FoundEncoding> {
    let found =
        |encoding, reason| Some(FoundEncoding { encoding, reason: Note::new(reason), damaged_at: None });
    match mark(head) {
        Some(encoding) => return found(encoding, "ingest.delimited.why_mark"),
        None if head.contains(&0) => {
            let encoding = utf16_without_mark(head)?;
            return found(encoding, "ingest.delimited.why_zeros");
        }
        None => {}
    }
    let error = match std::str::from_utf8(head) {
        Ok(text) if text.is_ascii() => return found(Encoding::Utf8, "ingest.delimited.why_ascii"),
        Ok(_) => return found(Encoding::Utf8, "ingest.delimited.why_valid"),
        // The head may end within a character.
        Err(e) if e.error_len().is_none() && !all => {
            return found(Encoding::Utf8, "ingest.delimited.why_valid");
        }
        Err(e) => e,
    };
    let high = || head.iter().filter(|b| **b >= 0x80);
    // Letters, and the number sign.
    let letter = |b: &u8| matches!(b, 0xc0..=0xff | 0xa8 | 0xb8 | 0xb9);
    let letters = high().filter(|b| letter(b)).count();
    // A lone one behind a digit is rather a damaged number.
    let damaged =
        letters == 1 && head.windows(2).any(|w| matches!(w, [d, l] if d.is_ascii_digit() && letter(l)));
    let total = high().count();
    // Degree, micro, plus-minus and other signs that Latin-1 and Windows-1251 share.
    let shared =
        high().all(|b| matches!(b, 0xa0 | 0xa7 | 0xa9 | 0xab..=0xae | 0xb0 | 0xb1 | 0xb5..=0xb7 | 0xbb));
    let sound_utf8 = head.utf8_chunks().any(|c| !c.valid().is_ascii());
    if shared && !sound_utf8 {
        return found(Encoding::Windows1251, "ingest.delimited.why_signs");
    }
    if !sound_utf8 && letters as f64 >= CYRILLIC_SHARE * total as f64 && letters > 0 && !damaged {
        return found(Encoding::Windows1251, "ingest.delimited.why_cyrillic");
    }
    Some(FoundEncoding {
        encoding: Encoding::Utf8,
        reason: note!("ingest.delimited.why_mostly"),
        damaged_at: Some(error.valid_up_to()),
    })
}

/// UTF-16 without a byte-order mark: every other byte of ASCII text is zero.
fn utf16_without_mark(head: &[u8]) -> Option<Encoding> {
    let probe = head.get(..head.len().min(PROBED) & !1)?;
    let pairs = probe.len() / 2;
    let zeros = |odd: usize| probe.iter().skip(odd).step_by(2).filter(|b| **b == 0).count();
    let encoding = match (zeros(0), zeros(1)) {
        (0, odd) if 2 * odd > pairs => Encoding::Utf16Le,
        (even, 0) if 2 * even > pairs => Encoding::Utf16Be,
        _ => return None,
    };
    let text = decode(encoding, probe, false);
    let control = |b: &u8| *b < 0x20 && !matches!(b, b'\t' | b'\r' | b'\n');
    (text.contains(&b'\n') && !text.iter().any(control)).then_some(encoding)
}

/// The encoding that a user stated, when the file does not contradict it.
pub(super) fn stated(
    path: &Path,
    head: &[u8],
    all: bool,
    encoding: Encoding,
) -> Result<FoundEncoding, IngestError> {
    let contradicts = |what: Note| {
        let message = note!(
            "ingest.delimited.not_this_encoding",
            stated = name(encoding),
            what = Arg::Note(Box::new(what))
        );
        IngestError::new(IngestErrorKind::UnknownFormat, path, message).hint("ingest.delimited.hint_encoding")
    };
    let found = find(head, all);
    let other =
        |f: &FoundEncoding| contradicts(note!("ingest.delimited.looks_like", encoding = name(f.encoding)));
    let wide = |e: Encoding| matches!(e, Encoding::Utf16Le | Encoding::Utf16Be);
    match &found {
        Some(f) if mark(head).is_some() && f.encoding != encoding => return Err(other(f)),
        Some(f) if wide(f.encoding) != wide(encoding) => return Err(other(f)),
        Some(f) if encoding == Encoding::Utf8 && f.encoding != Encoding::Utf8 => return Err(other(f)),
        Some(f) if wide(encoding) && f.encoding != encoding => return Err(other(f)),
        None if !wide(encoding) => return Err(contradicts(note!("ingest.delimited.holds_zeros"))),
        _ => {}
    }
    let damaged_at = found.and_then(|f| f.damaged_at).filter(|_| encoding == Encoding::Utf8);
    Ok(FoundEncoding { encoding, reason: note!("ingest.delimited.why_stated"), damaged_at })
}

/// The characters of Windows-1251 from 0x80 to 0xbf, as the WHATWG Encoding Standard has them; from 0xc0 on it has the Russian
/// alphabet, А to я.
const WINDOWS_1251: [char; 64] = [
    'Ђ', 'Ѓ', '‚', 'ѓ', '„', '…', '†', '‡', '€', '‰', 'Љ', '‹', 'Њ', 'Ќ', 'Ћ', 'Џ', //
    'ђ', '‘', '’', '“', '”', '•', '–', '—', '\u{98}', '™', 'љ', '›', 'њ', 'ќ', 'ћ', 'џ', //
    '\u{a0}', 'Ў', 'ў', 'Ј', '¤', 'Ґ', '¦', '§', 'Ё', '©', 'Є', '«', '¬', '\u{ad}', '®', 'Ї', //
    '°', '±', 'І', 'і', 'ґ', 'µ', '¶', '·', 'ё', '№', 'є', '»', 'ј', 'Ѕ', 'ѕ', 'ї',
];

fn windows_1251(byte: u8) -> char {
    match byte {
        ..0x80 => char::from(byte),
        0x80..0xc0 => {
            WINDOWS_1251.get(usize::from(byte - 0x80)).copied().unwrap_or(char::REPLACEMENT_CHARACTER)
        }
        0xc0.. => {
            char::from_u32(u32::from('А') + u32::from(byte - 0xc0)).unwrap_or(char::REPLACEMENT_CHARACTER)
        }
    }
}

/// Turns the bytes of a text into UTF-8, block after block; what is no character becomes U+FFFD, except in UTF-8 itself.
struct Decoder {
    encoding: Encoding,
    /// The first bytes of a character whose others come with the next block.
    begun: Vec<u8>,
}

impl Decoder {
    fn new(encoding: Encoding) -> Decoder {
        Decoder { encoding, begun: Vec::new() }
    }

    /// Adds the characters of a block; `last`: none follows.
    fn decode(&mut self, bytes: &[u8], last: bool, text: &mut Vec<u8>) {
        let unit: fn([u8; 2]) -> u16 = match self.encoding {
            Encoding::Utf8 => return text.extend_from_slice(bytes),
            Encoding::Windows1251 => return bytes.iter().for_each(|b| push(text, windows_1251(*b))),
            Encoding::Utf16Le => u16::from_le_bytes,
            Encoding::Utf16Be => u16::from_be_bytes,
        };
        let mut block = std::mem::take(&mut self.begun);
        block.extend_from_slice(bytes);
        let (pairs, half) = block.as_chunks::<2>();
        let mut units: Vec<u16> = pairs.iter().map(|pair| unit(*pair)).collect();
        if !last {
            // The first half of a character beyond the first 65 536 waits for the second one.
            let waits = units.pop_if(|u| (0xd800..0xdc00).contains(u)).is_some();
            let from = pairs.len().saturating_sub(usize::from(waits)) * 2;
            self.begun = block.get(from..).unwrap_or_default().to_vec();
        }
        let characters = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
        characters.for_each(|c| push(text, c));
        if last && !half.is_empty() {
            push(text, char::REPLACEMENT_CHARACTER);
        }
    }
}

fn push(text: &mut Vec<u8>, character: char) {
    text.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes());
}

/// Turns the start of a file into UTF-8; what is no character becomes U+FFFD, except in UTF-8 itself.
pub(super) fn decode(encoding: Encoding, head: &[u8], all: bool) -> Vec<u8> {
    let mut text = Vec::new();
    Decoder::new(encoding).decode(head, all, &mut text);
    text
}

/// The characters of a file as UTF-8, in order.
pub(super) struct TextStream {
    bytes: ByteStream,
    /// `None` where the file has UTF-8.
    decoder: Option<Decoder>,
    raw: Vec<u8>,
    /// Characters that were decoded, and how many of their bytes have passed.
    text: Vec<u8>,
    passed: usize,
    last: bool,
    ended: bool,
}

impl TextStream {
    /// Reads a text in an encoding from an opened file.
    pub(super) fn new(bytes: ByteStream, encoding: Encoding) -> TextStream {
        let decoder = (encoding != Encoding::Utf8).then(|| Decoder::new(encoding));
        let (raw, text) = (Vec::new(), Vec::new());
        TextStream { bytes, decoder, raw, text, passed: 0, last: false, ended: false }
    }

    /// Puts characters into the buffer, which has room for some; returns the bytes put in.
    ///
    /// # Errors
    /// As [`ByteStream::fill`].
    pub(super) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, IngestError> {
        let Some(decoder) = &mut self.decoder else {
            let n = self.bytes.fill(buffer)?;
            self.ended = n < buffer.len();
            return Ok(n);
        };
        let mut done = 0;
        while !self.ended {
            let ready = self.text.get(self.passed..).unwrap_or_default();
            let room = buffer.get_mut(done..).unwrap_or_default();
            let n = ready.len().min(room.len());
            for (to, from) in room.iter_mut().zip(ready) {
                *to = *from;
            }
            done += n;
            self.passed += n;
            if self.passed < self.text.len() {
                break;
            }
            if self.last {
                self.ended = true;
                break;
            }
            self.raw.resize(RAW, 0);
            let read = self.bytes.fill(&mut self.raw)?;
            self.last = read < RAW;
            self.text.clear();
            self.passed = 0;
            decoder.decode(self.raw.get(..read).unwrap_or_default(), self.last, &mut self.text);
        }
        Ok(done)
    }

    /// True when every character has passed.
    pub(super) fn ended(&self) -> bool {
        self.ended
    }

    /// Bytes of the file read so far.
    pub(super) fn file_bytes(&mut self) -> u64 {
        self.bytes.file_bytes()
    }

    /// As [`ByteStream::finish`].
    ///
    /// # Errors
    /// As there.
    pub(super) fn finish(self) -> Result<Digested, IngestError> {
        self.bytes.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_1251_has_its_letters_and_signs() {
        let of = |bytes: &[u8]| String::from_utf8(decode(Encoding::Windows1251, bytes, true)).unwrap();
        // As `iconv -t CP1251` writes them.
        assert_eq!(of(b"\xc2\xf0\xe5\xec\xff \xd6\xc0\xdf \xb9\xa8\xb8"), "Время ЦАЯ №Ёё");
        assert_eq!(of(b"\x80\x88\x8f\x90\x96\x99\x9f"), "Ђ€Џђ–™џ");
        assert_eq!(of(b"\xa0\xa7\xb0\xb1\xb5\xb7\xbb\xbf"), "\u{a0}§°±µ·»ї");
        let all: Vec<u8> = (0..=255).collect();
        let distinct: std::collections::BTreeSet<char> = of(&all).chars().collect();
        assert_eq!(distinct.len(), 256);
    }

    #[test]
    fn utf_16_is_the_same_in_blocks_of_any_size() {
        let text = "t;°/ч\n𝛺😀;\u{fffd}";
        let mut bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        // The first half of a character without the second one, in the middle and at the end; half a unit.
        bytes.extend_from_slice(&[0xd8, 0x00, 0x00, b'a', 0xdc, 0x00, 0xd8, 0x00, 0x00]);
        let expected = format!("{text}\u{fffd}a\u{fffd}\u{fffd}\u{fffd}");
        for size in 1..=bytes.len() {
            let (mut decoder, mut found) = (Decoder::new(Encoding::Utf16Be), Vec::new());
            for block in bytes.chunks(size) {
                decoder.decode(block, false, &mut found);
            }
            decoder.decode(&[], true, &mut found);
            assert_eq!(String::from_utf8(found).unwrap(), expected, "blocks of {size}");
        }
    }

    #[test]
    fn encodings_are_told_by_their_bytes() {
        let utf16 = |text: &str, le: bool| -> Vec<u8> {
            text.encode_utf16().flat_map(|u| if le { u.to_le_bytes() } else { u.to_be_bytes() }).collect()
        };
        let of = |head: &[u8]| find(head, true).map(|f| f.encoding);
        assert_eq!(of(b"t,r\n0,1\n"), Some(Encoding::Utf8));
        assert_eq!(of("t;°/ч\n0;1\n".as_bytes()), Some(Encoding::Utf8));
        assert_eq!(of(b"\xef\xbb\xbft\n"), Some(Encoding::Utf8));
        assert_eq!(of(b"\xff\xfet\0\n\0"), Some(Encoding::Utf16Le));
        assert_eq!(of(&utf16("t,r\n0,1\n", true)), Some(Encoding::Utf16Le));
        assert_eq!(of(&utf16("t,r\n0,1\n", false)), Some(Encoding::Utf16Be));
        // "Время;град/ч" in Windows-1251.
        assert_eq!(of(b"\xc2\xf0\xe5\xec\xff;\xe3\xf0\xe0\xe4/\xf7\n0;1\n"), Some(Encoding::Windows1251));
        assert_eq!(of(b"t;T [\xb0C]\n0;1\n"), Some(Encoding::Windows1251));
        assert_eq!(of(b"\xb9;\xd21\n0;1\n"), Some(Encoding::Windows1251));
        assert_eq!(of(b"t;r\n0;1\xff5\n"), Some(Encoding::Utf8));
        assert_eq!(of(b"abc\0def\0\x01"), None);
        assert_eq!(of(b"t,r\n0,1\0\n"), None);
        let damaged = find("°,r\n".as_bytes().get(..3).unwrap_or_default(), true);
        assert_eq!(damaged.unwrap().damaged_at, None);
        let damaged = find(b"\xc2\xb0,r\n0,\xff1\n", true).unwrap();
        assert_eq!((damaged.encoding, damaged.damaged_at), (Encoding::Utf8, Some(7)));
    }
}
