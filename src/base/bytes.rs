//! Numbers and texts as bytes and back, for what processes of this program say to one another: whole numbers seven bits at
//! a time, least first (LEB128), numbers as their 64 bits, texts with their length before them.
//!
//! Bytes may come from anywhere: reading them never fails in another way than with [`Malformed`], and never takes more
//! memory than there are bytes.

use thiserror::Error;

/// Bytes that mean nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Malformed(pub &'static str);

/// Writes bytes.
#[derive(Clone, Debug, Default)]
pub struct Encoder {
    bytes: Vec<u8>,
}

impl Encoder {
    /// One byte.
    pub fn byte(&mut self, byte: u8) {
        self.bytes.push(byte);
    }

    /// A whole number: one byte below 128, ten at most.
    pub fn whole(&mut self, mut number: u64) {
        while number >= 0x80 {
            self.bytes.push(number as u8 | 0x80);
            number >>= 7;
        }
        self.bytes.push(number as u8);
    }

    /// A number, bit by bit.
    pub fn number(&mut self, number: f64) {
        self.bytes.extend_from_slice(&number.to_bits().to_le_bytes());
    }

    /// Bytes, their number before them.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.whole(bytes.len() as u64);
        self.bytes.extend_from_slice(bytes);
    }

    /// A text.
    pub fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    /// What was written.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads bytes in the order in which they were written.
#[derive(Clone, Debug)]
pub struct Decoder<'b> {
    rest: &'b [u8],
}

impl<'b> Decoder<'b> {
    /// From the first of some bytes.
    pub const fn new(bytes: &'b [u8]) -> Self {
        Self { rest: bytes }
    }

    /// One byte.
    pub fn byte(&mut self) -> Result<u8, Malformed> {
        let (&first, rest) = self.rest.split_first().ok_or(Malformed("bytes are missing"))?;
        self.rest = rest;
        Ok(first)
    }

    /// A whole number.
    pub fn whole(&mut self) -> Result<u64, Malformed> {
        let mut number = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if shift == 63 && bits > 1 {
                break;
            }
            number |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(Malformed("a whole number has more than 64 bits"))
    }

    /// A whole number as an index or a size.
    pub fn size(&mut self) -> Result<usize, Malformed> {
        usize::try_from(self.whole()?).map_err(|_| Malformed("an index is too large"))
    }

    /// How many things follow, where each takes one byte at least: never more than there are bytes left.
    pub fn count(&mut self) -> Result<usize, Malformed> {
        let count = self.size()?;
        if count <= self.rest.len() { Ok(count) } else { Err(Malformed("a list is cut short")) }
    }

    /// A number.
    pub fn number(&mut self) -> Result<f64, Malformed> {
        let (bits, rest) = self.rest.split_first_chunk().ok_or(Malformed("bytes are missing"))?;
        self.rest = rest;
        Ok(f64::from_bits(u64::from_le_bytes(*bits)))
    }

    /// Bytes.
    pub fn bytes(&mut self) -> Result<&'b [u8], Malformed> {
        let count = self.count()?;
        let (bytes, rest) = self.rest.split_at(count);
        self.rest = rest;
        Ok(bytes)
    }

    /// A text.
    pub fn text(&mut self) -> Result<&'b str, Malformed> {
        std::str::from_utf8(self.bytes()?).map_err(|_| Malformed("a text is not UTF-8"))
    }

    /// All was read.
    pub fn end(&self) -> Result<(), Malformed> {
        if self.rest.is_empty() { Ok(()) } else { Err(Malformed("bytes are left over")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_was_written_is_read(whole: u64, bits: u64, text: String, bytes: Vec<u8>) {
            let mut encoder = Encoder::default();
            encoder.whole(whole);
            encoder.number(f64::from_bits(bits));
            encoder.text(&text);
            encoder.bytes(&bytes);
            encoder.byte(7);
            let written = encoder.finish();
            let mut decoder = Decoder::new(&written);
            prop_assert_eq!(decoder.whole(), Ok(whole));
            prop_assert_eq!(decoder.number().map(f64::to_bits), Ok(bits));
            prop_assert_eq!(decoder.text(), Ok(text.as_str()));
            prop_assert_eq!(decoder.bytes(), Ok(bytes.as_slice()));
            prop_assert_eq!(decoder.end(), Err(Malformed("bytes are left over")));
            prop_assert_eq!(decoder.byte(), Ok(7));
            prop_assert_eq!(decoder.end(), Ok(()));
        }
    }

    #[test]
    fn whole_numbers_beyond_64_bits_and_lists_beyond_the_end_are_refused() {
        let most = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01];
        assert_eq!(Decoder::new(&most).whole(), Ok(u64::MAX));
        let more = [0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02];
        assert!(Decoder::new(&more).whole().is_err());
        assert!(Decoder::new(&[0xff; 20]).whole().is_err());
        assert!(Decoder::new(&most).bytes().is_err());
        assert!(Decoder::new(&[2, 0xff, 0xfe]).text().is_err());
        assert!(Decoder::new(&[]).byte().is_err());
    }
}
