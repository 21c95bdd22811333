//! The input files of a batch.

use crate::cli::input::read_bytes;
use herringbone::api::{MAX_BODY_BYTES, MAX_IMPORT_BYTES, Problem, ProblemCode};
use herringbone_exchange::{ImportOptions, import};
use herringbone_job::document::JobDocument;
use std::io;
use std::path::{Path, PathBuf};

/// Endings of gear models; `.json` alone is a job document.
const MODELS: [&str; 7] = [".rexs", ".rexsj", ".rexsz", ".rexs.xml", ".rexs.json", ".rexs.zip", ".z12"];

/// A file to be solved.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct InputFile {
    /// Path below the folder, with slashes.
    pub name: String,
    path: PathBuf,
    is_model: bool,
}

impl InputFile {
    /// The document in the file, or made of the model in it.
    ///
    /// # Errors
    /// The file cannot be read, or is refused.
    pub(super) fn read(&self, options: &ImportOptions) -> Result<JobDocument, Box<Problem>> {
        let most = if self.is_model { MAX_IMPORT_BYTES } else { MAX_BODY_BYTES };
        let bytes = read_bytes(&self.path, most as u64)
            .map_err(|error| Problem::new(ProblemCode::InvalidDesign, format!("cannot be read: {error}")))?;
        if !self.is_model {
            return herringbone_job::parse(&bytes).map_err(|error| Box::new(error.into()));
        }
        let imported = import(&bytes, options).map_err(|refusal| Box::new(Problem::from(refusal)))?;
        herringbone_job::parse_value(&imported.document).map_err(|error| Box::new(error.into()))
    }
}

/// The files below a folder by name, without those in the folder of the results and hidden ones.
///
/// # Errors
/// A folder cannot be read.
pub(super) fn below(folder: &Path, out: &Path) -> io::Result<Vec<InputFile>> {
    let out = out.canonicalize()?;
    let mut files = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(directory) = open.pop() {
        for entry in std::fs::read_dir(&directory)? {
            let entry = entry?;
            let path = entry.path();
            let file_name = entry.file_name().to_string_lossy().into_owned();
            if file_name.starts_with('.') {
                continue;
            }
            if entry.file_type()?.is_dir() {
                if path.canonicalize()? != out {
                    open.push(path);
                }
                continue;
            }
            let lower = file_name.to_ascii_lowercase();
            let is_model = MODELS.iter().any(|ending| lower.ends_with(ending));
            if is_model || lower.ends_with(".json") {
                let parts = path.strip_prefix(folder).unwrap_or(&path).components();
                let parts: Vec<_> = parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
                files.push(InputFile { name: parts.join("/"), path, is_model });
            }
        }
    }
    files.sort();
    Ok(files)
}
