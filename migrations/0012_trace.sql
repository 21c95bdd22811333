-- The caller's trace (W3C Trace Context): passed on to the logs of whoever computes the job.
ALTER TABLE jobs ADD COLUMN traceparent TEXT;
