//! Finished stages in a directory: one file per content hash, so that finite elements are solved once per gear.

use herringbone_job::study::{Stage, StageStore};
use std::path::PathBuf;

/// A directory of stages. What cannot be read or written is solved again.
pub struct DirectoryStages {
    directory: PathBuf,
}

impl DirectoryStages {
    /// Opens the directory, which is created when it is not there.
    pub fn open(directory: PathBuf) -> std::io::Result<DirectoryStages> {
        std::fs::create_dir_all(&directory)?;
        Ok(DirectoryStages { directory })
    }
}

impl StageStore for DirectoryStages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        std::fs::read(self.directory.join(key)).ok()
    }

    fn save(&self, key: &str, _stage: Stage, bytes: &[u8]) {
        // Written beside and renamed: a reader never sees half a file.
        let partial = self.directory.join(format!("{key}.{}.partial", std::process::id()));
        let kept = std::fs::write(&partial, bytes).and_then(|()| std::fs::rename(&partial, self.directory.join(key)));
        if let Err(error) = kept {
            eprintln!("--cache {}: {error}", self.directory.display());
        }
    }
}
