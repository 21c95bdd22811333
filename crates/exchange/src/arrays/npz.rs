//! NumPy's archive of arrays: NEP 1 (`.npy`, version 1.0) in a zip archive.

use std::io::{Error, Result, Write};
use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, StreamWriter, ZipWriter};

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// The header with what is before it has a multiple of this many bytes.
const ALIGNMENT: usize = 64;

pub(super) struct NpzWriter<W: Write> {
    zip: ZipWriter<StreamWriter<W>>,
}

impl<W: Write> NpzWriter<W> {
    pub(super) fn new(out: W) -> Self {
        Self { zip: ZipWriter::new_stream(out) }
    }

    /// Begins an array of doubles: of one dimension with `n` of them, or, without `n`, a single one.
    pub(super) fn begin_numbers(&mut self, name: &str, n: Option<u64>) -> Result<()> {
        let shape = n.map_or("()".to_owned(), |n| format!("({n},)"));
        self.begin(name, "<f8", &shape, n.unwrap_or(1).saturating_mul(8))
    }

    /// Begins a matrix of doubles, whose values come row by row.
    pub(super) fn begin_matrix(&mut self, name: &str, rows: u64, columns: u64) -> Result<()> {
        self.begin(name, "<f8", &format!("({rows}, {columns})"), rows.saturating_mul(columns).saturating_mul(8))
    }

    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.zip.write_all(bytes)
    }

    /// An array of words: UTF-32, each filled up with zeros to the longest one.
    pub(super) fn words(&mut self, name: &str, words: &[&str]) -> Result<()> {
        let width = words.iter().map(|word| word.chars().count()).max().unwrap_or(0).max(1);
        let bytes = (width * 4 * words.len()) as u64;
        self.begin(name, &format!("<U{width}"), &format!("({},)", words.len()), bytes)?;
        for word in words {
            let letters = word.chars().map(u32::from).chain(std::iter::repeat(0)).take(width);
            let letters: Vec<u8> = letters.flat_map(u32::to_le_bytes).collect();
            self.zip.write_all(&letters)?;
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<W> {
        Ok(self.zip.finish().map_err(Error::other)?.into_inner())
    }

    fn begin(&mut self, name: &str, kind: &str, shape: &str, bytes: u64) -> Result<()> {
        let is_large = bytes > u64::from(u32::MAX) - 1024;
        let options = SimpleFileOptions::DEFAULT.compression_method(CompressionMethod::Stored).large_file(is_large);
        self.zip.start_file(format!("{name}.npy"), options).map_err(Error::other)?;
        let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
        // Its length is in two bytes; a line break ends it.
        let before = MAGIC.len() + 2 + header.len() + 1;
        header.extend(std::iter::repeat_n(' ', before.next_multiple_of(ALIGNMENT) - before));
        header.push('\n');
        self.zip.write_all(MAGIC)?;
        self.zip.write_all(&(header.len() as u16).to_le_bytes())?;
        self.zip.write_all(header.as_bytes())
    }
}
