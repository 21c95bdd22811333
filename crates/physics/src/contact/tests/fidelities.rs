//! The analytic compliance against the finite elements of this crate, on gears other than the reference pair.

use super::{pair, spec};
use crate::compliance::{Compliance, Settings};
use crate::contact::solve_half;
use crate::fe::{FlankFlexibility, Resolution};
use crate::gear::Half;
use crate::watch::Watch;
use herringbone_oracle::Tolerance::Relative;
use herringbone_oracle::{check, check_worst};

#[test]
fn analytic_compliance_follows_finite_elements() {
    const TOPIC: &str = "Contact: analytic compliance against finite elements, other pairs";
    for (teeth, helix, width) in [([25, 43], 0.0, 24e-3), ([20, 30], 15.0, 20e-3), ([25, 40], 35.0, 14e-3)] {
        let pair = pair(&spec(teeth, helix, width));
        let settings = Settings { corner_contact: false, ..Settings::default() };
        let flanks = Compliance::finite_element_inputs(&pair, &settings, Resolution::Coarse)
            .map(|input| FlankFlexibility::new(&input, Watch::none()).unwrap());
        let force = 5e3 * width / 40e-3;
        let [truth, analytic] = [
            Compliance::finite_elements(&pair, &settings, [&flanks[0], &flanks[1]], Watch::none())
                .expect("not canceled"),
            Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled"),
        ]
        .map(|compliance| solve_half(&pair, Half::Left, force, &compliance, &settings, Watch::none()).unwrap());
        let of = |what: &str| format!("{what}, z {}/{}, helix {helix}°", teeth[0], teeth[1]);
        check(
            TOPIC,
            &of("mean tangent stiffness, N/µm"),
            analytic.stiffness.mean * 1e-6,
            truth.stiffness.mean * 1e-6,
            Relative(0.04),
        );
        let [h1, expected] = [&analytic, &truth].map(|c| c.transmission_error_harmonics_m[0] * 1e6);
        check(TOPIC, &of("first harmonic of the transmission error, µm"), h1, expected, Relative(0.15));
        // On the narrowest face the entering line is all acute corner: 0.032.
        let share = analytic.load_share_at_mesh_in - truth.load_share_at_mesh_in;
        check_worst(TOPIC, &of("share at mesh-in, difference"), [share], 0.04);
    }
}
