//! The closed list of problem codes.

use axum::http::StatusCode;

/// The code of a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProblemCode {
    MalformedJson,
    InvalidParameter,
    InvalidCursor,
    Unauthenticated,
    CrossOrigin,
    NotFound,
    MethodNotAllowed,
    NotAcceptable,
    RequestTimeout,
    JobNotEnded,
    ResultNotReady,
    JobNotSucceeded,
    PayloadTooLarge,
    UnsupportedMediaType,
    MisdirectedRequest,
    InvalidDesign,
    UnsupportedDesign,
    InvalidPatch,
    IdempotencyKeyReused,
    TooManyAttempts,
    Internal,
    QueueFull,
    TooManyStreams,
    TooManyLargeAnswers,
    TooManyImports,
    ShuttingDown,
    NotConverged,
    Diverged,
    StepSizeTooSmall,
    TooManySteps,
    NoContact,
    SolveFailed,
    WorkerLost,
    TimeLimit,
    StorageUnavailable,
}

/// The published description of a code.
#[derive(Debug, Clone, Copy)]
pub struct CodeEntry {
    pub code: ProblemCode,
    pub name: &'static str,
    /// Status of responses with this code; for codes of failed jobs the status that a synchronous response would have.
    pub status: u16,
    pub title: &'static str,
    /// Meaning and remedy.
    pub explanation: &'static str,
}

const fn entry(
    code: ProblemCode,
    name: &'static str,
    status: u16,
    title: &'static str,
    explanation: &'static str,
) -> CodeEntry {
    CodeEntry { code, name, status, title, explanation }
}

