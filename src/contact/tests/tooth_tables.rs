//! Tooth and body compliance against three-dimensional finite elements.

use super::{pair, spec};
use crate::contact::flank::{BodyHold, Flank};

#[test]
fn face_uniform() {
    let mut spec = spec([29, 67], 30.0, 45e-3);
    spec.pinion.bore_radius_m = 25e-3;
    spec.gear.bore_radius_m = 60e-3;
    let pair = pair(&spec);
    let n = 36;
    let rhos = [
        [15.6249, 18.4996, 20.9841, 23.204, 25.2294, 27.1039, 28.8569, 30.5093, 32.0767, 33.5709, 35.0015],
        [49.6264, 51.9739, 54.2198, 56.3764, 58.4534, 60.4591, 62.4004, 64.2831, 66.1122, 67.8921, 69.6264],
    ];
    let fe = [
        [2.6827, 3.0041, 3.4958, 4.0496, 4.6936, 5.4543, 6.3613, 7.4502, 8.7678, 10.391, 11.804],
        [5.1581, 5.4851, 5.9809, 6.5374, 7.1884, 7.9658, 8.9059, 10.053, 11.467, 13.242, 14.822],
    ];
    let fe_next = [
        [2.7241, 2.7371, 2.7528, 2.7641, 2.7709, 2.7731, 2.7706, 2.7637, 2.7522, 2.7362, 2.7232],
        [5.5072, 5.5565, 5.6267, 5.6926, 5.7542, 5.8112, 5.8635, 5.9112, 5.9542, 5.9926, 6.0156],
    ];
    for m in 0..2 {
        let side = [1.0, -1.0][m];
        let bore = Flank::new(&pair, side, BodyHold::Bore, n, 3);
        let rim = Flank::new(&pair, side, BodyHold::Rim, n, 3);
        for (i, rho) in rhos[m].iter().enumerate() {
            let at = bore.at(rho * 1e-3);
            let f = bore.weights(rho * 1e-3);
            let mean = |flank: &Flank, k: usize| {
                let mut sum = 0.0;
                for i in 0..n {
                    for j in 0..n {
                        sum += flank.ring.between(k, i, j, &f, &f);
                    }
                }
                sum / (n * n) as f64 * 1e10
            };
            let own = at.line_compliance_m2_per_n / 45e-3 * 1e10;
            let (b, r) = (mean(&bore, 0), mean(&rim, 0));
            let (h, l) = (at.depth_m, 45e-3 / pair.base_helix_angle_rad.cos());
            let end = (1.0 + (h / l).powi(2)).sqrt() - h / l;
            let half = 1.3 / (2.0 * std::f64::consts::PI * 206e9 * l)
                * (2.0 * 0.7 * 2.0 * ((l / h).asinh() - end) + 2.0 * end)
                * 1e10;
            let fe = fe.map(|r| r.map(|v| v + half));
            println!(
                "{half:.3} h {:.3} {rho:6.2} own {own:6.3} decay {:.3} mm  bore ring {b:6.3} rim ring {r:6.3} total {:6.3} fe {:6.3} {:+.1}% | next {:6.3} fe {:6.3} rim {:6.3}  ",
                h * 1e3, at.decay_length_m * 1e3, own + b, fe[m][i], 100.0 * ((own + b) / fe[m][i] - 1.0), mean(&bore, 1), fe_next[m][i], mean(&rim, 1)
            );
        }
    }
}

#[test]
fn plane_tooth() {
    // z, h, [(r/m, C*)]
    for (z, h, table) in [
        (25u32, 1.4, [(11.8959, 2.6863), (12.5905, 4.7170), (13.3713, 10.2972)]),
        (43, 1.4, [(20.8074, 2.4303), (21.6259, 4.8307), (22.3809, 10.3803)]),
        (43, 2.0, [(20.8074, 3.3069), (21.6259, 5.7485), (22.3809, 11.3517)]),
    ] {
        let m = 4e-3;
        for width in [11.0, 40.0] {
            let mut spec = spec([z, 67], 0.0, width * m);
            let rf = (0.5 * f64::from(z) - 1.25) * m;
            spec.pinion.bore_radius_m = rf / h;
            let pair = pair(&spec);
            let n = 64;
            let flank = Flank::new(&pair, 1.0, BodyHold::Bore, n, 3);
            for (r, c) in table {
                let rho = ((r * m).powi(2) - pair.pinion.base_radius_m.powi(2)).sqrt();
                let at = flank.at(rho);
                let f = flank.weights(rho);
                let ring = |i: usize| (0..n).map(|j| flank.ring.between(0, i, j, &f, &f)).sum::<f64>() / n as f64;
                let e = 206e9 * spec.face_width_m;
                let own = at.line_compliance_m2_per_n * 206e9;
                let mean = (0..n).map(ring).sum::<f64>() / n as f64;
                println!("z {z} h {h} b/m {width} r {r} own {own:.3} ring mid {:.3} mean {:.3} end {:.3} total mid {:.3} fe {c} ratio {:.3} mean {:.3}",
                 ring(n/2)*e, mean*e, ring(0)*e, own + ring(n/2)*e, (own + ring(n/2)*e)/c, (own+mean*e)/c);
            }
        }
    }
}

