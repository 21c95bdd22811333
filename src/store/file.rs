//! The file of the database: its name, its lock, and whether its name still leads to it.

use super::examine::with_suffix;
use super::open_error::OpenError;
use nix::errno::Errno;
use nix::fcntl::{FcntlArg, fcntl};
use nix::libc;
use std::fmt;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Suffixes of the files of SQLite beside a database (sqlite.org/tempfiles.html).
pub(super) const WAL: &str = "-wal";
pub(super) const SHM: &str = "-shm";
pub(super) const JOURNAL: &str = "-journal";
/// Suffix of the lock file beside a database.
pub(super) const LOCK: &str = ".lock";

/// The byte of the database file that is locked: beyond those that SQLite locks (512 bytes from 1 GiB), at an offset
/// that every file system with large files permits. It need not exist.
const LOCKED_BYTE: i64 = (1 << 40) - 1;
/// Permissions of a new database file, before the umask: those that SQLite gives.
const NEW_FILE_MODE: u32 = 0o644;

/// An opened and locked database file.
pub(super) struct DatabaseFile {
    path: PathBuf,
    /// Files that belong to the open database, by their names.
    members: Vec<(PathBuf, FileId)>,
    /// The last result of [`DatabaseFile::check`].
    is_lost: AtomicBool,
    /// Hold the locks. Closing any descriptor of the database file drops the locks of SQLite in this process, so this
    /// one stays open as long as the connections.
    _database: File,
    _lock_file: File,
}

/// The identity of a file, which its names share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FileId {
    device: u64,
    inode: u64,
}

impl FileId {
    fn of(metadata: &Metadata) -> Self {
        Self { device: metadata.dev(), inode: metadata.ino() }
    }

    /// The file to which a path leads, also through symbolic links; `None` when there is none.
    pub(super) fn at(path: &Path) -> Option<Self> {
        fs::metadata(path).ok().map(|metadata| Self::of(&metadata))
    }
}

/// A file of the open database that its name no longer leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum LostFile {
    /// The database itself was moved or deleted.
    Database(PathBuf),
    /// The database was moved or deleted, and another file has its name.
    Replaced(PathBuf),
    /// The write-ahead log or its index was moved or deleted.
    Log(PathBuf),
}

impl fmt::Display for LostFile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Database(path) => {
                write!(formatter, "{} was moved or deleted: put it back under this name", path.display())
            }
            Self::Replaced(path) => write!(
                formatter,
                "{} is another file than the one that was opened: put that one back under this name, or restart the \
                 service to use the other one",
                path.display()
            ),
            Self::Log(path) => write!(
                formatter,
                "{} was moved or deleted: restart the service; when it ends by SIGTERM, it writes the content of the \
                 log into the database",
                path.display()
            ),
        }
    }
}

impl DatabaseFile {
    /// Opens the database file, or creates an empty one where there is none, and locks it against other processes of
    /// the service, each of which would treat the others' running jobs as lost. The lock belongs to the file, not to
    /// one of its names; older versions lock only a file beside the name, so that is locked too.
    ///
    /// # Errors
    /// The file is in use, cannot be written, has several names, or is missing beside its log.
    pub(super) fn open(database: &Path) -> Result<Self, OpenError> {
        let path = without_link(database)?;
        if fs::metadata(&path).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(OpenError::NotAFile(path));
        }
        let lock_file = lock_beside(&path)?;
        refuse_orphaned_log(&path)?;
        let file_error = |error| OpenError::of_file(&path, error);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false).mode(NEW_FILE_MODE);
        let database = options.open(&path).map_err(file_error)?;
        lock(&database, &path)?;
        let metadata = database.metadata().map_err(file_error)?;
        refuse_several_names(&path, &metadata)?;
        let members = vec![(path.clone(), FileId::of(&metadata))];
        Ok(Self { path, members, is_lost: AtomicBool::new(false), _database: database, _lock_file: lock_file })
    }

    /// The path of the file itself, where it was named by a symbolic link.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Takes the log and its index for files of the open database; they exist as long as it has connections.
    pub(super) fn add_log(&mut self) {
        let names = [WAL, SHM].map(|suffix| with_suffix(&self.path, suffix));
        self.members.extend(names.into_iter().filter_map(|name| FileId::at(&name).map(|id| (name, id))));
    }

    /// Checks that each name still leads to the file that was opened, and logs when that changes.
    pub(super) fn check(&self) -> Result<(), LostFile> {
        let lost = self.lost_file();
        match (self.is_lost.swap(lost.is_some(), Ordering::Relaxed), &lost) {
            (false, Some(lost)) => {
                tracing::error!(file = %lost, "a file of the database is lost: nothing is written, no job is accepted");
            }
            (true, None) => {
                tracing::info!(path = %self.path.display(), "the database is complete again: jobs are accepted");
            }
            _ => {}
        }
        lost.map_or(Ok(()), Err)
    }

    fn lost_file(&self) -> Option<LostFile> {
        let (name, found) = self
            .members
            .iter()
            .map(|(name, id)| (name, id, FileId::at(name)))
            .find_map(|(name, id, found)| (found != Some(*id)).then(|| (name.clone(), found)))?;
        Some(match (name == self.path, found) {
            (false, _) => LostFile::Log(name),
            (true, None) => LostFile::Database(name),
            (true, Some(_)) => LostFile::Replaced(name),
        })
    }
}