/// Every code, by status.
pub(crate) const CODES: [CodeEntry; 35] = [
    entry(
        ProblemCode::MalformedJson,
        "malformed-json",
        400,
        "The body is not JSON",
        "The request body could not be read as JSON; the detail names line and column. NaN, Infinity and numbers beyond \
         the range of a double are not JSON.",
    ),
    entry(
        ProblemCode::InvalidParameter,
        "invalid-parameter",
        400,
        "A query parameter or header is invalid",
        "Each entry of `errors` names one parameter (its pointer is the parameter's name after a slash) and what is \
         permitted.",
    ),
    entry(
        ProblemCode::InvalidCursor,
        "invalid-cursor",
        400,
        "The cursor does not belong to this list",
        "A cursor is taken unchanged from `next_cursor` and used with the same filters. Start again without it.",
    ),
    entry(
        ProblemCode::Unauthenticated,
        "unauthenticated",
        401,
        "The request has no valid credentials",
        "The service was started with a token and the request did not carry it. Programs send it as `Authorization: Bearer` \
         and the token; people enter it at /login.",
    ),
    entry(
        ProblemCode::CrossOrigin,
        "cross-origin",
        403,
        "The request comes from another site",
        "A page of another site made the browser send it. The service takes changes from its own pages and from programs. \
         Behind a proxy: it must pass the headers Host and Origin unchanged.",
    ),
    entry(
        ProblemCode::NotFound,
        "not-found",
        404,
        "Nothing is there",
        "The path, the job or the channel does not exist, or the job was deleted.",
    ),
    entry(
        ProblemCode::MethodNotAllowed,
        "method-not-allowed",
        405,
        "The method is not available here",
        "The header `Allow` names the methods of this path.",
    ),
    entry(
        ProblemCode::NotAcceptable,
        "not-acceptable",
        406,
        "No representation fits the header Accept",
        "The detail names the media types that this path has.",
    ),
    entry(
        ProblemCode::RequestTimeout,
        "request-timeout",
        408,
        "The request took too long",
        "The request was not complete, or its answer not ready, within the time limit. It may be sent again; use an \
         Idempotency-Key when it submits a job.",
    ),
    entry(
        ProblemCode::JobNotEnded,
        "job-not-ended",
        409,
        "The job has not ended",
        "Only ended jobs can be deleted: cancel it first, or wait for its end.",
    ),
    entry(
        ProblemCode::ResultNotReady,
        "result-not-ready",
        409,
        "The job has no result yet",
        "The job waits or runs. Look again after `Retry-After`, or wait for it with `Prefer: wait` or the event stream.",
    ),
    entry(
        ProblemCode::JobNotSucceeded,
        "job-not-succeeded",
        409,
        "The job ended without a result",
        "The job failed or was canceled; a failed job's `error` says why.",
    ),
    entry(
        ProblemCode::PayloadTooLarge,
        "payload-too-large",
        413,
        "The request body is too large",
        "A job document has at most 1 MiB (1048576 bytes), a file to import at most 32 MiB.",
    ),
    entry(
        ProblemCode::UnsupportedMediaType,
        "unsupported-media-type",
        415,
        "The request body has the wrong media type",
        "Send job documents with `Content-Type: application/json`, uncompressed; files to import as `application/xml`, \
         `application/json`, `application/zip` or `application/octet-stream`.",
    ),
    entry(
        ProblemCode::MisdirectedRequest,
        "misdirected-request",
        421,
        "The request names another host",
        "The header Host is not a name of this service. Use localhost or 127.0.0.1, or start the service with \
         `--allowed-host` and the name.",
    ),
    entry(
        ProblemCode::InvalidDesign,
        "invalid-design",
        422,
        "The job document is invalid",
        "Fields are missing, unknown, of the wrong type or out of range, contradict each other, or the gear cannot exist. \
         `errors` has every violation found, with its pointer, permitted range and unit. Of a file to import: it cannot be \
         read, or lacks what a document needs; the details name components and attributes of the file.",
    ),
    entry(
        ProblemCode::UnsupportedDesign,
        "unsupported-design",
        422,
        "The job document asks for something unsupported",
        "The document is valid, but this version does not compute what it asks for; `errors` names the fields. Of a file to \
         import: it has no double-helical pair, or several; `errors` lists what it has, the number of a pair at the end of \
         the pointer.",
    ),
    entry(
        ProblemCode::InvalidPatch,
        "invalid-patch",
        422,
        "The change of the job is invalid",
        "Name, label and notes of a job can be changed, each to a text within its length or, with null, to none. Each entry of \
         `errors` names one member.",
    ),
    entry(
        ProblemCode::IdempotencyKeyReused,
        "idempotency-key-reused",
        422,
        "The Idempotency-Key was used with another document",
        "A key names one submission. Use a new one for a new document.",
    ),
    entry(
        ProblemCode::TooManyAttempts,
        "too-many-attempts",
        429,
        "Too many wrong tokens",
        "Wrong tokens came faster than is answered, from this client or others. Try again after `Retry-After`; the right \
         token is taken at any time.",
    ),
    entry(
        ProblemCode::NotConverged,
        "not-converged",
        422,
        "The solution did not converge",
        "Error of a failed job: an iteration did not reach the accuracy asked for. It would fail again in the same way; \
         change the document.",
    ),
    entry(
        ProblemCode::Diverged,
        "diverged",
        422,
        "The motion grew without bound",
        "Error of a failed job: the integration left the range of meaningful numbers at `sim_time_s`. It would fail again \
         in the same way; damping and mesh stiffness are where to look.",
    ),
    entry(
        ProblemCode::StepSizeTooSmall,
        "step-size-too-small",
        422,
        "The time step became too small",
        "Error of a failed job: the integration could not go on at `sim_time_s` with the accuracy asked for.",
    ),
    entry(
        ProblemCode::TooManySteps,
        "too-many-steps",
        422,
        "The integration needs too many steps",
        "Error of a failed job: the steps allowed were used up at `sim_time_s`. Ask for fewer mesh periods or less accuracy.",
    ),
    entry(
        ProblemCode::NoContact,
        "no-contact",
        422,
        "The teeth do not touch",
        "Error of a failed job: under the torque given no pair of teeth comes into contact. Look at backlash, modifications \
         and assembly errors.",
    ),
    entry(
        ProblemCode::SolveFailed,
        "solve-failed",
        422,
        "The calculation failed",
        "Error of a failed job: a stage has no solution for this document; the detail says which and why. It would fail \
         again in the same way.",
    ),
    entry(
        ProblemCode::Internal,
        "internal",
        500,
        "The service failed",
        "The reason lies in the service and was logged under the request's id. Sending the request again may help.",
    ),
    entry(
        ProblemCode::WorkerLost,
        "worker-lost",
        500,
        "The job lost its worker too often",
        "Error of a failed job: the process that ran it ended before the job did, as often as is tried. A job that \
         exhausts the memory looks like this.",
    ),
    entry(
        ProblemCode::TimeLimit,
        "time-limit",
        500,
        "The job computed for too long",
        "Error of a failed job: it was stopped at the longest computing time that this service permits. A sweep keeps the \
         points it had reached; submitted again, it goes on from there.",
    ),
    entry(
        ProblemCode::QueueFull,
        "queue-full",
        503,
        "Too many jobs wait",
        "The queue has a bound (see /api/v1/system). Submit again after `Retry-After`.",
    ),
    entry(
        ProblemCode::TooManyStreams,
        "too-many-streams",
        503,
        "Too many clients follow jobs",
        "Event streams have a bound, so that they cannot use up all connections. Try again after `Retry-After`, or ask for \
         the job now and then.",
    ),
    entry(
        ProblemCode::TooManyLargeAnswers,
        "too-many-large-answers",
        503,
        "Too many large answers are being sent",
        "Series in full and large results have a bound, so that clients that read slowly cannot use up the memory. Try again \
         after `Retry-After`, or ask for less: a downsampled series, fewer points of a sweep.",
    ),
    entry(
        ProblemCode::TooManyImports,
        "too-many-imports",
        503,
        "Too many files are being imported",
        "Files that are read have a bound, so that they cannot use up the memory. Try again after `Retry-After`.",
    ),
    entry(
        ProblemCode::ShuttingDown,
        "shutting-down",
        503,
        "The service is shutting down",
        "Jobs that wait or run are taken up after the restart. Submit again after `Retry-After`.",
    ),
    entry(
        ProblemCode::StorageUnavailable,
        "storage-unavailable",
        503,
        "The database cannot be written at the moment",
        "There is no room left, or the database is locked, its file was moved, or its file system fails. Nothing was \
         accepted and nothing is lost; running jobs keep their results until they can be written. Try again after `Retry-After`, or make room: \
         delete jobs, or ask whoever runs the service.",
    ),
];

