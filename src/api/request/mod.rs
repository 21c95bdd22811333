//! Extractors of path, query, headers and body. Each rejects with [`super::problem::ApiError`].

mod accept;
mod body;
mod cursor;
mod headers;
mod path;
mod query;

pub use accept::{event_stream_only, json_only, negotiate, negotiate_table};
pub use body::DocumentBody;
pub use cursor::Cursor;
pub use headers::{IdempotencyKey, IfNoneMatch, Prefer, RequestId};
pub use path::{ChannelPath, JobPath, PointPath};
pub use query::QueryParameters;
