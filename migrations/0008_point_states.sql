-- The state at the end of a point that was reached by continuation (24 f64, little-endian), from which its neighbour was solved: so that
-- the neighbour can be solved again as a job of its own. Null for points without one, and for those that were solved before this step.
ALTER TABLE sweep_points ADD COLUMN end_state BLOB;
