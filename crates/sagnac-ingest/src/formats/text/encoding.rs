//! The characters of a text file: UTF-8, UTF-16 or Windows-1251, found from its first bytes and turned into UTF-8 as the
//! bytes pass. UTF-8 itself passes untouched.

use crate::byte_stream::{ByteStream, Digested};
use crate::error::{IngestError, IngestErrorKind};
use crate::options::Encoding;
use sagnac_core::message::{Arg, Note};
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
        reason: Note::new("ingest.delimited.why_mostly"),
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
        let message = Note::new("ingest.delimited.not_this_encoding")
            .with("stated", name(encoding))
            .with("what", Arg::Note(Box::new(what)));
        IngestError::new(IngestErrorKind::UnknownFormat, path, message).hint("ingest.delimited.hint_encoding")
    };
    let found = find(head, all);
    let other = |f: &FoundEncoding| {
        contradicts(Note::new("ingest.delimited.looks_like").with("encoding", name(f.encoding)))
    };
    let wide = |e: Encoding| matches!(e, Encoding::Utf16Le | Encoding::Utf16Be);
    match &found {
        Some(f) if mark(head).is_some() && f.encoding != encoding => return Err(other(f)),
        Some(f) if wide(f.encoding) != wide(encoding) => return Err(other(f)),
        Some(f) if encoding == Encoding::Utf8 && f.encoding != Encoding::Utf8 => return Err(other(f)),
        Some(f) if wide(encoding) && f.encoding != encoding => return Err(other(f)),
        None if !wide(encoding) => return Err(contradicts(Note::new("ingest.delimited.holds_zeros"))),
        _ => {}
    }
    let damaged_at = found.and_then(|f| f.damaged_at).filter(|_| encoding == Encoding::Utf8);
    Ok(FoundEncoding { encoding, reason: Note::new("ingest.delimited.why_stated"), damaged_at })
}

fn decoder(encoding: Encoding) -> Option<encoding_rs::Decoder> {
    let table = match encoding {
        Encoding::Utf8 => return None,
        Encoding::Utf16Le => encoding_rs::UTF_16LE,
        Encoding::Utf16Be => encoding_rs::UTF_16BE,
        Encoding::Windows1251 => encoding_rs::WINDOWS_1251,
    };
    Some(table.new_decoder_without_bom_handling())
}

/// Turns the start of a file into UTF-8; what is no character becomes U+FFFD, except in UTF-8 itself.
pub(super) fn decode(encoding: Encoding, head: &[u8], all: bool) -> Vec<u8> {
    let Some(mut decoder) = decoder(encoding) else { return head.to_vec() };
    let room = decoder.max_utf8_buffer_length(head.len()).unwrap_or(0);
    let mut out = vec![0; room];
    let (_, _, written, _) = decoder.decode_to_utf8(head, &mut out, all);
    out.truncate(written);
    out
}

/// The characters of a file as UTF-8, in order.
pub(super) struct TextStream {
    bytes: ByteStream,
    decoder: Option<encoding_rs::Decoder>,
    raw: Vec<u8>,
    at: usize,
    last: bool,
    ended: bool,
}

impl TextStream {
    /// Reads a text in an encoding from an opened file.
    pub(super) fn new(bytes: ByteStream, encoding: Encoding) -> TextStream {
        TextStream { bytes, decoder: decoder(encoding), raw: Vec::new(), at: 0, last: false, ended: false }
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
            if self.at >= self.raw.len() && !self.last {
                self.raw.resize(RAW, 0);
                let n = self.bytes.fill(&mut self.raw)?;
                self.raw.truncate(n);
                self.at = 0;
                self.last = n < RAW;
            }
            let source = self.raw.get(self.at..).unwrap_or_default();
            let room = buffer.get_mut(done..).unwrap_or_default();
            let (result, read, written, _) = decoder.decode_to_utf8(source, room, self.last);
            self.at += read;
            done += written;
            match result {
                encoding_rs::CoderResult::OutputFull => break,
                encoding_rs::CoderResult::InputEmpty => self.ended = self.last,
            }
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
