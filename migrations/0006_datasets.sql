-- What a calculation recorded (series, rows of a sweep) is a dataset of its own, which all jobs share whose result it is.

-- Exists as long as it is the dataset of a result, or of its job: one that runs, or that failed or was canceled.
CREATE TABLE datasets (
    id TEXT NOT NULL PRIMARY KEY                                   -- id of the job whose calculation wrote it
);

INSERT INTO datasets (id)
SELECT results.job_id FROM results JOIN jobs ON jobs.id = results.job_id
WHERE jobs.reused_from IS NULL
   OR NOT EXISTS (SELECT 1 FROM results AS source WHERE source.job_id = jobs.reused_from);

INSERT INTO datasets (id)
SELECT DISTINCT job_id FROM sweep_points
WHERE NOT EXISTS (SELECT 1 FROM results WHERE results.job_id = sweep_points.job_id);

-- The dataset of a result; never null after this migration. A reused result had a copy of what its source had recorded.
ALTER TABLE results ADD COLUMN dataset_id TEXT REFERENCES datasets (id);

CREATE INDEX jobs_by_source ON jobs (reused_from) WHERE reused_from IS NOT NULL;

WITH RECURSIVE origins (job_id, dataset_id) AS (
    SELECT results.job_id, datasets.id FROM results JOIN datasets ON datasets.id = results.job_id
    UNION ALL
    SELECT jobs.id, origins.dataset_id FROM origins
    JOIN jobs ON jobs.reused_from = origins.job_id
    JOIN results ON results.job_id = jobs.id
)
UPDATE results SET dataset_id = origins.dataset_id FROM origins WHERE origins.job_id = results.job_id;

DROP INDEX jobs_by_source;
CREATE INDEX results_by_dataset ON results (dataset_id);

-- The description of a recorded channel: uniformly sampled.
ALTER TABLE series RENAME TO series_of_jobs;
CREATE TABLE series (
    dataset_id TEXT    NOT NULL REFERENCES datasets (id) ON DELETE CASCADE,
    position  INTEGER NOT NULL,
    channel   TEXT    NOT NULL,
    quantity  TEXT    NOT NULL,
    unit      TEXT    NOT NULL,
    n         INTEGER NOT NULL,
    t0_s      REAL    NOT NULL,
    dt_s      REAL    NOT NULL,
    min       REAL,                                                -- null for a channel without finite samples
    max       REAL,
    rms       REAL,
    PRIMARY KEY (dataset_id, channel)
);

-- Its samples, in parts: f64, little-endian, each part compressed with zstd. Parts are written before the description;
-- without it they do not count.
CREATE TABLE series_samples (
    dataset_id TEXT    NOT NULL REFERENCES datasets (id) ON DELETE CASCADE,
    position  INTEGER NOT NULL,                                    -- of the channel
    part      INTEGER NOT NULL,
    samples   BLOB    NOT NULL,
    PRIMARY KEY (dataset_id, position, part)
);

INSERT INTO series (dataset_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms)
SELECT job_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms FROM series_of_jobs
WHERE job_id IN (SELECT id FROM datasets);

INSERT INTO series_samples (dataset_id, position, part, samples)
SELECT job_id, position, 0, samples FROM series_of_jobs WHERE job_id IN (SELECT id FROM datasets);

DROP TABLE series_of_jobs;

-- One solved point of a sweep: written while the sweep runs, so that one that was stopped goes on where it was.
ALTER TABLE sweep_points RENAME TO sweep_points_of_jobs;
CREATE TABLE sweep_points (
    dataset_id      TEXT    NOT NULL REFERENCES datasets (id) ON DELETE CASCADE,
    position       INTEGER NOT NULL,                               -- in the result's sweep.points
    solver_version TEXT    NOT NULL,                               -- rows of another version are not gone on from
    body           TEXT    NOT NULL,                               -- JSON, served as it is
    PRIMARY KEY (dataset_id, position)
);

INSERT INTO sweep_points (dataset_id, position, solver_version, body)
SELECT job_id, position, solver_version, body FROM sweep_points_of_jobs WHERE job_id IN (SELECT id FROM datasets);

DROP TABLE sweep_points_of_jobs;
