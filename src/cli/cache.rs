//! The cache of stages in a directory: one file for each hash of the inputs of a stage.

use herringbone_job::study::{Stage, StageStore};
use std::path::PathBuf;

/// A directory with cached stages. Stages that cannot be read are solved again; errors of writing are reported on
/// standard error.
pub(super) struct DirectoryStages {
    directory: PathBuf,
}

impl DirectoryStages {
    /// Opens the directory; creates it when missing.
    ///
    /// # Errors
    /// It cannot be created.
    pub(super) fn open(directory: PathBuf) -> std::io::Result<DirectoryStages> {
        std::fs::create_dir_all(&directory)?;
        Ok(DirectoryStages { directory })
    }
}

impl StageStore for DirectoryStages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        std::fs::read(self.directory.join(key)).ok()
    }

    fn save(&self, key: &str, _stage: Stage, bytes: &[u8]) {
        // Renamed when complete, so that no reader sees a partial file.
        let partial = self.directory.join(format!("{key}.{}.partial", std::process::id()));
        let written =
            std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, self.directory.join(key)));
        if let Err(error) = written {
            eprintln!("--cache {}: {error}", self.directory.display());
        }
    }
}
