-- The place of a sweep's rows in its result is found in the JSON when the result is read; no byte offset is stored any more.
ALTER TABLE results DROP COLUMN points_at;
