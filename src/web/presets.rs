//! The documents in `examples/`, which the form can start from.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde_json::value::RawValue;
use std::sync::LazyLock;

/// A document to start from.
pub(super) struct Preset {
    pub id: &'static str,
    pub title: &'static str,
    /// Its subject, in a sentence.
    pub about: &'static str,
    document: &'static str,
}

/// Presets under a common heading.
pub(super) struct PresetGroup {
    pub title: &'static str,
    pub presets: &'static [Preset],
}

macro_rules! preset {
    ($id:literal, $title:literal, $about:literal) => {
        Preset {
            id: $id,
            title: $title,
            about: $about,
            document: include_str!(concat!("../../examples/", $id, ".json")),
        }
    };
}

/// All presets, in the order of the selection on the page.
pub(super) const GROUPS: &[PresetGroup] = &[
    PresetGroup {
        title: "One operating point",
        presets: &[
            preset!(
                "contact",
                "Example pair, z 17/44",
                "Module 6 mm, helix 24.43°, 2 × 75 mm, 800 N·m at 2000 r/min: the loaded contact in the equations, halves of one body."
            ),
            preset!(
                "table1",
                "The source's Table 1",
                "The same pair as the source paper models it: mesh stiffness and impact pulse, halves that turn freely."
            ),
            preset!(
                "tip_relief",
                "Tip relief on both gears",
                "15 µm parabolic over 6 mm of roll: softens the mesh-in impact and shifts the load share."
            ),
            preset!(
                "assembly_errors",
                "Assembly errors",
                "Centre-distance error, misaligned axes and an apex offset that the floating pinion balances."
            ),
            preset!(
                "given_stiffness",
                "Given stiffness, light load",
                "A stiffness series and an impact as given, 80 N·m: the teeth separate."
            ),
        ],
    },
    PresetGroup {
        title: "On shafts",
        presets: &[
            preset!(
                "shafts",
                "Example pair on its shafts",
                "Both shafts drawn: steps, bearings, couplings. The pinion floats between its bearings, the torque enters on the left."
            ),
            preset!(
                "shafts_arrangement",
                "Shafts from four numbers",
                "Straddle-mounted pinion: mounting, input side, bearing span and shaft diameter; the rest is derived."
            ),
            preset!(
                "shafts_overhung",
                "Overhung pinion",
                "Pinion beside both of its bearings: the load leans on the inner ends and lifts off elsewhere."
            ),
        ],
    },
    PresetGroup {
        title: "Contact ratios of the source's Table 2",
        presets: &[
            preset!("table2_2_72", "Contact ratio 2.72", "By addenda of 0.686 m_n."),
            preset!("table2_2_91", "Contact ratio 2.91", "By addenda of 0.825 m_n."),
            preset!("table2_3_30", "Contact ratio 3.30", "By addenda of 1.123 m_n."),
            preset!("table2_3_68", "Contact ratio 3.68", "By addenda of 1.123 m_n and faces of 92.3 mm."),
            preset!("table2_4_07", "Contact ratio 4.07", "By addenda of 1.123 m_n and faces of 110.1 mm."),
        ],
    },
    PresetGroup {
        title: "Optimisation and tolerances",
        presets: &[
            preset!(
                "optimise_relief",
                "Quiet at three torques",
                "Tip relief of both gears and crowning for the least vibration at the worst of 400, 800 and 1200 N·m."
            ),
            preset!(
                "optimise_misalignment",
                "Helix slopes against a misalignment",
                "Slopes of both halves of the pinion for the least line load with axes 20 µm out of line."
            ),
            preset!(
                "tolerance_relief",
                "Scatter of relief and assembly",
                "Transmission error and vibration of 128 pairs within their tolerances, and which tolerance matters."
            ),
            preset!(
                "optimise_helix_shafts",
                "Helix correction on shafts",
                "Slopes and crowning for the least K_Hβ in 90 of 100 cases of a torque that scatters by 20 %."
            ),
            preset!(
                "tolerance_optimised",
                "Tolerances of a relief that was found",
                "128 pairs about the relief that the first example finds: halves on their own, amounts in company."
            ),
        ],
    },
    PresetGroup {
        title: "Sweeps",
        presets: &[
            preset!("speed_sweep", "Over the speed", "The example pair at 56 speeds: resonances and their width."),
            preset!(
                "contact_ratio_sweep",
                "Over the face width",
                "Faces from 55 to 115 mm: contact ratio 2.70 to 4.02."
            ),
        ],
    },
];

/// A preset in the response to the page's script.
#[derive(Serialize)]
struct Entry {
    id: &'static str,
    title: &'static str,
    about: &'static str,
    document: &'static RawValue,
}

static JSON: LazyLock<String> = LazyLock::new(|| {
    let presets = GROUPS.iter().flat_map(|group| group.presets);
    let entries: Result<Vec<_>, serde_json::Error> = presets
        .map(|preset| {
            let document = serde_json::from_str(preset.document)?;
            Ok(Entry { id: preset.id, title: preset.title, about: preset.about, document })
        })
        .collect();
    // The documents are part of the program; a test reads them all.
    entries.and_then(|entries| serde_json::to_string(&entries)).unwrap_or_else(|_| "[]".to_owned())
});

/// `/assets/presets.json`.
pub(super) async fn presets() -> Response {
    let headers = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-cache")];
    (headers, JSON.as_str()).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_example_is_a_preset_that_can_be_solved() {
        let listed: Vec<serde_json::Value> = serde_json::from_str(&JSON).unwrap();
        let files = std::fs::read_dir("examples").unwrap().map(|entry| entry.unwrap().path());
        let mut names: Vec<_> = files
            .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        names.sort();
        let mut ids: Vec<_> = listed.iter().map(|entry| entry["id"].as_str().unwrap().to_owned()).collect();
        ids.sort();
        assert_eq!(ids, names);
        for entry in listed {
            let document = herringbone_job::parse_value(&entry["document"]).unwrap();
            herringbone_job::study::CheckedJob::new(document).unwrap();
        }
    }
}
