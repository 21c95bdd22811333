//! Extractors of path, query, headers and body. Each rejects with [`super::problem::ApiError`].

mod accept;
mod body;
mod cursor;
mod headers;
mod patch;
mod path;
mod query;
mod window;

pub(super) use accept::{
    TableForm, event_stream_only, json_only, negotiate, negotiate_csv, negotiate_form, negotiate_table,
    negotiate_table_form,
};
pub(super) use body::{DocumentBody, read_file};
pub(super) use cursor::Cursor;
pub(super) use headers::{IdempotencyKey, IfNoneMatch, Prefer, RequestId, TraceParent};
pub(super) use patch::{JobPatch, PatchBody};
pub(super) use path::{ChannelPath, JobPath, PointPath};
pub(super) use query::QueryParameters;
pub(super) use window::TimeWindow;
