//! Error of the analytic compliance on short faces: mean mesh stiffness of one half against the product's own finite
//! elements, over tooth numbers, helix angle and face width in normal modules. Prints the table of
//! docs/validation/contact.md (short faces): `scripts/tool short_faces [coarse|medium|standard|fine [Z1[:X1]/Z2[:X2]
//! …]]`; teeth and profile shift coefficient of pinion and gear.

use herringbone_physics::compliance::{Compliance, Settings};
use herringbone_physics::contact::{ContactError, HalfCycle, solve_half};
use herringbone_physics::fe::{FlankFlexibility, Resolution};
use herringbone_physics::gear::{GearSpec, Half, Pair, PairSpec};
use herringbone_physics::watch::Watch;
use herringbone_tools::Failure;
use herringbone_tools::arguments::{Arguments, resolution};

const HELIX_DEG: [f64; 6] = [0.0, 10.0, 20.0, 30.0, 40.0, 45.0];
/// Face width in normal modules.
const WIDTHS: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0];
/// Teeth and profile shifts of pinion and gear.
const PAIRS: [&str; 5] = ["10/10", "10:0.45/10:0.45", "17/44", "25/25", "30/90"];
const MODULE_M: f64 = 2e-3;
/// Force along the base tangent over face width and normal module.
const LOAD_PA: f64 = 20e6;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let resolution = resolution(arguments.word(0).unwrap_or("medium"))?;
    let given: Vec<&str> = arguments.from(1).collect();
    let names = if given.is_empty() { PAIRS.to_vec() } else { given };
    println!("| z | β, ° | {} |", WIDTHS.map(|w| format!("b {w} m_n")).join(" | "));
    println!("|---|---|{}", "---|".repeat(WIDTHS.len()));
    for name in names {
        let members = pair(name)?;
        for helix_deg in HELIX_DEG {
            let mut cells = Vec::new();
            for width in WIDTHS {
                let error = error(members, helix_deg, width, resolution)?;
                cells.push(error.map_or("–".to_owned(), |percent| format!("{percent:+.1}")));
            }
            println!("| {name} | {helix_deg} | {} |", cells.join(" | "));
        }
    }
    Ok(())
}

/// Teeth and profile shift of both members, written Z1:X1/Z2:X2.
fn pair(name: &str) -> Result<[(u32, f64); 2], Failure> {
    let member = |text: &str| -> Result<(u32, f64), Failure> {
        let (teeth, shift) = text.split_once(':').unwrap_or((text, "0"));
        Ok((teeth.parse()?, shift.parse()?))
    };
    let (pinion, gear) = name.split_once('/').ok_or("a pair is written Z1/Z2")?;
    Ok([member(pinion)?, member(gear)?])
}

/// Mean tangent stiffness of the analytic compliance over that of finite elements, less one, in percent; none where the
/// pair cannot run.
fn error(members: [(u32, f64); 2], helix_deg: f64, width: f64, resolution: Resolution) -> Result<Option<f64>, Failure> {
    let member = |(z, profile_shift): (u32, f64)| {
        let reference_m = 0.5 * f64::from(z) * MODULE_M / helix_deg.to_radians().cos();
        GearSpec { bore_radius_m: 0.4 * reference_m, profile_shift, ..GearSpec::plain(z) }
    };
    let angles = [20f64.to_radians(), helix_deg.to_radians()];
    let spec = PairSpec::plain(MODULE_M, angles, width * MODULE_M, members.map(member));
    let Ok((pair, _)) = Pair::new(&spec) else { return Ok(None) };
    let settings = Settings { positions: Some(32), ..Settings::default() };
    let [pinion, gear] = Compliance::finite_element_inputs(&pair, &settings, resolution)
        .map(|input| FlankFlexibility::new(&input, Watch::none()));
    let elements = Compliance::finite_elements(&pair, &settings, [&pinion?, &gear?], Watch::none())?;
    let exact = solve(&pair, &elements, &settings)?.stiffness.mean;
    let analytic = solve(&pair, &Compliance::analytic(&pair, &settings, Watch::none())?, &settings)?.stiffness.mean;
    Ok(Some(100.0 * (analytic / exact - 1.0)))
}

fn solve(pair: &Pair, compliance: &Compliance, settings: &Settings) -> Result<HalfCycle, ContactError> {
    let force_n = LOAD_PA * pair.spec.face_width_m * pair.spec.normal_module_m;
    solve_half(pair, Half::Left, force_n, compliance, settings, Watch::none())
}
