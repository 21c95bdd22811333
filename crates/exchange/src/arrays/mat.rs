//! MATLAB's file of variables, version 5 ("MAT-File Format", MathWorks): a header, then a `miMATRIX` element for each
//! variable, its parts filled up to multiples of eight bytes.

use super::invalid;
use std::io::{Result, Write};

/// Longest name of a variable.
pub(super) const MAX_NAME: usize = 63;
/// Largest number of values of a variable, which has 2³¹ − 1 bytes at most.
pub(super) const MAX_VALUES: u64 = (i32::MAX as u64 - 1024) / 8;

/// Types of elements, and classes of arrays.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const CHAR_CLASS: u32 = 4;
const DOUBLE_CLASS: u32 = 6;

pub(super) struct MatWriter<W: Write> {
    out: W,
}

impl<W: Write> MatWriter<W> {
    pub(super) fn new(mut out: W) -> Result<Self> {
        let mut header = b"MATLAB 5.0 MAT-file, written by herringbone".to_vec();
        header.resize(116, b' ');
        // No subsystem data; version 1.0; the order of bytes.
        header.extend_from_slice(&[0; 8]);
        header.extend_from_slice(&0x0100_u16.to_le_bytes());
        header.extend_from_slice(b"IM");
        out.write_all(&header)?;
        Ok(Self { out })
    }

    /// Begins a column of doubles.
    pub(super) fn begin_numbers(&mut self, name: &str, n: u64) -> Result<()> {
        if n > MAX_VALUES {
            return Err(invalid("a MAT-file of version 5 has no room for so many values"));
        }
        self.begin(name, DOUBLE_CLASS, (n, 1), (DOUBLE, n * 8))
    }

    /// Begins a matrix of doubles, whose values come column by column.
    pub(super) fn begin_matrix(&mut self, name: &str, rows: u64, columns: u64) -> Result<()> {
        let n = rows.saturating_mul(columns);
        if n > MAX_VALUES {
            return Err(invalid("a MAT-file of version 5 has no room for so many values"));
        }
        self.begin(name, DOUBLE_CLASS, (rows, columns), (DOUBLE, n * 8))
    }

    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.out.write_all(bytes)
    }

    /// An array of letters: a word in each row, filled up with blanks.
    pub(super) fn words(&mut self, name: &str, words: &[&str]) -> Result<()> {
        let rows: Vec<Vec<u16>> = words.iter().map(|word| word.encode_utf16().collect()).collect();
        let width = rows.iter().map(Vec::len).max().unwrap_or(0);
        let mut bytes = Vec::with_capacity(2 * width * rows.len());
        for column in 0..width {
            for row in &rows {
                bytes.extend_from_slice(&row.get(column).copied().unwrap_or(u16::from(b' ')).to_le_bytes());
            }
        }
        let n_bytes = bytes.len() as u64;
        if n_bytes / 8 > MAX_VALUES {
            return Err(invalid("a MAT-file of version 5 has no room for so many words"));
        }
        self.begin(name, CHAR_CLASS, (rows.len() as u64, width as u64), (UINT16, n_bytes))?;
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        self.out.write_all(&bytes)
    }

    pub(super) fn into_inner(self) -> W {
        self.out
    }

    /// Writes everything of a variable that precedes its data.
    fn begin(&mut self, name: &str, class: u32, (rows, columns): (u64, u64), (kind, bytes): (u32, u64)) -> Result<()> {
        let name = name.as_bytes();
        let name_bytes = name.len().next_multiple_of(8);
        // Flags, dimensions, name and data, each with its tag of eight bytes.
        let total = 16 + 16 + 8 + name_bytes as u64 + 8 + bytes.next_multiple_of(8);
        let mut head = Vec::new();
        for word in
            [MATRIX, total as u32, UINT32, 8, class, 0, INT32, 8, rows as u32, columns as u32, INT8, name.len() as u32]
        {
            head.extend_from_slice(&word.to_le_bytes());
        }
        head.extend_from_slice(name);
        head.resize(head.len() + name_bytes - name.len(), 0);
        head.extend_from_slice(&kind.to_le_bytes());
        head.extend_from_slice(&(bytes as u32).to_le_bytes());
        self.out.write_all(&head)
    }
}
