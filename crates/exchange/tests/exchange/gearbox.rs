//! Models made for the tests: a double-helical pair, written in the dialect of any version.

use serde_json::{Value, json};

/// A component of a model: id, type, name, attributes.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub id: i64,
    pub kind: String,
    /// Id, unit, value: a number, a text, a flag or a vector.
    pub attributes: Vec<(String, String, Value)>,
}

/// A relation: type, order, roles.
#[derive(Debug, Clone)]
pub(crate) struct Tie {
    pub kind: String,
    pub order: Option<i64>,
    pub refs: Vec<(String, i64)>,
}

/// A model of a gear unit.
#[derive(Debug, Clone)]
pub(crate) struct Gearbox {
    pub version: String,
    pub parts: Vec<Part>,
    pub ties: Vec<Tie>,
    /// Load cases: components with attributes.
    pub cases: Vec<Vec<Part>>,
}

/// Ids of the pair that [`Gearbox::double_helical`] makes; the halves' ids end in their number.
pub(crate) const PINION_SHAFT: i64 = 10;
pub(crate) const WHEEL_SHAFT: i64 = 20;
pub(crate) const PINION: [i64; 2] = [31, 32];
pub(crate) const WHEEL: [i64; 2] = [41, 42];
pub(crate) const STAGE: [i64; 2] = [51, 52];
pub(crate) const LOAD: i64 = 60;
/// Middles of the halves on the shafts, mm, and their width.
pub(crate) const MIDDLES_MM: [f64; 2] = [110.0, 220.0];
pub(crate) const WIDTH_MM: f64 = 70.0;

fn version_number(version: &str) -> (u32, u32) {
    let mut parts = version.split('.').map(|part| part.parse().expect("a number"));
    (parts.next().expect("major"), parts.next().expect("minor"))
}

