-- Addresses that are told of the ends of jobs: those of the configuration of the last start are active.
CREATE TABLE webhooks (
    url            TEXT    NOT NULL PRIMARY KEY,
    active         INTEGER NOT NULL CHECK (active IN (0, 1)),
    disabled_at_us INTEGER                                          -- the address answered that it is gone
);

-- What is to be told, written with the job's event. Rows outlive their job.
CREATE TABLE webhook_deliveries (
    id            TEXT    NOT NULL PRIMARY KEY,                     -- `webhook-id`, the same in every try
    url           TEXT    NOT NULL REFERENCES webhooks (url) ON DELETE CASCADE,
    job_id        TEXT    NOT NULL,
    kind          TEXT    NOT NULL,
    name          TEXT,
    label         TEXT,
    job_state     TEXT    NOT NULL CHECK (job_state IN ('succeeded', 'failed', 'canceled')),
    at_us         INTEGER NOT NULL,                                 -- time of the event
    state         TEXT    NOT NULL CHECK (state IN ('waiting', 'delivered', 'failed')),
    tries         INTEGER NOT NULL DEFAULT 0,
    due_at_us     INTEGER NOT NULL,                                 -- of the next try, while it waits
    last_try_us   INTEGER,
    last_status   INTEGER,                                          -- HTTP status of the last answer
    last_error    TEXT                                              -- why there was none, or why it was no success
);

CREATE INDEX webhook_deliveries_due ON webhook_deliveries (due_at_us) WHERE state = 'waiting';
CREATE INDEX webhook_deliveries_at ON webhook_deliveries (at_us);
