//! What a request says: path, query, headers, body. Each reader refuses in the service's own form.

mod accept;
mod body;
mod cursor;
mod headers;
mod path;
mod query;

pub use accept::{chosen, event_stream_only, json_only, json_or_csv};
pub use body::DocumentBody;
pub use cursor::Cursor;
pub use headers::{IdempotencyKey, IfNoneMatch, Prefer, RequestId};
pub use path::{ChannelPath, JobPath, PointPath};
pub use query::Parameters;
