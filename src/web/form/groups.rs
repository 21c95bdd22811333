//! The plan of the form: which fields stand together, in the order in which an engineer thinks of them. Only the plan:
//! names, ranges, units, defaults and help come from the job document's own declarations.

/// A section of the form.
pub struct GroupPlan {
    pub id: &'static str,
    pub title: &'static str,
    /// The title in the list of sections.
    pub short: &'static str,
    pub help: &'static str,
    pub open: bool,
    /// What the heading says while nothing is set.
    pub nothing: &'static str,
    pub blocks: &'static [BlockPlan],
}

/// Fields that stand together under a common (perhaps empty) title.
pub struct BlockPlan {
    pub title: &'static str,
    /// Folded away until it is wanted.
    pub folded: bool,
    pub layout: LayoutPlan,
}

pub enum LayoutPlan {
    /// JSON pointers of fields, or of objects for all fields in them.
    Fields(&'static [&'static str]),
    /// Several objects with the same fields side by side: heading and pointer of each, and names of fields (or objects).
    Table { columns: &'static [(&'static str, &'static str)], names: &'static [&'static str] },
}

/// A field (or all fields of an object) that matters only while another field has one of some values.
pub struct Condition {
    pub pointer: &'static str,
    pub on: &'static str,
    pub values: &'static str,
}

const fn block(title: &'static str, pointers: &'static [&'static str]) -> BlockPlan {
    BlockPlan { title, folded: false, layout: LayoutPlan::Fields(pointers) }
}

const PAIR: &[(&str, &str)] = &[("Pinion", "/design/pinion"), ("Gear", "/design/gear")];

const FLANKS: &[(&str, &str)] = &[
    ("Pinion, left", "/design/pinion/left"),
    ("Pinion, right", "/design/pinion/right"),
    ("Gear, left", "/design/gear/left"),
    ("Gear, right", "/design/gear/right"),
];

const COAST: &[(&str, &str)] = &[("Pinion", "/design/pinion/coast"), ("Gear", "/design/gear/coast")];

const COAST_FLANKS: &[(&str, &str)] = &[
    ("Pinion, left", "/design/pinion/coast/left"),
    ("Pinion, right", "/design/pinion/coast/right"),
    ("Gear, left", "/design/gear/coast/left"),
    ("Gear, right", "/design/gear/coast/right"),
];

const MODIFICATIONS: &[&str] = &["tip_relief", "lead_crowning_um", "helix_slope_um", "end_relief"];

const fn pair(names: &'static [&'static str]) -> BlockPlan {
    BlockPlan { title: "", folded: false, layout: LayoutPlan::Table { columns: PAIR, names } }
}

const DEFAULTS: &str = "as by default";

pub const GROUPS: &[GroupPlan] = &[
    GroupPlan {
        id: "job",
        title: "Job",
        short: "Job",
        help: "",
        open: true,
        nothing: DEFAULTS,
        blocks: &[block("", &["/kind", "/name", "/label"])],
    },
    GroupPlan {
        id: "gears",
        title: "Gears",
        short: "Gears",
        help: "",
        open: true,
        nothing: DEFAULTS,
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
            pair(&["teeth", "bore_diameter_mm", "mass_kg", "inertia_kg_m2"]),
            block("Material of both", &["/design/material"]),
            BlockPlan {
                title: "Where the materials differ",
                folded: true,
                layout: LayoutPlan::Table { columns: PAIR, names: &["material"] },
            },
        ],
    },
    GroupPlan {
        id: "widths",
        title: "Widths and helix",
        short: "Widths",
        help: "Widths and angles are those of one half.",
        open: true,
        nothing: DEFAULTS,
        blocks: &[
            block(
                "",
                &["/design/helix_angle_deg", "/design/face_width_mm", "/design/gap_width_mm", "/design/half_stagger"],
            ),
            pair(&["left_half_hand", "face_width_mm"]),
        ],
    },
    GroupPlan {
        id: "tooth-form",
        title: "Tooth form",
        short: "Tooth form",
        help: "Coefficients are multiples of the normal module.",
        open: false,
        nothing: DEFAULTS,
        blocks: &[pair(&["profile_shift", "addendum", "dedendum", "fillet_radius", "tip_alteration"])],
    },
    GroupPlan {
        id: "micro-geometry",
        title: "Micro-geometry",
        short: "Micro-geometry",
        help: "Amounts are material removed, in the transverse plane along the base tangent. They apply to both halves \
               unless a half says otherwise.",
        open: false,
        nothing: "none",
        blocks: &[
            pair(MODIFICATIONS),
            BlockPlan {
                title: "Where the halves differ",
                folded: true,
                layout: LayoutPlan::Table { columns: FLANKS, names: MODIFICATIONS },
            },
            BlockPlan {
                title: "Coast flanks (negative torque), where they differ",
                folded: true,
                layout: LayoutPlan::Table { columns: COAST, names: MODIFICATIONS },
            },
            BlockPlan {
                title: "Coast flanks, where the halves differ",
                folded: true,
                layout: LayoutPlan::Table { columns: COAST_FLANKS, names: MODIFICATIONS },
            },
        ],
    },
    GroupPlan {
        id: "supports",
        title: "Supports",
        short: "Supports",
        help: "Shafts and bearings, per half.",
        open: false,
        nothing: DEFAULTS,
        blocks: &[block("", &["/design/supports"])],
    },
    GroupPlan {
        id: "assembly",
        title: "Assembly errors",
        short: "Assembly",
        help: "",
        open: false,
        nothing: "none",
        blocks: &[block("", &["/design/assembly"])],
    },
    GroupPlan {
        id: "operation",
        title: "Operation",
        short: "Operation",
        help: "",
        open: true,
        nothing: DEFAULTS,
        blocks: &[block("", &["/operation"])],
    },
    GroupPlan {
        id: "sweep",
        title: "Sweep",
        short: "Sweep",
        help: "One or two inputs that vary: give first and last value, or a list of values.",
        open: true,
        nothing: "no axis",
        blocks: &[
            block("First axis", &["/axes/0"]),
            block("Second axis", &["/axes/1"]),
            block("", &["/continuation", "/record"]),
        ],
    },
    GroupPlan {
        id: "model",
        title: "Model",
        short: "Model",
        help: "",
        open: false,
        nothing: DEFAULTS,
        blocks: &[
            block("", &["/model/mesh_force", "/model/plane", "/model/mesh_damping_ratio", "/model/damping_in_gap"]),
            block("Mesh stiffness", &["/model/mesh_stiffness"]),
            block("Impact", &["/model/impact"]),
        ],
    },
    GroupPlan {
        id: "analysis",
        title: "Analysis",
        short: "Analysis",
        help: "",
        open: false,
        nothing: DEFAULTS,
        blocks: &[block("", &["/analysis"])],
    },
];