impl Gearbox {
    /// A pair of two halves, z 29/67, m_n 5 mm, β 25°, left half of the pinion right-hand.
    pub(crate) fn double_helical(version: &str) -> Gearbox {
        let mut model = Gearbox { version: version.to_owned(), parts: Vec::new(), ties: Vec::new(), cases: Vec::new() };
        let modulus = if version_number(version) >= (2, 0) { "MPa" } else { "N / mm^2" };
        model.part(1, "gear_unit", &[]);
        model.part(2, "gear_casing", &[]);
        model.part(
            3,
            "material",
            &[
                ("elastic_modulus", modulus, json!(206000.0)),
                ("poisson_ratio", "none", json!(0.3)),
                ("density", "kg / dm^3", json!(7.83)),
            ],
        );
        let module_mm = 5.0;
        let angle_deg: f64 = 25.0;
        let teeth = [29.0, 67.0];
        let shifts = [0.1, -0.1];
        let center_mm = module_mm * (teeth[0] + teeth[1]) / 2.0 / angle_deg.to_radians().cos();
        for (shaft, v_mm) in [(PINION_SHAFT, 0.0), (WHEEL_SHAFT, center_mm)] {
            model.part(
                shaft,
                "shaft",
                &[
                    ("support_vector", "mm", json!([0.0, v_mm, 0.0])),
                    ("u_axis_vector", "mm", json!([1.0, 0.0, 0.0])),
                    ("reference_component_for_position", "none", json!(1)),
                ],
            );
            model.tie("assembly", None, &[("assembly", 1), ("part", shaft)]);
        }
        model.attribute(PINION_SHAFT, "rotational_speed", "1 / min", json!(1800.0));
        model.attribute(PINION_SHAFT, "defines_speed", "none", json!(true));
        model.part(
            LOAD,
            "external_load",
            &[
                ("u_coordinate_on_shaft", "mm", json!(0.0)),
                ("torque_around_u_axis", "N m", json!(900.0)),
                ("defines_torque", "none", json!(true)),
                ("transmits_torque", "none", json!(true)),
            ],
        );
        model.tie("assembly", None, &[("assembly", PINION_SHAFT), ("part", LOAD)]);
        for half in [0, 1] {
            let hand = if half == 0 { 1.0 } else { -1.0 };
            model.part(STAGE[half], "cylindrical_stage", &[("center_distance", "mm", json!(center_mm))]);
            model.tie("assembly", None, &[("assembly", 1), ("part", STAGE[half])]);
            model.tie("stage", None, &[("stage", STAGE[half]), ("gear_1", PINION[half]), ("gear_2", WHEEL[half])]);
            for (member, gear, shaft, sign) in
                [(0, PINION[half], PINION_SHAFT, 1.0), (1, WHEEL[half], WHEEL_SHAFT, -1.0)]
            {
                let middle_mm = MIDDLES_MM[half];
                // The lower end of the face in 1.0, its middle from 1.1 on.
                let coordinate_mm =
                    if version_number(version) < (1, 1) { middle_mm - 0.5 * WIDTH_MM } else { middle_mm };
                let v_mm = if member == 0 { 0.0 } else { center_mm };
                let tip_mm = module_mm * teeth[member] / angle_deg.to_radians().cos()
                    + 2.0 * module_mm * (1.0 + shifts[member] - 0.02);
                model.part(
                    gear,
                    "cylindrical_gear",
                    &[
                        ("number_of_teeth", "none", json!(teeth[member])),
                        ("normal_module", "mm", json!(module_mm)),
                        ("helix_angle_reference_diameter", "deg", json!(sign * hand * angle_deg)),
                        ("face_width", "mm", json!(WIDTH_MM)),
                        ("u_coordinate_on_shaft", "mm", json!(coordinate_mm)),
                        ("tip_diameter", "mm", json!(tip_mm)),
                        ("support_vector", "mm", json!([middle_mm, v_mm, 0.0])),
                        ("u_axis_vector", "mm", json!([1.0, 0.0, 0.0])),
                        ("w_axis_vector", "mm", json!([0.0, 0.0, 1.0])),
                        ("reference_component_for_position", "none", json!(1)),
                    ],
                );
                model.tie("assembly", None, &[("assembly", shaft), ("part", gear)]);
                model.tie("reference", None, &[("origin", gear), ("referenced", 3)]);
                let (data, flanks) = (gear + 100, [gear * 10, gear * 10 + 1]);
                model.part(data, "cylindrical_stage_gear_data", &[]);
                model.tie(
                    "stage_gear_data",
                    None,
                    &[("stage", STAGE[half]), ("gear", gear), ("stage_gear_data", data)],
                );
                for flank in flanks {
                    model.part(
                        flank,
                        "cylindrical_gear_flank",
                        &[
                            ("normal_pressure_angle", "deg", json!(20.0)),
                            ("addendum_modification_coefficient", "none", json!(shifts[member])),
                        ],
                    );
                }
                model.tie("flank", None, &[("gear", gear), ("left", flanks[0]), ("right", flanks[1])]);
                model.tool(gear);
            }
        }
        model
    }

    /// A rack with addendum 1.3 and tip rounding 0.3 for a gear, as the version ties it.
    fn tool(&mut self, gear: i64) {
        let version = version_number(&self.version);
        let rounding =
            if version >= (2, 0) { "tip_corner_radius_factor_reference_profile" } else { "tip_radius_factor" };
        let tool = gear + 1000;
        self.part(
            tool,
            "rack_shaped_tool",
            &[
                ("addendum_coefficient_reference_profile", "none", json!(1.3)),
                (rounding, "none", json!(0.3)),
                ("dedendum_coefficient_reference_profile", "none", json!(1.3)),
            ],
        );
        if version < (1, 3) {
            self.tie("ordered_reference", Some(1), &[("origin", gear), ("referenced", tool)]);
            return;
        }
        self.part(tool + 1000, "cylindrical_gear_manufacturing_settings", &[]);
        for flank in [gear * 10, gear * 10 + 1] {
            self.tie(
                "manufacturing_step",
                Some(1),
                &[("workpiece", flank), ("tool", tool), ("manufacturing_settings", tool + 1000)],
            );
        }
    }

