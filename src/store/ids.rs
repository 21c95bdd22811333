//! Generation of job ids: increasing also when the clock is set back, so that lists and the queue keep their order.

use super::connect::Store;
use super::lifecycle::JobId;
use sqlx::{Row, SqlitePool};
use std::sync::{Arc, Mutex, PoisonError};

/// Generates ids that are larger than all before. Holds the largest one.
#[derive(Debug, Clone, Default)]
pub(super) struct IdGenerator(Arc<Mutex<Option<JobId>>>);

impl IdGenerator {
    /// A generator that continues after the newest stored job.
    pub(super) async fn after_stored(pool: &SqlitePool) -> Result<Self, sqlx::Error> {
        let row = sqlx::query("SELECT MAX(id) AS id FROM jobs").fetch_one(pool).await?;
        let newest: Option<String> = row.try_get("id")?;
        Ok(Self(Arc::new(Mutex::new(newest.and_then(|text| text.parse().ok())))))
    }

    /// An id by the clock, or the next one after the largest id where the clock was set back.
    fn next(&self) -> JobId {
        let mut largest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let by_clock = JobId::new();
        let id = match *largest {
            Some(largest) if largest >= by_clock => largest.next(),
            _ => by_clock,
        };
        *largest = Some(id);
        id
    }
}

impl Store {
    /// The id for a new job.
    pub fn next_id(&self) -> JobId {
        self.ids.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_grow_although_the_clock_was_set_back() {
        // The largest id that the year 9999 can have.
        let ahead: JobId = "e677d21f-dbff-7fff-bfff-fffffffffff0".parse().expect("an id");
        let ids = IdGenerator(Arc::new(Mutex::new(Some(ahead))));
        let made: Vec<JobId> = (0..3).map(|_| ids.next()).collect();
        assert!(ahead < made[0] && made.windows(2).all(|two| two[0] < two[1]), "{made:?}");
        assert!(made.iter().all(|id| id.to_string().parse() == Ok(*id)));
        let fresh = IdGenerator::default();
        assert!(fresh.next() < fresh.next());
    }
}