/// Follows a symbolic link, as SQLite does: the files beside the database lie beside the file itself.
pub(super) fn without_link(database: &Path) -> Result<PathBuf, OpenError> {
    match fs::read_link(database) {
        Err(_) => Ok(database.to_owned()),
        Ok(target) => fs::canonicalize(database).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => OpenError::BrokenLink { path: database.to_owned(), target },
            _ => OpenError::of_file(database, error),
        }),
    }
}

/// Refuses to begin anew beside the log of a database that is gone: SQLite would delete the log, and with it the jobs
/// that had not been moved from it into the database.
pub(super) fn refuse_orphaned_log(path: &Path) -> Result<(), OpenError> {
    match fs::metadata(path) {
        Ok(database) if database.len() > 0 => return Ok(()),
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(OpenError::of_file(path, error)),
        _ => {}
    }
    let has_content = |log: &Path| fs::metadata(log).is_ok_and(|log| log.len() > 0);
    let (wal, journal) = (with_suffix(path, WAL), with_suffix(path, JOURNAL));
    let log = [(&wal, has_content(&wal)), (&journal, has_content(&journal) && !is_journal_of_creation(&journal))];
    match log.into_iter().find(|(_, is_orphaned)| *is_orphaned) {
        Some((log, _)) => Err(OpenError::OrphanedLog { path: path.to_owned(), log: log.clone() }),
        None => Ok(()),
    }
}

/// Whether a rollback journal leads back to an empty database: the creation of a file was interrupted. The number of
/// pages before the transaction is in its header (sqlite.org/fileformat.html, 3).
fn is_journal_of_creation(journal: &Path) -> bool {
    let mut header = [0; 28];
    let read = File::open(journal).and_then(|mut journal| journal.read_exact(&mut header));
    read.is_ok() && header[16..20] == [0; 4]
}

/// Refuses a file with several names (hard links): the log lies beside the name under which the database was last open,
/// and under another name it would be opened without it.
pub(super) fn refuse_several_names(path: &Path, metadata: &Metadata) -> Result<(), OpenError> {
    match metadata.nlink() {
        0 | 1 => Ok(()),
        names => Err(OpenError::SeveralNames { path: path.to_owned(), names }),
    }
}

/// Locks the file beside the name.
fn lock_beside(database: &Path) -> Result<File, OpenError> {
    let path = with_suffix(database, LOCK);
    // The error about a missing directory names the database, others the lock file.
    let lock_error = |error: io::Error| match OpenError::of_file(&path, error) {
        OpenError::NoDirectory(_) => OpenError::NoDirectory(database.to_owned()),
        other => other,
    };
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path).map_err(lock_error)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(fs::TryLockError::WouldBlock) => Err(OpenError::InUse(database.to_owned())),
        Err(fs::TryLockError::Error(source)) => Err(OpenError::NoLocks { path, source }),
    }
}

/// Locks a file that may be a database: a lock of the open file description, which neither conflicts with SQLite's nor
/// is dropped with them, and which network file systems have too.
fn lock(file: &File, path: &Path) -> Result<(), OpenError> {
    match try_lock(file) {
        Ok(true) => Ok(()),
        Ok(false) => Err(OpenError::InUse(path.to_owned())),
        Err(source) => Err(OpenError::NoLocks { path: path.to_owned(), source }),
    }
}

/// Tries to lock a file for as long as it is open. False when another process holds the lock.
pub(super) fn try_lock(file: &File) -> io::Result<bool> {
    match fcntl(file, FcntlArg::F_OFD_SETLK(&byte_lock())) {
        Ok(_) => Ok(true),
        Err(Errno::EAGAIN | Errno::EACCES) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

/// Whether a process has locked this file.
pub(super) fn is_locked(path: &Path) -> io::Result<bool> {
    let mut lock = byte_lock();
    fcntl(File::open(path)?, FcntlArg::F_OFD_GETLK(&mut lock))?;
    Ok(lock.l_type != libc::F_UNLCK as libc::c_short)
}

/// An exclusive lock of one byte.
fn byte_lock() -> libc::flock {
    libc::flock {
        l_type: libc::F_WRLCK as libc::c_short,
        l_whence: libc::SEEK_SET as libc::c_short,
        l_start: LOCKED_BYTE,
        l_len: 1,
        l_pid: 0,
    }
}
