//! Numbers of results that lists of jobs show and sort by.

use serde::Deserialize;

/// The headline numbers of a job; none where its result does not have them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Headline {
    /// Root mean square of the circumferential acceleration of the mesh, the larger one of both halves.
    pub mesh_acceleration_rms_m_s2: Option<f64>,
    pub dynamic_factor: Option<f64>,
    /// Transmission error, peak to peak.
    pub transmission_error_pp_um: Option<f64>,
}

/// The part of a result that has the headline numbers. Null stands for numbers that are not finite.
#[derive(Deserialize)]
struct ResultPart {
    mesh: Option<MeshPart>,
    response: Option<ResponsePart>,
}

#[derive(Deserialize)]
struct MeshPart {
    transmission_error_pp_um: Option<f64>,
}

#[derive(Deserialize)]
struct ResponsePart {
    rms: RmsPart,
    dynamic_factor: Option<f64>,
}

#[derive(Deserialize)]
struct RmsPart {
    mesh_circumferential_acceleration_m_s2: HalvesPart,
}

#[derive(Deserialize)]
struct HalvesPart {
    left: Option<f64>,
    right: Option<f64>,
}

impl Headline {
    /// The headline numbers of a result in JSON; none of a text of another form.
    pub(super) fn of_result(body: &str) -> Self {
        let Ok(ResultPart { mesh, response }) = serde_json::from_str(body) else { return Self::default() };
        let halves = response.as_ref().map(|response| &response.rms.mesh_circumferential_acceleration_m_s2);
        Self {
            mesh_acceleration_rms_m_s2: halves
                .and_then(|halves| halves.left.into_iter().chain(halves.right).reduce(f64::max)),
            dynamic_factor: response.as_ref().and_then(|response| response.dynamic_factor),
            transmission_error_pp_um: mesh.and_then(|mesh| mesh.transmission_error_pp_um),
        }
    }
}
