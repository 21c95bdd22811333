//! The HTTP interface. One file per endpoint in `routes`; shared are the extractors (`request`), the representation
//! of jobs (`view`) and of errors (`problem`). No other module depends on HTTP.
//!
//! Invariant: every response with a status of 400 or above is `application/problem+json` in one schema, with a code of
//! a closed list; the request middleware brings errors of the framework into the same form. (A request whose head
//! cannot be parsed does not reach it: see `connections`.)

mod bearing_forces;
mod columns;
mod config;
mod connections;
mod csv;
mod downsample;
mod guard;
mod guarded_body;
mod middleware;
mod openapi;
mod parquet;
mod points;
mod problem;
mod request;
mod result_body;
mod router;
mod routes;
mod samples;
mod series_file;
mod serve;
mod state;
mod table;
mod telemetry;
mod text_body;
mod view;
mod workbook;

pub use bearing_forces::write_bearing_forces;
pub use config::{HttpConfig, MAX_BODY_BYTES, MAX_IMPORT_BYTES, MAX_WAIT_S};
pub use connections::ConnectionConfig;
pub use csv::{CsvField, CsvWriter, Decimal};
pub use guard::{Access, AccessConfig, AccessError, LoginNotice, LoginRenderer};
pub use openapi::{openapi_for_generators, openapi_json};
pub use problem::{Problem, ProblemCode};
pub use router::{Pages, router};
pub use serve::serve;
pub use state::AppState;
pub use table::{Cells, Table, TableColumn};
pub use workbook::{MAX_WORKBOOK_ROWS, document_value, quantities_of, write_workbook};