#[test]
fn point_hats() {
    use crate::contact::coupling::ToothChain;
    let mut spec = spec([29, 67], 30.0, 45e-3);
    spec.pinion.bore_radius_m = 25e-3;
    spec.gear.bore_radius_m = 60e-3;
    let pair = pair(&spec);
    let n = 90;
    let node = |j: usize| match j { 0 => 0.0, 20 => 45e-3, j => (3.9433 - 2.31960 * 2.0 + 2.3196 * j as f64) * 1e-3 };
    let table = [(0, 20.984, 10, 20.984, 10, 5.299, 24.015, 3.147),
(0, 25.229, 10, 25.229, 10, 8.295, 26.978, 3.124),
(0, 28.857, 10, 28.857, 10, 12.799, 31.450, 3.081),
(0, 32.077, 10, 32.077, 10, 20.264, 38.883, 3.017),
(0, 35.002, 10, 35.002, 10, 33.142, 55.688, 2.946),
(0, 28.857, 10, 28.857, 15, 4.605, 5.665, 3.499),
(0, 28.857, 10, 28.857, 5, 4.021, 5.081, 2.249),
(0, 28.857, 10, 28.857, 20, 2.063, 2.617, 3.624),
(0, 28.857, 10, 28.857, 0, 1.576, 2.130, 1.597),
(0, 25.229, 10, 32.077, 10, 12.008, 16.148, 3.032),
(0, 20.984, 10, 32.077, 10, 8.930, 11.786, 3.023),
(0, 25.229, 5, 25.229, 5, 8.618, 27.301, 3.103),
(0, 25.229, 15, 25.229, 15, 10.437, 29.120, 3.928),
(0, 28.857, 20, 28.857, 20, 151.777, 184.660, 5.898),
(0, 28.857, 0, 28.857, 0, 28.225, 61.108, 3.559),
(1, 54.220, 10, 54.220, 10, 7.044, 25.402, 6.050),
(1, 58.453, 10, 58.453, 10, 9.900, 28.244, 6.135),
(1, 62.400, 10, 62.400, 10, 14.318, 32.648, 6.197),
(1, 66.112, 10, 66.112, 10, 21.979, 40.295, 6.233),
(1, 69.626, 10, 69.626, 10, 36.072, 58.349, 6.242),
(1, 62.400, 10, 62.400, 15, 6.630, 7.692, 5.055),
(1, 62.400, 10, 62.400, 5, 7.762, 8.824, 7.003),
(1, 62.400, 10, 62.400, 20, 4.253, 4.807, 4.026),
(1, 62.400, 10, 62.400, 0, 5.876, 6.431, 7.476),
(1, 58.453, 10, 66.112, 10, 13.445, 17.404, 6.126),
(1, 54.220, 10, 66.112, 10, 10.417, 13.138, 6.044),
(1, 58.453, 5, 58.453, 5, 12.390, 30.734, 7.440),
(1, 58.453, 15, 58.453, 15, 9.618, 27.962, 5.597),
(1, 62.400, 20, 62.400, 20, 26.850, 58.958, 5.675),
(1, 62.400, 0, 62.400, 0, 146.932, 179.040, 9.895),
];
    for m in 0..2 {
        let flank = Flank::new(&pair, [1.0, -1.0][m], BodyHold::Bore, n, 3);
        for (member, ra, ja, rb, jb, bulk, total, next) in table {
            if member != m { continue }
            let hat = |j: usize| {
                let (z, h) = (node(j), 2.3196e-3);
                let mut w: Vec<f64> = (0..n).map(|i| (1.0 - (((i as f64 + 0.5) * 0.5e-3 - z) / h).abs()).max(0.0)).collect();
                let sum: f64 = w.iter().sum();
                w.iter_mut().for_each(|v| *v /= sum);
                w
            };
            let (wa, wb) = (hat(ja), hat(jb));
            let (a, b) = (flank.at(ra * 1e-3), flank.at(rb * 1e-3));
            let mut chain = ToothChain::default();
            let geo = (a.line_compliance_m2_per_n * b.line_compliance_m2_per_n).sqrt();
            let decay = 0.5 * (a.decay_length_m + b.decay_length_m);
            chain.prepare(0.5e-3, (0..n).map(|_| (geo, decay)));
            let mut column = vec![0.0; n];
            let (mut own, mut ring, mut half, mut nxt) = (0.0, 0.0, 0.0, 0.0);
            let depth = 0.5 * (a.depth_m + b.depth_m);
            let slope = if m == 0 { 1.0 } else { -1.0 };
            let _ = slope;
            for j in 0..n {
                if wb[j] == 0.0 { continue }
                chain.column(j, &mut column);
                for i in 0..n {
                    if wa[i] == 0.0 { continue }
                    let w = wa[i] * wb[j];
                    own += w * column[i];
                    ring += w * flank.ring.between(0, i, j, &flank.weights(ra*1e-3), &flank.weights(rb*1e-3));
                    nxt += w * flank.ring.between(1, i, j, &flank.weights(ra*1e-3), &flank.weights(rb*1e-3));
                    let d = (i as f64 - j as f64) * 0.5e-3 / pair.base_helix_angle_rad.cos();
                    let ds = (ra * ra - rb * rb) * 1e-6 / 2.0 / [61.741468e-3, 142.64408e-3][m];
                    let r = (d * d + depth * depth + ds * ds).sqrt();
                    half += w * 1.3 / (2.0 * std::f64::consts::PI * 206e9) * (1.4 / r + depth * depth / r.powi(3));
                }
            }
            let fe = bulk + half * 1e10;
            println!("m {m} ({ra} {ja}) ({rb} {jb}) own {:.3} ring {:.3} sum {:.3} | fe bulk {bulk} + {:.3} = {fe:.3} (total {total}) {:+.1}% | next {:.3} fe {next}", own*1e10, ring*1e10, (own+ring)*1e10, half*1e10, 100.0*((own+ring)*1e10/fe-1.0), nxt*1e10);
        }
    }
}

