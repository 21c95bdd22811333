-- Points of sweeps as rows of their own, turns of long jobs, and a line to wait in for each kind of work.

-- One solved point of a sweep: written while the sweep runs, so that one that was stopped goes on where it was.
CREATE TABLE sweep_points (
    job_id         TEXT    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    position       INTEGER NOT NULL,                               -- in the result's sweep.points
    solver_version TEXT    NOT NULL,                               -- rows of another version are not gone on from
    body           TEXT    NOT NULL,                               -- JSON, served as it is
    PRIMARY KEY (job_id, position)
);

-- How far each line of a sweep with continuation was followed; gone when the job has succeeded.
CREATE TABLE sweep_line_ends (
    job_id   TEXT    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    line     INTEGER NOT NULL,
    position INTEGER NOT NULL,
    state    BLOB,                                                 -- f64 little-endian; null: nothing to continue from
    PRIMARY KEY (job_id, line)
);

-- Where the rows of sweep_points belong in the body (a byte offset), how many they are, and a hash of them all in order; null
-- when the result is not a sweep's.
ALTER TABLE results ADD COLUMN points_at INTEGER;
ALTER TABLE results ADD COLUMN points_n INTEGER;
ALTER TABLE results ADD COLUMN points_digest TEXT;

ALTER TABLE jobs ADD COLUMN turns INTEGER NOT NULL DEFAULT 0;      -- how often it made way for others; fewer runs first
ALTER TABLE jobs ADD COLUMN computed_us INTEGER NOT NULL DEFAULT 0; -- time of earlier attempts that were not lost

DROP INDEX jobs_waiting;
CREATE INDEX jobs_waiting ON jobs ((kind = 'sweep'), priority DESC, turns, id) WHERE state = 'queued';

-- What is left of an interrupted sweep is found again by its input.
CREATE INDEX jobs_by_input ON jobs (input_hash, id);
