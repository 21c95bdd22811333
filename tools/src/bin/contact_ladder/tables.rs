//! The tables, as Markdown.

use herringbone_physics::compliance::BodyHold;
use herringbone_physics::fe::Resolution;
use herringbone_tools::statistics::{largest, median, root_mean_square};

use crate::cases::Case;
use crate::rungs::{Answer, Rung, all};

/// One line per rung: median time, and errors over all cases: root mean square and the worst.
pub(crate) fn summary(answers: &[Answer]) {
    println!("| rung | cold | stored | mean stiffness, tangent | secant | first harmonic of the TE | load share |");
    println!("|---|---|---|---|---|---|---|");
    for rung in all() {
        let of: Vec<&Answer> = answers.iter().filter(|a| a.rung == rung).collect();
        let time = |value: fn(&Answer) -> f64| seconds(median(of.iter().map(|a| value(a))));
        let percent = |value: fn(&Answer) -> f64| {
            let errors = || of.iter().map(|a| value(a));
            format!("{} / {}", percent(root_mean_square(errors()), false), percent(largest(errors()), true))
        };
        let shares = || of.iter().map(|a| a.share);
        let worst = largest(shares());
        let share =
            if worst.is_finite() { format!("{:.3} / {worst:+.3}", root_mean_square(shares())) } else { "–".into() };
        println!(
            "| {} | {} | {} | {} | {} | {} | {share} |",
            rung.name(),
            time(|a| a.cold_s),
            if rung == Rung::Iso6336 { "–".into() } else { time(|a| a.stored_s) },
            percent(|a| a.tangent),
            percent(|a| a.secant),
            percent(|a| a.first_harmonic),
        );
    }
    println!();
}

/// The default analytic rung and `fe` at its default resolution, case by case.
pub(crate) fn analytic_by_case(cases: &[Case], answers: &[Answer]) {
    println!("| pair | case | held at | reference | tangent | secant | first harmonic | load share |");
    println!("|---|---|---|---|---|---|---|---|");
    for (number, case) in cases.iter().enumerate() {
        let find = |rung| answers.iter().find(|a| a.case == number && a.rung == rung).expect("every rung");
        let (analytic, elements) = (find(Rung::Analytic(3)), find(Rung::Elements(Resolution::Medium)));
        let both = |value: fn(&Answer) -> f64| {
            format!("{} / {}", percent(value(analytic), true), percent(value(elements), true))
        };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {:+.3} / {:+.3} |",
            case.teeth,
            case.variant,
            hold(case),
            if case.published.is_some() { "stored" } else { "fe fine" },
            both(|a| a.tangent),
            both(|a| a.secant),
            both(|a| a.first_harmonic),
            analytic.share,
            elements.share,
        );
    }
    println!();
}

/// Every rung on every case.
pub(crate) fn by_case(cases: &[Case], answers: &[Answer]) {
    for (number, case) in cases.iter().enumerate() {
        println!("{}, {}, held at the {}:\n", case.teeth, case.variant, hold(case));
        println!("| rung | cold | stored | tangent | secant | first harmonic | load share |");
        println!("|---|---|---|---|---|---|---|");
        for a in answers.iter().filter(|a| a.case == number) {
            println!(
                "| {} | {} | {} | {} | {} | {} | {} |",
                a.rung.name(),
                seconds(a.cold_s),
                seconds(a.stored_s),
                percent(a.tangent, true),
                percent(a.secant, true),
                percent(a.first_harmonic, true),
                if a.share.is_finite() { format!("{:+.3}", a.share) } else { "–".into() },
            );
        }
        println!();
    }
}

fn hold(case: &Case) -> &'static str {
    match case.hold {
        BodyHold::Rim => "rim",
        BodyHold::Bore => "bore",
    }
}

fn percent(value: f64, sign: bool) -> String {
    let value = 100.0 * value;
    let digits = if value.abs() < 0.95 { 2 } else { 1 };
    if sign { format!("{value:+.digits$} %") } else { format!("{value:.digits$} %") }
}

pub(crate) fn seconds(value: f64) -> String {
    let (value, unit) = match value {
        v if v < 1e-3 => (v * 1e6, "µs"),
        v if v < 1.0 => (v * 1e3, "ms"),
        v => (v, "s"),
    };
    let digits = if value < 10.0 { 1 } else { 0 };
    format!("{value:.digits$} {unit}")
}