#[test]
fn waves_along_the_face() {
    let m = 4e-3;
    let ks = [0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0];
    let tables = [
        (1.4, 11.896, [2.6863, 2.6315, 2.4704, 2.1117, 1.7245, 1.1715, 0.7942, 0.4049, 0.2332, 0.0909]),
        (1.4, 12.410, [4.0092, 3.9339, 3.7110, 3.1912, 2.5945, 1.7112, 1.1138, 0.5318, 0.2974, 0.1169]),
        (1.4, 13.371, [10.2947, 10.1299, 9.6409, 8.4381, 6.9646, 4.6908, 3.1206, 1.5673, 0.9318, 0.4336]),
    ];
    let cross = [0.7012, 0.6633, 0.5556, 0.3511, 0.1906, 0.0576, 0.0164];
    for (h, r, table) in tables {
        let mut spec = spec([25, 67], 0.0, 24.0 * m);
        spec.pinion.bore_radius_m = 11.25 * m / h;
        let pair = pair(&spec);
        let n = 96;
        let flank = Flank::new(&pair, 1.0, BodyHold::Bore, n, 3);
        let rho = ((r * m).powi(2) - pair.pinion.base_radius_m.powi(2)).sqrt();
        let at = flank.at(rho);
        let f = flank.weights(rho);
        let own = at.line_compliance_m2_per_n * 206e9;
        let mid = n / 2;
        let c = |offset: usize, k: f64| {
            (0..n).map(|j| flank.ring.between(offset, mid, j, &f, &f) * (k / m * (j as f64 - mid as f64) * spec.face_width_m / n as f64).cos()).sum::<f64>() / n as f64 * 206e9 * spec.face_width_m
        };
        println!("r {r} own {own:.3} lambda/m {:.3}", at.decay_length_m / m);
        for (i, (k, fe)) in ks.iter().zip(table).enumerate() {
            let ring = c(0, *k);
            let mine = own / (1.0 + (k * at.decay_length_m / m).powi(2));
            println!("  k {k} ring {ring:.3} own {mine:.3} total {:.3} fe {fe} | fe-ring {:.3} -> lambda {:.3} | cross {:.4} fe {:.4}", ring + mine, fe - ring, ((own / (fe - ring) - 1.0).max(0.0)).sqrt() / k, c(1, *k), cross.get(i).copied().unwrap_or(0.0));
        }
    }
}