impl ProblemCode {
    pub fn entry(self) -> &'static CodeEntry {
        // Every variant is in the table, which a test checks.
        CODES.iter().find(|entry| entry.code == self).unwrap_or(&CODES[0])
    }

    pub fn as_str(self) -> &'static str {
        self.entry().name
    }

    pub fn from_name(name: &str) -> Option<Self> {
        CODES.iter().find(|entry| entry.name == name).map(|entry| entry.code)
    }

    pub fn status(self) -> StatusCode {
        StatusCode::from_u16(self.entry().status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR)
    }

    /// The code of an error response that the framework made without a body.
    pub fn of_status(status: StatusCode) -> Self {
        match status.as_u16() {
            401 => Self::Unauthenticated,
            403 => Self::CrossOrigin,
            404 => Self::NotFound,
            405 => Self::MethodNotAllowed,
            406 => Self::NotAcceptable,
            408 => Self::RequestTimeout,
            413 => Self::PayloadTooLarge,
            415 => Self::UnsupportedMediaType,
            421 => Self::MisdirectedRequest,
            429 => Self::TooManyAttempts,
            400..=499 => Self::InvalidParameter,
            503 => Self::ShuttingDown,
            _ => Self::Internal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_in_the_table_once_and_is_found_by_its_name() {
        for entry in &CODES {
            assert_eq!(entry.code.entry().name, entry.name, "{} stands twice", entry.name);
            assert_eq!(ProblemCode::from_name(entry.name), Some(entry.code));
            assert!(entry.code.status().as_u16() >= 400);
        }
        // The discriminant of the last variant is the number of the others.
        assert_eq!(ProblemCode::StorageUnavailable as usize + 1, CODES.len());
    }
}
