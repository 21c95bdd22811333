//! The plan of the form: which fields stand together, in the order in which an engineer thinks of them. Only the plan:
//! names, ranges, units, defaults and help come from the job document's own declarations.

/// A section of the form.
pub struct GroupPlan {
    pub id: &'static str,
    pub title: &'static str,
    pub help: &'static str,
    pub open: bool,
    pub blocks: &'static [BlockPlan],
}

/// Fields that stand together: JSON pointers of fields, or of objects for all fields in them.
pub struct BlockPlan {
    pub title: &'static str,
    pub pointers: &'static [&'static str],
}

/// A field (or all fields of an object) that matters only while another field has one of some values.
pub struct Condition {
    pub pointer: &'static str,
    pub on: &'static str,
    pub values: &'static str,
}

const fn block(title: &'static str, pointers: &'static [&'static str]) -> BlockPlan {
    BlockPlan { title, pointers }
}

pub const GROUPS: &[GroupPlan] = &[
    GroupPlan { id: "job", title: "Job", help: "", open: true, blocks: &[block("", &["/kind", "/name", "/label"])] },
    GroupPlan {
        id: "sweep",
        title: "Sweep",
        help: "One or two inputs that vary: give first and last value, or a list of values.",
        open: true,
        blocks: &[
            block("First axis", &["/axes/0"]),
            block("Second axis", &["/axes/1"]),
            block("", &["/continuation", "/record"]),
        ],
    },
    GroupPlan {
        id: "gears",
        title: "Gears",
        help: "",
        open: true,
        blocks: &[
            block(
                "",
                &[
                    "/design/normal_module_mm",
                    "/design/pressure_angle_deg",
                    "/design/pressure_angle_plane",
                    "/design/center_distance_mm",
                    "/design/backlash_um",
                ],
            ),
            block(
                "Pinion",
                &[
                    "/design/pinion/teeth",
                    "/design/pinion/bore_diameter_mm",
                    "/design/pinion/mass_kg",
                    "/design/pinion/inertia_kg_m2",
                ],
            ),
            block(
                "Gear",
                &[
                    "/design/gear/teeth",
                    "/design/gear/bore_diameter_mm",
                    "/design/gear/mass_kg",
                    "/design/gear/inertia_kg_m2",
                ],
            ),
            block("Material of both", &["/design/material"]),
        ],
    },
    GroupPlan {
        id: "widths",
        title: "Widths and helix",
        help: "Widths and angles are those of one half.",
        open: true,
        blocks: &[block(
            "",
            &[
                "/design/helix_angle_deg",
                "/design/face_width_mm",
                "/design/gap_width_mm",
                "/design/half_stagger",
                "/design/pinion/left_half_hand",
                "/design/gear/left_half_hand",
            ],
        )],
    },
    GroupPlan { id: "operation", title: "Operation", help: "", open: true, blocks: &[block("", &["/operation"])] },
    GroupPlan {
        id: "tooth-form",
        title: "Tooth form",
        help: "Coefficients are multiples of the normal module.",
        open: false,
        blocks: &[
            block(
                "Pinion",
                &[
                    "/design/pinion/profile_shift",
                    "/design/pinion/addendum",
                    "/design/pinion/dedendum",
                    "/design/pinion/fillet_radius",
                    "/design/pinion/tip_alteration",
                ],
            ),
            block(
                "Gear",
                &[
                    "/design/gear/profile_shift",
                    "/design/gear/addendum",
                    "/design/gear/dedendum",
                    "/design/gear/fillet_radius",
                    "/design/gear/tip_alteration",
                ],
            ),
        ],
    },
    GroupPlan {
        id: "micro-geometry",
        title: "Micro-geometry",
        help: "Amounts are material removed, in the transverse plane along the base tangent. They apply to both halves \
               unless a half says otherwise.",
        open: false,
        blocks: &[
            block(
                "Pinion",
                &[
                    "/design/pinion/tip_relief",
                    "/design/pinion/lead_crowning_um",
                    "/design/pinion/helix_slope_um",
                    "/design/pinion/end_relief",
                ],
            ),
            block(
                "Gear",
                &[
                    "/design/gear/tip_relief",
                    "/design/gear/lead_crowning_um",
                    "/design/gear/helix_slope_um",
                    "/design/gear/end_relief",
                ],
            ),
            block("Pinion, left half only", &["/design/pinion/left"]),
            block("Pinion, right half only", &["/design/pinion/right"]),
            block("Gear, left half only", &["/design/gear/left"]),
            block("Gear, right half only", &["/design/gear/right"]),
        ],
    },
    GroupPlan {
        id: "supports",
        title: "Supports",
        help: "Shafts and bearings, per half.",
        open: false,
        blocks: &[block("", &["/design/supports"])],
    },
    GroupPlan {
        id: "assembly",
        title: "Assembly errors",
        help: "",
        open: false,
        blocks: &[block("", &["/design/assembly"])],
    },
    GroupPlan {
        id: "model",
        title: "Model",
        help: "",
        open: false,
        blocks: &[
            block("", &["/model/plane", "/model/mesh_damping_ratio", "/model/damping_in_gap"]),
            block("Mesh stiffness", &["/model/mesh_stiffness"]),
            block("Impact", &["/model/impact"]),
        ],
    },
    GroupPlan { id: "analysis", title: "Analysis", help: "", open: false, blocks: &[block("", &["/analysis"])] },
];

pub const CONDITIONS: &[Condition] = &[
    Condition { pointer: "/axes", on: "/kind", values: "sweep" },
    Condition { pointer: "/continuation", on: "/kind", values: "sweep" },
    Condition { pointer: "/record", on: "/kind", values: "sweep" },
    Condition { pointer: "/model/mesh_stiffness/fidelity", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/elements", on: "/model/mesh_stiffness/fidelity", values: "fe" },
    Condition { pointer: "/model/mesh_stiffness/accuracy", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/body", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/corner_contact", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/positions", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/slices", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_stiffness/mean_n_per_um", on: "/model/mesh_stiffness/source", values: "given" },
    Condition { pointer: "/model/mesh_stiffness/harmonics", on: "/model/mesh_stiffness/source", values: "given" },
    Condition {
        pointer: "/model/mesh_stiffness/samples_n_per_um",
        on: "/model/mesh_stiffness/source",
        values: "given",
    },
    Condition { pointer: "/model/impact/duration", on: "/model/impact/source", values: "corner_contact zhou2008" },
    Condition {
        pointer: "/model/impact/base_pitch_error_um",
        on: "/model/impact/source",
        values: "corner_contact zhou2008",
    },
    Condition {
        pointer: "/model/impact/start_mesh_periods",
        on: "/model/impact/source",
        values: "corner_contact zhou2008 given",
    },
    Condition { pointer: "/model/impact/force_n", on: "/model/impact/source", values: "given" },
    Condition { pointer: "/model/impact/duration_mesh_periods", on: "/model/impact/source", values: "given" },
    Condition { pointer: "/analysis/initial_state", on: "/analysis/method", values: "integrate" },
];

/// Fields whose default depends on other fields, and what an empty input of theirs says. The declared default is not
/// shown for them: it would be wrong as soon as the other field changes.
pub const DERIVED: &[(&str, &str)] = &[
    ("/design/gear/left_half_hand", "opposite of the pinion's"),
    ("/design/pinion/left", "as both halves"),
    ("/design/pinion/right", "as both halves"),
    ("/design/gear/left", "as both halves"),
    ("/design/gear/right", "as both halves"),
];

/// Number of axes that a sweep can have.
pub const AXES: usize = 2;
