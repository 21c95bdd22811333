//! Comparison of the source paper's results with those of the service, and the design guide that it left as future
//! work. Drives the release program over loopback, documents in, results out, and writes docs/STUDY.md with its
//! figures; see
//! `scripts/study`. With names of chapters as arguments, only these are run: their figures are written, their text
//! printed.

mod ask;
mod best;
mod contact;
mod documents;
mod front;
mod guide;
mod histories;
mod loss;
mod maps;
mod mechanisms;
mod page;
mod rules;
mod sensitivity;
mod source;
mod table2;
mod table3;
mod ways;

use ask::{Bench, Outcome};
use herringbone_tools::arguments::Arguments;
use herringbone_tools::plot::Sheet;
use page::Page;
use std::time::Instant;

/// The service under study, the page and its figures.
pub struct Study {
    bench: Bench,
    page: Page,
    figures: Vec<(String, String)>,
    /// Title, points and seconds of each map.
    maps: Vec<(String, usize, f64)>,
    /// The source's claims with their verification.
    verdicts: Vec<front::Verdict>,
}

impl Study {
    /// Sets the finding with the contact in the equations of a claim of the source, if the claim's chapter was run.
    fn under_contact(&mut self, claim: &str, contact: String, survives: &'static str) {
        for verdict in self.verdicts.iter_mut().filter(|verdict| verdict.source.starts_with(claim)) {
            (verdict.contact, verdict.survives) = (contact.clone(), survives);
        }
    }

    /// Adds a figure to the page.
    fn figure(&mut self, name: &str, sheet: Sheet, caption: &str) {
        self.page.figure(name, caption);
        self.figures.push((name.to_owned(), sheet.finish()));
    }
}

type Chapter = fn(&mut Study) -> Outcome<()>;

fn main() -> Outcome<()> {
    let began = Instant::now();
    let mut study = Study {
        bench: Bench::start()?,
        page: Page::default(),
        figures: Vec::new(),
        maps: Vec::new(),
        verdicts: Vec::new(),
    };
    let chapters: [(&str, Chapter); 13] = [
        ("table2", table2::write),
        ("table3", table3::write),
        ("histories", histories::write),
        ("sensitivity", sensitivity::write),
        ("mechanisms", mechanisms::write),
        ("loss", loss::write),
        ("contact", contact::write),
        ("contact-histories", histories::write_contact),
        ("contact-ratio", best::write),
        ("contact-sensitivity", sensitivity::write_contact),
        ("guide", guide::write),
        ("rules", rules::write),
        ("differences", front::differences),
    ];
    let arguments = Arguments::of_process();
    for (name, write) in chapters {
        if !arguments.choose(name) {
            continue;
        }
        let began = Instant::now();
        write(&mut study)?;
        eprintln!("{name}: {:.1} s", began.elapsed().as_secs_f64());
    }
    front::cost(&mut study, began.elapsed().as_secs_f64());
    if !arguments.is_empty() {
        // Includes the sentences that no longer hold, to be read beside their numbers.
        println!("{}\n{}", front::beginning(&study.verdicts), study.page.draft());
    }
    let text = format!("{}\n{}", front::beginning(&study.verdicts), study.page.finish()?);
    std::fs::create_dir_all("docs/study")?;
    for (name, figure) in &study.figures {
        std::fs::write(format!("docs/study/{name}.svg"), figure)?;
    }
    if !arguments.is_empty() {
        return Ok(());
    }
    std::fs::write("docs/STUDY.md", text)?;
    println!(
        "docs/STUDY.md: {} jobs, {} points of sweeps, {:.0} s",
        study.bench.jobs,
        study.bench.points,
        began.elapsed().as_secs_f64()
    );
    Ok(())
}