    /// Sections, bearings and an output for both shafts.
    pub(crate) fn with_shafts(mut self) -> Gearbox {
        for (shaft, diameter_mm, bore_mm, first) in [(PINION_SHAFT, 80.0, 20.0, 200), (WHEEL_SHAFT, 110.0, 0.0, 220)] {
            for (index, (start_mm, length_mm)) in [(0.0, 60.0), (60.0, 210.0), (270.0, 80.0)].into_iter().enumerate() {
                let section = first + index as i64;
                let outer_mm = if index == 1 { diameter_mm } else { diameter_mm - 10.0 };
                self.part(
                    section,
                    "shaft_section",
                    &[
                        ("u_coordinate_on_shaft", "mm", json!(start_mm)),
                        ("length", "mm", json!(length_mm)),
                        ("outer_diameter_begin", "mm", json!(outer_mm)),
                        ("outer_diameter_end", "mm", json!(outer_mm)),
                        ("inner_diameter_begin", "mm", json!(bore_mm)),
                        ("inner_diameter_end", "mm", json!(bore_mm)),
                    ],
                );
                self.tie("assembly", None, &[("assembly", shaft), ("part", section)]);
            }
            for (index, place_mm) in [30.0, 300.0].into_iter().enumerate() {
                let bearing = first + 10 + index as i64;
                let axial = if shaft == WHEEL_SHAFT && index == 0 { "both_directions" } else { "no_direction" };
                self.part(
                    bearing,
                    "concept_bearing",
                    &[
                        ("u_coordinate_on_shaft_inner_side", "mm", json!(place_mm)),
                        ("u_coordinate_on_shaft_outer_side", "mm", json!(place_mm)),
                        ("radial_force_absorption", "none", json!(true)),
                        ("axial_force_absorption", "none", json!(axial)),
                        ("radial_stiffness", "N / m", json!(6e8)),
                        ("axial_stiffness", "N / m", json!(2e8)),
                        ("bending_stiffness", "N mm / rad", json!(3e9)),
                    ],
                );
                self.tie("side", None, &[("assembly", bearing), ("inner_part", shaft), ("outer_part", 2)]);
            }
        }
        self.part(
            61,
            "external_load",
            &[
                ("u_coordinate_on_shaft", "mm", json!(350.0)),
                ("transmits_torque", "none", json!(true)),
                ("defines_torque", "none", json!(false)),
            ],
        );
        self.tie("assembly", None, &[("assembly", WHEEL_SHAFT), ("part", 61)]);
        self
    }

    pub(crate) fn part(&mut self, id: i64, kind: &str, attributes: &[(&str, &str, Value)]) {
        let attributes =
            attributes.iter().map(|(id, unit, value)| ((*id).to_owned(), (*unit).to_owned(), value.clone()));
        self.parts.push(Part { id, kind: kind.to_owned(), attributes: attributes.collect() });
    }

    pub(crate) fn tie(&mut self, kind: &str, order: Option<i64>, refs: &[(&str, i64)]) {
        let refs = refs.iter().map(|(role, id)| ((*role).to_owned(), *id)).collect();
        self.ties.push(Tie { kind: kind.to_owned(), order, refs });
    }

    pub(crate) fn of(&mut self, id: i64) -> &mut Part {
        self.parts.iter_mut().find(|part| part.id == id).unwrap_or_else(|| panic!("component {id}"))
    }

    /// Sets or adds an attribute.
    pub(crate) fn attribute(&mut self, id: i64, name: &str, unit: &str, value: Value) {
        let part = self.of(id);
        part.attributes.retain(|(known, ..)| known != name);
        part.attributes.push((name.to_owned(), unit.to_owned(), value));
    }

    pub(crate) fn without(&mut self, id: i64, name: &str) {
        self.of(id).attributes.retain(|(known, ..)| known != name);
    }

    /// A modification of both flanks of a gear.
    pub(crate) fn modify(&mut self, gear: i64, id: i64, kind: &str, attributes: &[(&str, &str, Value)]) {
        for (offset, flank) in [gear * 10, gear * 10 + 1].into_iter().enumerate() {
            let id = id + offset as i64;
            self.part(id, kind, attributes);
            self.tie("reference", None, &[("origin", flank), ("referenced", id)]);
        }
    }

