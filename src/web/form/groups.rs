//! The sections of the form, in the order of the design process, and their blocks. The section of a field, its name,
//! range, unit, default and help come from its declaration in the job document.

/// A section of the form.
pub(super) struct GroupPlan {
    pub id: &'static str,
    pub title: &'static str,
    /// The title in the list of sections.
    pub short: &'static str,
    pub help: &'static str,
    pub open: bool,
    /// Summary in the heading while all fields have their defaults.
    pub nothing: &'static str,
    pub blocks: &'static [BlockPlan],
}

/// Block of fields under a common (perhaps empty) title: the fields of the section in one object (or in several side by
/// side), and in the objects in it that have no block of their own.
pub(super) struct BlockPlan {
    pub title: &'static str,
    /// Whether the block is collapsed at first.
    pub folded: bool,
    pub layout: LayoutPlan,
}

pub(super) enum LayoutPlan {
    /// Pointer of the object.
    Fields(&'static str),
    /// Several objects with the same fields side by side: heading and pointer of each.
    Table(&'static [(&'static str, &'static str)]),
}

impl BlockPlan {
    /// Pointers of the block's objects.
    pub(super) fn objects(&self) -> Vec<&'static str> {
        match self.layout {
            LayoutPlan::Fields(object) => vec![object],
            LayoutPlan::Table(columns) => columns.iter().map(|(_, object)| *object).collect(),
        }
    }
}

const fn block(title: &'static str, object: &'static str) -> BlockPlan {
    BlockPlan { title, folded: false, layout: LayoutPlan::Fields(object) }
}

const fn folded(title: &'static str, columns: &'static [(&'static str, &'static str)]) -> BlockPlan {
    BlockPlan { title, folded: true, layout: LayoutPlan::Table(columns) }
}

const PAIR: BlockPlan = BlockPlan {
    title: "",
    folded: false,
    layout: LayoutPlan::Table(&[("Pinion", "/design/pinion"), ("Gear", "/design/gear")]),
};

const MATERIALS: &[(&str, &str)] = &[("Pinion", "/design/pinion/material"), ("Gear", "/design/gear/material")];

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

const DEFAULTS: &str = "as by default";

/// A section without a help text, with the default summary in its heading.
const fn section(id: &'static str, title: &'static str, open: bool, blocks: &'static [BlockPlan]) -> GroupPlan {
    GroupPlan { id, title, short: title, help: "", open, nothing: DEFAULTS, blocks }
}

pub(super) const GROUPS: &[GroupPlan] = &[
    section("job", "Job", true, &[block("", "")]),
    section(
        "gears",
        "Gears",
        true,
        &[
            block("", "/design"),
            PAIR,
            block("Material of both", "/design/material"),
            folded("Where the materials differ", MATERIALS),
        ],
    ),
    GroupPlan {
        short: "Widths",
        help: "Widths and angles are those of one half.",
        ..section("widths", "Widths and helix", true, &[block("", "/design"), PAIR])
    },
    GroupPlan {
        help: "Coefficients are multiples of the normal module.",
        ..section("tooth-form", "Tooth form", false, &[PAIR])
    },
    GroupPlan {
        help: "Amounts are material removed, in the transverse plane along the base tangent. They apply to both halves \
               unless a half says otherwise.",
        nothing: "none",
        ..section(
            "micro-geometry",
            "Micro-geometry",
            false,
            &[
                PAIR,
                folded("Where the halves differ", FLANKS),
                folded("Coast flanks (negative torque), where they differ", COAST),
                folded("Coast flanks, where the halves differ", COAST_FLANKS),
            ],
        )
    },
    GroupPlan {
        help: "Shafts and bearings, per half.",
        ..section("supports", "Supports", false, &[block("", "/design/supports")])
    },
    GroupPlan {
        short: "Assembly",
        nothing: "none",
        ..section("assembly", "Assembly errors", false, &[block("", "/design/assembly")])
    },
    section("operation", "Operation", true, &[block("", "/operation")]),
    GroupPlan {
        help: "One or two inputs that vary: give first and last value, or a list of values.",
        nothing: "no axis",
        ..section(
            "sweep",
            "Sweep",
            true,
            &[block("First axis", "/axes/0"), block("Second axis", "/axes/1"), block("", "")],
        )
    },
    section(
        "model",
        "Model",
        false,
        &[block("", "/model"), block("Mesh stiffness", "/model/mesh_stiffness"), block("Impact", "/model/impact")],
    ),
    section("analysis", "Analysis", false, &[block("", "/analysis")]),
];

/// Number of axes that a sweep can have.
pub(super) const AXES: usize = 2;
