-- Optimisations and tolerance studies wait with the sweeps: they have rows, take long and make way by turns.
DROP INDEX jobs_waiting;
CREATE INDEX jobs_waiting ON jobs ((kind IN ('sweep', 'optimise', 'tolerance')), priority DESC, turns, id) WHERE state = 'queued';
