//! Changes of what people write on a job: name, label and notes. They are no transition of its state.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use super::record::{JobRecord, job_columns};
use sqlx::{QueryBuilder, Sqlite};

/// New texts of a job: `None` leaves one as it is, `Some(None)` removes it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct JobDescription {
    pub name: Option<Option<String>>,
    pub label: Option<Option<String>>,
    pub notes: Option<Option<String>>,
}

/// The outcome of a change of a job's texts.
#[derive(Debug, Clone, PartialEq)]
pub enum Described {
    Changed(JobRecord),
    /// The job has these texts already.
    Unchanged(JobRecord),
    NotFound,
}

impl Store {
    /// Changes texts of a job, whatever its state. Its document stays as it was accepted.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn describe(&self, id: JobId, description: &JobDescription) -> Result<Described, StoreError> {
        let JobDescription { name, label, notes } = description;
        let texts = [("name", name), ("label", label), ("notes", notes)];
        let given = || texts.iter().filter_map(|(column, text)| Some((*column, text.as_ref()?)));
        let mut changed = None;
        if given().next().is_some() {
            let mut query: QueryBuilder<Sqlite> = QueryBuilder::new("UPDATE jobs SET revision = revision + 1");
            for (column, text) in given() {
                query.push(format!(", {column} = ")).push_bind(text.clone());
            }
            query.push(" WHERE id = ").push_bind(id.to_string()).push(" AND (0");
            for (column, text) in given() {
                query.push(format!(" OR {column} IS NOT ")).push_bind(text.clone());
            }
            query.push(concat!(") RETURNING ", job_columns!()));
            let mut transaction = self.begin().await?;
            changed = query.build_query_as().fetch_optional(&mut *transaction).await?;
            transaction.commit().await?;
        }
        if let Some(job) = changed {
            return Ok(Described::Changed(job));
        }
        Ok(self.job(id).await?.map_or(Described::NotFound, Described::Unchanged))
    }
}
