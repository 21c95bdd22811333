-- What the list of jobs shows, sorts by and searches: notes, and numbers of the result, stored when the job succeeds.

ALTER TABLE jobs ADD COLUMN notes TEXT;
ALTER TABLE jobs ADD COLUMN mesh_acceleration_rms_m_s2 REAL;       -- the larger one of both halves
ALTER TABLE jobs ADD COLUMN dynamic_factor REAL;
ALTER TABLE jobs ADD COLUMN transmission_error_pp_um REAL;

UPDATE jobs SET
    mesh_acceleration_rms_m_s2 = (
        SELECT COALESCE(
            MAX(json_extract(body, '$.response.rms.mesh_circumferential_acceleration_m_s2.left'),
                json_extract(body, '$.response.rms.mesh_circumferential_acceleration_m_s2.right')),
            json_extract(body, '$.response.rms.mesh_circumferential_acceleration_m_s2.left'),
            json_extract(body, '$.response.rms.mesh_circumferential_acceleration_m_s2.right'))
        FROM results WHERE job_id = jobs.id),
    dynamic_factor = (SELECT json_extract(body, '$.response.dynamic_factor') FROM results WHERE job_id = jobs.id),
    transmission_error_pp_um = (SELECT json_extract(body, '$.mesh.transmission_error_pp_um') FROM results WHERE job_id = jobs.id)
WHERE state = 'succeeded';

-- Everything by which jobs are filtered and sorted: a page or a count reads it instead of the rows, which contain the documents.
CREATE INDEX jobs_listing ON jobs (
    id, submitted_at_us, ended_at_us, state, kind, name, label,
    mesh_acceleration_rms_m_s2, dynamic_factor, transmission_error_pp_um
);
CREATE INDEX jobs_with_notes ON jobs (id, notes) WHERE notes IS NOT NULL;
