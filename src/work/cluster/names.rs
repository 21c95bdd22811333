//! Names of streams, consumers and subjects: few, as a NATS server keeps an entry in memory for each.

use crate::store::{ChunkClass, JobId};
use herringbone_job::document::{Fidelity, JobDocument, MeshStiffness};
use std::fmt;
use std::str::FromStr;

/// Number of subjects of results.
const RESULT_SUBJECTS: u8 = 8;
/// Subject on which every service answers with the name of its space.
pub(super) const SPACES: &str = "hb.spaces";

/// The name under which one service and its workers share a NATS: part of every subject and stream.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Space(String);

impl Space {
    /// A name that no other service has by chance.
    pub(super) fn generated() -> Self {
        let id = uuid::Uuid::new_v4().simple().to_string();
        Self(id[..8].to_owned())
    }

    pub(super) fn work_stream(&self) -> String {
        format!("HB_{}_WORK", self.0)
    }

    pub(super) fn result_stream(&self) -> String {
        format!("HB_{}_RESULT", self.0)
    }

    pub(super) fn all_work(&self) -> String {
        format!("hb.{}.work.>", self.0)
    }

    pub(super) fn all_results(&self) -> String {
        format!("hb.{}.result.>", self.0)
    }

    pub(super) fn work(&self, solver: &str, class: ChunkClass) -> String {
        format!("hb.{}.work.{solver}.{}", self.0, class.as_str())
    }

    /// The subject of the results of a job.
    pub(super) fn result(&self, job: JobId) -> String {
        let number = job.as_bytes().iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)) % RESULT_SUBJECTS;
        format!("hb.{}.result.{number}", self.0)
    }

    /// The subject of a request or of a broadcast.
    pub(super) fn subject(&self, what: &str) -> String {
        format!("hb.{}.{what}", self.0)
    }
}

/// The name of the consumer of one class of work.
pub(super) fn consumer(solver: &str, class: ChunkClass) -> String {
    format!("{solver}_{}", class.as_str())
}

/// The name of the consumer of results.
pub(super) const RESULT_CONSUMER: &str = "store";

/// Which workers can take work: those of the same version.
pub(super) fn solver_of(version: &str) -> String {
    version.chars().map(|one| if one.is_ascii_alphanumeric() || one == '-' { one } else { '_' }).collect()
}

/// As [`solver_of`], for work whose result depends on the processor in its last bits.
pub(super) fn solver_of_class(version: &str, class: &str) -> String {
    format!("{}-{class}", solver_of(version))
}

/// Whether work for these workers is work of this version.
pub(super) fn is_of_version(solver: &str, version: &str) -> bool {
    let own = solver_of(version);
    solver.strip_prefix(&own).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
}

/// Whether the result of a job depends on the class of the processor in its last bits: dense linear algebra chooses its
/// kernels by it.
pub(super) fn depends_on_processor(document: &JobDocument) -> bool {
    matches!(&document.model.mesh_stiffness, MeshStiffness::Ltca(ltca) if ltca.fidelity == Fidelity::Fe)
}

/// The class of this processor.
pub(super) fn processor_class() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::is_x86_feature_detected!("avx512f") {
            return "x86-64-v4";
        }
        if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
            return "x86-64-v3";
        }
        "x86-64"
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        std::env::consts::ARCH
    }
}

impl fmt::Display for Space {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl FromStr for Space {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_name = |one: char| one.is_ascii_lowercase() || one.is_ascii_digit() || one == '-';
        if (1..=32).contains(&text.len()) && text.chars().all(is_name) {
            Ok(Self(text.to_owned()))
        } else {
            Err("give 1 to 32 of the characters a-z, 0-9 and -".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_space_is_a_token_of_subjects_and_of_stream_names() {
        for good in ["a", "gear-lab-2", &"x".repeat(32)] {
            assert_eq!(good.parse::<Space>().map(|space| space.to_string()), Ok(good.to_owned()));
        }
        for bad in ["", "A", "a.b", "a_b", "a b", ">", "*", &"x".repeat(33)] {
            assert!(bad.parse::<Space>().is_err(), "{bad}");
        }
        assert!(Space::generated().to_string().parse::<Space>().is_ok());
    }

    #[test]
    fn a_solver_is_one_token() {
        assert_eq!(solver_of("0.1.0-7"), "0_1_0-7");
        assert_eq!(solver_of_class("0.1.0-7", "x86-64-v3"), "0_1_0-7-x86-64-v3");
        let is_own = |solver| is_of_version(solver, "0.1.0-7");
        assert!(is_own("0_1_0-7") && is_own("0_1_0-7-x86-64-v3") && !is_own("0_1_0-70") && !is_own("0_1_0-6"));
        assert_eq!(consumer("0_1_0-7", ChunkClass::Scout), "0_1_0-7_scout");
    }

    #[test]
    fn results_of_a_job_have_one_subject() {
        let (space, job): (Space, JobId) = ("s".parse().expect("a name"), JobId::new());
        assert_eq!(space.result(job), space.result(job));
        assert!(space.result(job).starts_with("hb.s.result."));
    }
}
