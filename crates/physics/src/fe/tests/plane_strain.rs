//! An endless spur gear (the constant along the face) is plane strain.

use crate::fe::Resolution;
use crate::fe::cyclic::expand;
use crate::fe::loads::LoadGrid;
use crate::fe::operator::ElasticBody;
use crate::fe::section::SectionMesh;
use crate::fe::sector::Sector;
use crate::fe::sizes::Sizes;
use crate::fe::spline::SplineSpace;
use crate::fe::surface::InvoluteFlank;
use crate::gear::{Pair, fixtures};
use crate::watch::Watch;
use herringbone_oracle::{Tolerance, check};

/// C* = E b δ/F between two places of neighbouring teeth, load and response at roll lengths `load` and `response`.
fn neighbour(teeth: u32, rim: f64, load_radius: f64, response_radius: f64) -> f64 {
    let gear = fixtures::gear(teeth, 0.0);
    let (pair, _) = Pair::new(&fixtures::spec(1.0, 20.0, 0.0, 10.0, gear, gear)).unwrap();
    let member = &pair.pinion;
    let sizes = Sizes::new(Resolution::Medium);
    let involute = InvoluteFlank::new(member).unwrap();
    let width = 10e-3;
    let grid = LoadGrid {
        profile_m: (0..=10).map(|i| involute.length_m * f64::from(i) / 10.0).collect(),
        stations_m: vec![0.0, width],
    };
    let hold = member.root_radius_m / rim;
    let section = SectionMesh::new(member, &involute, 1e-3, hold, &grid.profile_m, &sizes.section).unwrap();
    let body = ElasticBody { section: &section, youngs_pa: 206e9, nu: 0.3, twist_per_m: 0.0 };
    let levels = vec![0; section.nodes.len()];
    let sector = Sector::new(&body, vec![SplineSpace::constant(width)], levels, &[0.0, width], &involute, &grid);
    let condensed = sector.condense(Watch::none(), (0.0, 0.0)).unwrap();
    let ahead = &expand(&condensed, teeth, 1, Watch::none(), (0.0, 0.0)).unwrap()[1];
    // Linear between the profile nodes, as the hats are.
    let weights = |radius: f64| {
        let roll = member.roll_length_m(radius * 1e-3);
        let s = (roll * roll - involute.form_roll_m * involute.form_roll_m) / (2.0 * involute.base_radius_m);
        let at = 10.0 * s / involute.length_m;
        let i = at as usize;
        [(i, 1.0 - at + i as f64), (i + 1, at - i as f64)]
    };
    let mut sum = 0.0;
    for (a, wa) in weights(response_radius) {
        for (b, wb) in weights(load_radius) {
            sum += wa * wb * ahead[(2 * a, 2 * b)];
        }
    }
    sum * body.youngs_pa * width
}

/// Independent six-node plane-strain elements of the whole gear, rim held at root radius / 1.4 or / 2, response of the
/// next tooth one base pitch away at the tooth's centreline on the load line; where that program gave both
/// displacements (load on either tooth, equal by Maxwell) they differ by up to 1 %. `meshing`: the tooth on the side of
/// the loaded flank is displaced further out, as in a real mesh; `crossed`: further in.
#[test]
fn neighbour_of_a_spur_tooth() {
    let topic = "Elements: plane strain, neighbouring teeth";
    let within = Tolerance::Relative(0.02);
    let cases = [
        (25, 1.4, 12.0751, 13.0786, 0.5 * (0.697 + 0.694), 0.5 * (0.653 + 0.660)),
        (25, 2.0, 12.0751, 13.0786, 1.578, 1.525),
        (43, 1.4, 21.0409, 22.0485, 0.952, 0.878),
    ];
    for (teeth, rim, low, high, meshing, crossed) in cases {
        check(topic, &format!("z {teeth}, rim {rim}, meshing"), neighbour(teeth, rim, low, high), meshing, within);
        check(topic, &format!("z {teeth}, rim {rim}, crossed"), neighbour(teeth, rim, high, low), crossed, within);
    }
}
