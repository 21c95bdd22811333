-- Jobs, their history, and what they left behind. Times are microseconds since the Unix epoch (UTC).

CREATE TABLE jobs (
    id                     TEXT    NOT NULL PRIMARY KEY,           -- UUIDv7: sorts by time of submission
    kind                   TEXT    NOT NULL,
    name                   TEXT,
    label                  TEXT,
    state                  TEXT    NOT NULL CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'canceled')),
    revision               INTEGER NOT NULL,                       -- grows with every visible change
    attempt                INTEGER NOT NULL,                       -- counts claims; fences lost workers out
    losses                 INTEGER NOT NULL DEFAULT 0,             -- how often its process died while it ran
    priority               INTEGER NOT NULL DEFAULT 0,             -- larger runs first
    progress               REAL    NOT NULL DEFAULT 0,             -- fraction of the whole job, 0 to 1
    stage                  TEXT,
    input_hash             TEXT    NOT NULL,
    solver_version         TEXT    NOT NULL,
    submitted_at_us        INTEGER NOT NULL,
    started_at_us          INTEGER,
    ended_at_us            INTEGER,
    cancel_requested_at_us INTEGER,
    error                  TEXT,                                   -- JSON
    reused_from            TEXT,                                   -- job whose result was taken
    request_id             TEXT,                                   -- request that submitted it
    idempotency_key        TEXT    UNIQUE,
    idempotency_hash       TEXT,
    input                  TEXT    NOT NULL,                       -- the document, every default filled in (JSON)
    CHECK ((error IS NOT NULL) = (state = 'failed')),
    CHECK ((ended_at_us IS NOT NULL) = (state IN ('succeeded', 'failed', 'canceled')))
);

CREATE INDEX jobs_by_state ON jobs (state, id);
CREATE INDEX jobs_by_kind  ON jobs (kind, id);
CREATE INDEX jobs_by_label ON jobs (label, id) WHERE label IS NOT NULL;
CREATE INDEX jobs_waiting  ON jobs (priority DESC, id) WHERE state = 'queued';

-- One row per transition, written in the transaction of the transition.
CREATE TABLE job_events (
    job_id   TEXT    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    revision INTEGER NOT NULL,
    at_us    INTEGER NOT NULL,
    state    TEXT    NOT NULL,
    attempt  INTEGER NOT NULL,
    PRIMARY KEY (job_id, revision)
);

-- Exists exactly when the job succeeded.
CREATE TABLE results (
    job_id         TEXT NOT NULL PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE,
    body           TEXT NOT NULL,                                  -- JSON, served as it is
    etag           TEXT NOT NULL,
    input_hash     TEXT NOT NULL,
    solver_version TEXT NOT NULL
);

CREATE INDEX results_by_input ON results (input_hash, solver_version);

-- One recorded channel: uniformly sampled f64, little-endian, zstd-compressed.
CREATE TABLE series (
    job_id   TEXT    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    channel  TEXT    NOT NULL,
    quantity TEXT    NOT NULL,
    unit     TEXT    NOT NULL,
    n        INTEGER NOT NULL,
    t0_s     REAL    NOT NULL,
    dt_s     REAL    NOT NULL,
    min      REAL,                                                 -- null for a channel without finite samples
    max      REAL,
    rms      REAL,
    samples  BLOB    NOT NULL,
    PRIMARY KEY (job_id, channel)
);

-- Finished stages kept for reuse by other jobs; a cache: any row may be deleted.
CREATE TABLE stages (
    hash           TEXT    NOT NULL PRIMARY KEY,
    stage          TEXT    NOT NULL,
    solver_version TEXT    NOT NULL,
    size_bytes     INTEGER NOT NULL,
    created_at_us  INTEGER NOT NULL,
    bytes          BLOB    NOT NULL
);

CREATE INDEX stages_by_age ON stages (created_at_us, hash, size_bytes);
