-- A page of the list takes as long whatever the number of jobs, also with a state and a kind.

CREATE INDEX jobs_by_state_kind ON jobs (state, kind, id);
