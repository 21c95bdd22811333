//! Members of different material and width: equal ones change nothing, unlike ones agree with the finite elements,
//! which share no code with the analytic compliance, and with what elasticity says.

use super::{pair, spec};
use crate::compliance::{Compliance, Settings};
use crate::contact::{HalfCycle, solve_half};
use crate::fe::{FlankFlexibility, Resolution};
use crate::gear::{GearSpec, Half, Material, Pair, PairSpec};
use crate::watch::Watch;
use herringbone_oracle::Tolerance::Relative;
use herringbone_oracle::{check, check_worst};

const TOPIC: &str = "Contact: members of different material and width";
const PLASTIC: Material = Material { youngs_modulus_pa: 2.8e9, poissons_ratio: 0.38, density_kg_m3: 1410.0 };
const BRONZE: Material = Material { youngs_modulus_pa: 110e9, poissons_ratio: 0.34, density_kg_m3: 8800.0 };
const WIDTH: f64 = 20e-3;

fn with(change: impl Fn(&mut PairSpec)) -> Pair {
    let mut base = spec([20, 30], 15.0, WIDTH);
    change(&mut base);
    pair(&base)
}

fn settings() -> Settings {
    Settings { positions: Some(8), ..Settings::default() }
}

fn analytic(pair: &Pair, force_n: f64) -> HalfCycle {
    let compliance = Compliance::analytic(pair, &settings(), Watch::none()).expect("not canceled");
    solve_half(pair, Half::Left, force_n, &compliance, &settings(), Watch::none()).unwrap()
}

fn elements(pair: &Pair, force_n: f64) -> HalfCycle {
    let flanks = Compliance::finite_element_inputs(pair, &settings(), Resolution::Coarse)
        .map(|input| FlankFlexibility::new(&input, Watch::none()).unwrap());
    let compliance =
        Compliance::finite_elements(pair, &settings(), [&flanks[0], &flanks[1]], Watch::none()).expect("not canceled");
    solve_half(pair, Half::Left, force_n, &compliance, &settings(), Watch::none()).unwrap()
}

#[test]
fn own_values_equal_to_the_pairs_change_not_a_bit() {
    let own = |gear: &mut GearSpec| (gear.material, gear.face_width_m) = (Some(Material::STEEL), Some(WIDTH));
    let named = with(|spec| {
        own(&mut spec.pinion);
        own(&mut spec.gear);
        // A material that neither member has.
        spec.material = PLASTIC;
    });
    let plain = with(|_| {});
    assert_eq!(analytic(&named, 2500.0), analytic(&plain, 2500.0));
    let keys = [&named, &plain]
        .map(|pair| Compliance::finite_element_inputs(pair, &settings(), Resolution::Coarse).map(|input| *input.key()));
    assert_eq!(keys[0], keys[1]);
}

#[test]
fn materials_belong_to_their_members() {
    let steel_and = |material| with(move |spec| spec.gear.material = Some(material));
    // A member's elements depend on that member alone.
    let key = |pair: &Pair| Compliance::finite_element_inputs(pair, &settings(), Resolution::Coarse).map(|i| *i.key());
    let (mixed, steel) = (key(&steel_and(PLASTIC)), key(&with(|_| {})));
    assert_eq!(mixed[0], steel[0]);
    assert_ne!(mixed[1], steel[1]);
    // The softer, the softer; and one soft member is stiffer than two.
    let mean = |pair: &Pair| analytic(pair, 800.0).stiffness.mean;
    let both = mean(&with(|spec| spec.material = PLASTIC));
    let pinion = mean(&with(|spec| spec.pinion.material = Some(PLASTIC)));
    let order = [mean(&with(|_| {})), mean(&steel_and(BRONZE)), mean(&steel_and(PLASTIC)), both];
    assert!(order.windows(2).all(|two| two[0] > two[1]) && pinion > both, "{order:?} {pinion}");
    // Linear elasticity and Hertz alike know E only as load over E: both moduli and the load scaled, the same
    // displacements.
    let scaled = |factor: f64| {
        let by = |m: Material| Material { youngs_modulus_pa: m.youngs_modulus_pa * factor, ..m };
        let pair =
            with(|spec| (spec.pinion.material, spec.gear.material) = (Some(by(Material::STEEL)), Some(by(PLASTIC))));
        analytic(&pair, 800.0 * factor)
    };
    let [one, other] = [scaled(1.0), scaled(0.25)];
    let errors = one.transmission_error_m.iter().zip(&other.transmission_error_m).map(|(a, b)| a / b - 1.0);
    check_worst(TOPIC, "deflection with loads and moduli scaled alike", errors, 1e-6);
}

#[test]
fn unlike_members_agree_with_the_finite_elements() {
    let cases = [
        ("steel on plastic", with(|spec| spec.gear.material = Some(PLASTIC)), 150.0),
        ("bronze on steel", with(|spec| spec.pinion.material = Some(BRONZE)), 2500.0),
        ("pinion 1.5 modules wider on both sides", with(|spec| spec.pinion.face_width_m = Some(WIDTH + 12e-3)), 2500.0),
        ("gear 1 module wider on both sides", with(|spec| spec.gear.face_width_m = Some(WIDTH + 8e-3)), 2500.0),
    ];
    for (name, pair, force_n) in cases {
        let [got, truth] = [analytic(&pair, force_n), elements(&pair, force_n)].map(|c| c.stiffness.mean * 1e-6);
        check(TOPIC, &format!("mean tangent stiffness, {name}, N/µm"), got, truth, Relative(0.05));
    }
}

/// Ends beyond the common width support the loaded ones: stiffer, by less and less the longer they are.
#[test]
fn a_wider_member_is_stiffer() {
    let mean = |extra_m: f64, solve: fn(&Pair, f64) -> HalfCycle| {
        solve(&with(|spec| spec.gear.face_width_m = Some(WIDTH + extra_m)), 2500.0).stiffness.mean
    };
    for solve in [analytic as fn(&Pair, f64) -> HalfCycle, elements] {
        let means = [0.0, 4e-3, 12e-3].map(|extra| mean(extra, solve));
        assert!(means[0] < means[1] && means[1] < means[2], "{means:?}");
        assert!(means[2] < 1.15 * means[0], "{means:?}");
        assert!((means[2] - means[1]) / 8.0 < (means[1] - means[0]) / 4.0, "{means:?}");
    }
}