    /// Type and unit as the version writes them.
    fn kind_of<'k>(&self, kind: &'k str) -> &'k str {
        match (kind, version_number(&self.version) < (1, 3)) {
            ("cylindrical_gear_flank", true) => "flank_geometry",
            ("cylindrical_stage_gear_data", true) => "stage_gear_data",
            (kind, _) => kind,
        }
    }

    fn unit_of<'u>(&self, unit: &'u str) -> &'u str {
        if unit == "deg" && version_number(&self.version) < (1, 4) { "°" } else { unit }
    }

    pub(crate) fn xml(&self) -> String {
        let mut text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model version=\"{}\" applicationId=\"test\" applicationVersion=\"1\" date=\"2026-01-01T00:00:00+00:00\">\n<relations>\n",
            self.version
        );
        for (number, tie) in self.ties.iter().enumerate() {
            let order = tie.order.map(|order| format!(" order=\"{order}\"")).unwrap_or_default();
            text.push_str(&format!("<relation id=\"{}\" type=\"{}\"{order}>\n", number + 1, tie.kind));
            for (role, id) in &tie.refs {
                text.push_str(&format!("<ref id=\"{id}\" role=\"{role}\" hint=\"a hint\"/>\n"));
            }
            text.push_str("</relation>\n");
        }
        text.push_str("</relations>\n<components>\n");
        self.parts.iter().for_each(|part| text.push_str(&self.part_xml(part)));
        text.push_str("</components>\n");
        if !self.cases.is_empty() {
            text.push_str("<load_spectrum id=\"1\">\n");
            for (number, parts) in self.cases.iter().enumerate() {
                text.push_str(&format!("<load_case id=\"{}\">\n", number + 1));
                parts.iter().for_each(|part| text.push_str(&self.part_xml(part)));
                text.push_str("</load_case>\n");
            }
            text.push_str("</load_spectrum>\n");
        }
        text.push_str("</model>\n");
        text
    }

    fn part_xml(&self, part: &Part) -> String {
        let mut text =
            format!("<component id=\"{}\" type=\"{}\" name=\"part {}\">\n", part.id, self.kind_of(&part.kind), part.id);
        for (id, unit, value) in &part.attributes {
            let inner = match value {
                Value::Array(items) => {
                    format!("<array>{}</array>", items.iter().map(|item| format!("<c>{item}</c>")).collect::<String>())
                }
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            text.push_str(&format!("<attribute id=\"{id}\" unit=\"{}\">{inner}</attribute>\n", self.unit_of(unit)));
        }
        text.push_str("</component>\n");
        text
    }

    pub(crate) fn json(&self) -> String {
        let part = |part: &Part| {
            let attributes: Vec<Value> = part
                .attributes
                .iter()
                .map(|(id, unit, value)| {
                    let kind = match value {
                        Value::Array(_) => "floating_point_array",
                        Value::String(_) => "enum",
                        Value::Bool(_) => "boolean",
                        _ if id.starts_with("reference_component") => "reference_component",
                        _ => "floating_point",
                    };
                    json!({"id": id, "unit": self.unit_of(unit), kind: value})
                })
                .collect();
            json!({"id": part.id, "type": self.kind_of(&part.kind), "name": format!("part {}", part.id), "attributes": attributes})
        };
        let relations: Vec<Value> = self
            .ties
            .iter()
            .enumerate()
            .map(|(number, tie)| {
                let refs: Vec<Value> =
                    tie.refs.iter().map(|(role, id)| json!({"id": id, "role": role, "hint": "a hint"})).collect();
                let mut relation = json!({"id": number + 1, "type": tie.kind, "refs": refs});
                if let Some(order) = tie.order {
                    relation["order"] = order.into();
                }
                relation
            })
            .collect();
        let mut model = json!({
            "version": self.version, "applicationId": "test", "applicationVersion": "1", "date": "2026-01-01T00:00:00+00:00",
            "relations": relations, "components": self.parts.iter().map(part).collect::<Vec<_>>(),
        });
        if !self.cases.is_empty() {
            let cases: Vec<Value> = self
                .cases
                .iter()
                .enumerate()
                .map(|(number, parts)| json!({"id": number + 1, "components": parts.iter().map(part).collect::<Vec<_>>()}))
                .collect();
            model["load_spectrum"] = json!({"id": 1, "load_cases": cases});
        }
        json!({"model": model}).to_string()
    }
}
