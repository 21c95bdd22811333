-- Work for other machines: parts of running jobs, fenced by the attempt. A row exists before its part is published, and until the
-- attempt of its job ends.
CREATE TABLE chunks (
    job_id       TEXT    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    attempt      INTEGER NOT NULL,
    chunk        INTEGER NOT NULL,
    class        TEXT    NOT NULL CHECK (class IN ('single', 'sweep', 'scout')),
    solver       TEXT    NOT NULL,                                 -- which workers can take it
    state        TEXT    NOT NULL CHECK (state IN ('waiting', 'issued', 'stored')),
    issue        INTEGER NOT NULL DEFAULT 1,                       -- grows with every publication; part of the message's id
    part         TEXT    NOT NULL,                                 -- what it covers (JSON)
    sequence     INTEGER,                                          -- place in the stream; null until it is published
    issued_at_us INTEGER,
    PRIMARY KEY (job_id, attempt, chunk)
);

CREATE INDEX chunks_open ON chunks (job_id, attempt) WHERE state <> 'stored';

-- Pieces of the result of a whole job, until the last one is there. A run is one computation of a chunk: pieces of two are never mixed,
-- as their wall times differ.
CREATE TABLE chunk_pieces (
    job_id  TEXT    NOT NULL,
    attempt INTEGER NOT NULL,
    chunk   INTEGER NOT NULL,
    run     TEXT    NOT NULL,
    piece   INTEGER NOT NULL,
    bytes   BLOB    NOT NULL,
    PRIMARY KEY (job_id, attempt, chunk, run, piece),
    FOREIGN KEY (job_id, attempt, chunk) REFERENCES chunks (job_id, attempt, chunk) ON DELETE CASCADE
);

-- Settings that the service makes itself and keeps.
CREATE TABLE settings (
    name  TEXT NOT NULL PRIMARY KEY,
    value TEXT NOT NULL
);