pub const CONDITIONS: &[Condition] = &[
    Condition { pointer: "/axes", on: "/kind", values: "sweep" },
    Condition { pointer: "/continuation", on: "/kind", values: "sweep" },
    Condition { pointer: "/record", on: "/kind", values: "sweep" },
    Condition { pointer: "/model/mesh_stiffness/fidelity", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition { pointer: "/model/mesh_force", on: "/model/mesh_stiffness/source", values: "ltca" },
    Condition {
        pointer: "/model/mesh_stiffness/line_stiffness_n_per_mm_um",
        on: "/model/mesh_stiffness/fidelity",
        values: "uniform",
    },
    Condition { pointer: "/model/mesh_stiffness/elements", on: "/model/mesh_stiffness/fidelity", values: "fe" },
    Condition { pointer: "/model/mesh_stiffness/law", on: "/model/mesh_stiffness/source", values: "ltca" },
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
    Condition { pointer: "/model/impact/acts_on", on: "/model/impact/source", values: "corner_contact zhou2008 given" },
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
    ("/design/pinion/material", "as both gears"),
    ("/design/gear/material", "as both gears"),
    ("/design/pinion/coast/left", "as both halves"),
    ("/design/pinion/coast/right", "as both halves"),
    ("/design/gear/coast/left", "as both halves"),
    ("/design/gear/coast/right", "as both halves"),
    ("/design/pinion/coast", "as the drive flank"),
    ("/design/gear/coast", "as the drive flank"),
    ("/design/pinion/left", "as both halves"),
    ("/design/pinion/right", "as both halves"),
    ("/design/gear/left", "as both halves"),
    ("/design/gear/right", "as both halves"),
];

/// Number of axes that a sweep can have.
pub const AXES: usize = 2;
