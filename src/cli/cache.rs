//! The cache of stages in a directory: one file for each hash of the inputs of a stage.

use herringbone_job::study::{Stage, StageStore};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Extension of a file that is being written, and the time after which nobody writes it any more.
const PARTIAL: &str = "partial";
const UNFINISHED_AFTER: Duration = Duration::from_secs(3600);

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
        remove_unfinished(&directory);
        Ok(DirectoryStages { directory })
    }
}

/// Removes the files that killed processes left unfinished: those to which nothing was written for an hour.
fn remove_unfinished(directory: &Path) {
    let Ok(entries) = std::fs::read_dir(directory) else { return };
    for path in entries.filter_map(Result::ok).map(|entry| entry.path()) {
        let is_partial = path.extension().is_some_and(|extension| extension == PARTIAL);
        let written = path.metadata().and_then(|metadata| metadata.modified()).ok();
        let age = written.and_then(|written| written.elapsed().ok());
        if is_partial && age.is_some_and(|age| age > UNFINISHED_AFTER) {
            let _ = std::fs::remove_file(path);
        }
    }
}

impl StageStore for DirectoryStages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        std::fs::read(self.directory.join(key)).ok()
    }

    fn save(&self, key: &str, _stage: Stage, bytes: &[u8]) {
        // Renamed when complete, so that no reader sees a partial file.
        let partial = self.directory.join(format!("{key}.{}.{PARTIAL}", std::process::id()));
        let written =
            std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, self.directory.join(key)));
        if let Err(error) = written {
            eprintln!("--cache {}: {error}", self.directory.display());
        }
    }
}
