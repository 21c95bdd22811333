//! Arrays as files of numerical programs: NumPy (`.npz`) and MATLAB (`.mat`, version 5).
//!
//! Written front to back, a piece at a time: the length of an array is said before its values. Arrays of words carry
//! names and units, as neither form has a place for them.

mod mat;
mod names;
mod npz;
#[cfg(test)]
mod tests;

pub use names::ArrayNames;

use std::io::{Error, ErrorKind, Result, Write};

/// The form of a file of arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArrayForm {
    /// NumPy: a zip archive, stored, with one `.npy` of version 1.0 for each array.
    Npz,
    /// MATLAB 5.0 MAT-file, not compressed: MATLAB, Octave, Simulink, SciPy.
    Mat,
}

impl ArrayForm {
    /// The media type of the file.
    pub fn media_type(self) -> &'static str {
        match self {
            ArrayForm::Npz => "application/x-npz",
            ArrayForm::Mat => "application/x-matlab-data",
        }
    }

    /// The ending of its name.
    pub fn ending(self) -> &'static str {
        match self {
            ArrayForm::Npz => "npz",
            ArrayForm::Mat => "mat",
        }
    }

    /// The names of the file's arrays.
    pub fn names(self) -> ArrayNames {
        ArrayNames::new(match self {
            ArrayForm::Npz => usize::MAX,
            ArrayForm::Mat => mat::MAX_NAME,
        })
    }

    /// Largest number of values of an array.
    pub fn max_values(self) -> u64 {
        match self {
            ArrayForm::Npz => u64::MAX,
            ArrayForm::Mat => mat::MAX_VALUES,
        }
    }
}

/// Writes arrays one after the other.
pub struct ArrayWriter<W: Write> {
    file: File<W>,
    /// Values of the array that is being written which are still to come.
    left: u64,
}

enum File<W: Write> {
    Npz(Box<npz::NpzWriter<W>>),
    Mat(mat::MatWriter<W>),
}

impl<W: Write> ArrayWriter<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(form: ArrayForm, out: W) -> Result<Self> {
        let file = match form {
            ArrayForm::Npz => File::Npz(Box::new(npz::NpzWriter::new(out))),
            ArrayForm::Mat => File::Mat(mat::MatWriter::new(out)?),
        };
        Ok(Self { file, left: 0 })
    }

    /// Begins an array of `n` numbers: of `n` rows and one column in MATLAB.
    ///
    /// # Errors
    /// Those of the file; the array before is not complete, or this one is too large for the form.
    pub fn begin(&mut self, name: &str, n: u64) -> Result<()> {
        self.check_complete()?;
        self.left = n;
        match &mut self.file {
            File::Npz(file) => file.begin_numbers(name, Some(n)),
            File::Mat(file) => file.begin_numbers(name, n),
        }
    }

    /// Adds values to the array that was begun.
    ///
    /// # Errors
    /// Those of the file; there are more than the array was begun with.
    pub fn push(&mut self, values: &[f64]) -> Result<()> {
        let n = values.len() as u64;
        self.left = self.left.checked_sub(n).ok_or_else(|| invalid("more values than the array has"))?;
        let mut bytes = Vec::with_capacity(values.len() * 8);
        values.iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
        match &mut self.file {
            File::Npz(file) => file.write(&bytes),
            File::Mat(file) => file.write(&bytes),
        }
    }

    /// Adds an array at once.
    ///
    /// # Errors
    /// As [`ArrayWriter::begin`].
    pub fn numbers(&mut self, name: &str, values: &[f64]) -> Result<()> {
        self.begin(name, values.len() as u64)?;
        self.push(values)
    }

    /// Adds one number.
    ///
    /// # Errors
    /// As [`ArrayWriter::begin`].
    pub fn scalar(&mut self, name: &str, value: f64) -> Result<()> {
        if let File::Npz(file) = &mut self.file {
            if self.left > 0 {
                return Err(invalid("the array before is not complete"));
            }
            file.begin_numbers(name, None)?;
            return file.write(&value.to_le_bytes());
        }
        self.numbers(name, &[value])
    }

    /// Adds a matrix, given by its rows.
    ///
    /// # Errors
    /// As [`ArrayWriter::begin`]; the rows differ in length.
    pub fn matrix(&mut self, name: &str, rows: &[Vec<f64>]) -> Result<()> {
        self.check_complete()?;
        let columns = rows.first().map_or(0, Vec::len);
        if rows.iter().any(|row| row.len() != columns) {
            return Err(invalid("the rows of a matrix differ in length"));
        }
        let (n_rows, n_columns) = (rows.len() as u64, columns as u64);
        let values: Vec<f64> = match &mut self.file {
            File::Npz(file) => {
                file.begin_matrix(name, n_rows, n_columns)?;
                rows.concat()
            }
            File::Mat(file) => {
                file.begin_matrix(name, n_rows, n_columns)?;
                (0..columns).flat_map(|column| rows.iter().map(move |row| row[column])).collect()
            }
        };
        self.left = n_rows * n_columns;
        self.push(&values)
    }

    /// Adds an array of words.
    ///
    /// # Errors
    /// As [`ArrayWriter::begin`].
    pub fn words(&mut self, name: &str, words: &[&str]) -> Result<()> {
        self.check_complete()?;
        match &mut self.file {
            File::Npz(file) => file.words(name, words),
            File::Mat(file) => file.words(name, words),
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the file; an array is not complete.
    pub fn finish(self) -> Result<W> {
        self.check_complete()?;
        match self.file {
            File::Npz(file) => file.finish(),
            File::Mat(file) => Ok(file.into_inner()),
        }
    }

    fn check_complete(&self) -> Result<()> {
        if self.left > 0 { Err(invalid("the array before is not complete")) } else { Ok(()) }
    }
}

fn invalid(text: &str) -> Error {
    Error::new(ErrorKind::InvalidInput, text)
}
