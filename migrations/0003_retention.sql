-- Ended jobs by their end, for whoever deletes the oldest.
CREATE INDEX jobs_by_end ON jobs (ended_at_us, id) WHERE ended_at_us IS NOT NULL;
