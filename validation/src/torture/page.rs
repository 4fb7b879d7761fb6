//! The page of the suite.

use viscera::model::ModelKind;

use super::elements::DEFORMATIONS;
use super::ranges::{RangeTally, Undone};
use super::release::{DAMPING, Extent, STEP};
use super::{Combination, Cuts, ElementTally, End, Method, Obstacle, Outcome, Shape, Torture, Trial, ranges, sameness};
use crate::Report;
use crate::report::{Table, brief};
use crate::setting::Cells;

/// Some numbers in words.
fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|&number| plain(number)).collect::<Vec<_>>().join(", ")
}

/// A number as it is chosen, with no digits that were not.
fn plain(number: f64) -> String {
    if number == 0.0 || (1e-4..1e6).contains(&number.abs()) { number.to_string() } else { format!("{number:e}") }
}

impl Torture {
    /// The page.
    pub fn report(&self) -> Report {
        let every = Extent::of(self.size).every;
        let cases = if every == 1 { "every case".into() } else { format!("one case in {every}") };
        let resting: Vec<&str> =
            ModelKind::ALL.iter().map(|model| model.info()).filter(|info| !info.moves).map(|info| info.name).collect();
        let report = Report::new("Torture").text(format!(
            "Every force model of every law on tetrahedra and hexahedra, with every integrator, in shapes, scales, units and cuts \
             that nothing should survive. Nothing panics, no number that is none comes through, and what cannot be done is undone \
             by an error that says what to do instead. In double precision unless it says otherwise. {} Of the shapes {cases} \
             is tried. Bodies that do not move in time are asked what they compute, and have no steps to be tortured in: {}.",
            self.size.sentence(),
            resting.join(", ")
        ));
        let report = self.refused(report);
        let report = self.released(report);
        let report = self.over_ranges(report);
        let report = self.told_differently(report);
        self.single_elements(self.cut(report))
    }

    fn refused(&self, report: Report) -> Report {
        let mut table = Table::new("refusals", &["why", "combinations", "for example"]);
        let mut reasons: Vec<&str> = self.refusals.iter().filter_map(|refusal| refusal.why).collect();
        reasons.sort_unstable();
        reasons.dedup();
        for why in reasons {
            let of: Vec<_> = self.refusals.iter().filter(|refusal| refusal.why == Some(why)).collect();
            let example =
                of.first().map_or(String::new(), |first| format!("{}; {}", first.combination.name(), first.method));
            table.push(vec![why.into(), of.len().to_string(), example]);
        }
        let computed = self.refusals.iter().filter(|refusal| refusal.why.is_none()).count();
        report
            .text(format!(
                "## What is computed\n\nOf {} combinations of model, law, cells and integrator {computed} are computed; the rest is \
                 refused when the body is added, by an error of a type made for that.",
                self.refusals.len()
            ))
            .table(table)
    }

    fn released(&self, report: Report) -> Report {
        let mut methods = Table::new(
            "integrators",
            &[
                "integrator",
                "tried",
                "back",
                "must come back",
                "do",
                "in another shape that holds",
                "with steps not solved",
                "undone",
                "no numbers",
                "panics",
                "largest gain",
                "peak",
                "gain without a potential",
            ],
        );
        for method in Method::all() {
            let of: Vec<&Trial> = self.trials.iter().filter(|trial| trial.case.method == method).collect();
            let count = |good: &dyn Fn(&Trial) -> bool| of.iter().filter(|trial| good(trial)).count().to_string();
            let refused = |trial: &Trial| matches!(trial.outcome, Outcome::Refused(_));
            let has_to = |trial: &Trial| !refused(trial) && trial.case.obstacle().is_none() && !trial.holds_elsewhere();
            let (conserving, others): (Vec<&Trial>, _) =
                of.iter().copied().partition(|trial| trial.case.combination.has_energy());
            let most = |trials: &[&Trial], number: fn(&Trial) -> f64| {
                trials.iter().map(|trial| number(trial)).fold(0.0, f64::max)
            };
            methods.push(vec![
                method.name.into(),
                count(&|trial| !refused(trial)),
                count(&|trial| trial.outcome == Outcome::Back),
                count(&has_to),
                count(&|trial| has_to(trial) && trial.outcome == Outcome::Back),
                count(&|trial| trial.holds_elsewhere()),
                count(&|trial| trial.unsolved > 0),
                count(&|trial| matches!(trial.outcome, Outcome::Undone(_))),
                count(&|trial| trial.outcome == Outcome::NotANumber),
                count(&|trial| trial.outcome == Outcome::Panicked),
                brief(most(&conserving, |trial| trial.gain)),
                brief(most(&conserving, |trial| trial.peak)),
                brief(most(&others, |trial| trial.gain)),
            ]);
        }
        let mut all = Table::new(
            "released",
            &[
                "model and law",
                "integrator",
                "shape",
                "held",
                "outcome",
                "why",
                "steps",
                "not solved",
                "disturbed",
                "deviation",
                "gain",
                "peak",
            ],
        );
        for trial in &self.trials {
            let (case, why) = (&trial.case, trial.why());
            all.push(vec![
                case.combination.name(),
                case.method.name.into(),
                case.shape.name().into(),
                if case.held { "yes" } else { "no" }.into(),
                trial.outcome.name().into(),
                why.into(),
                trial.steps.to_string(),
                trial.unsolved.to_string(),
                trial.disturbances.to_string(),
                brief(trial.deviation),
                brief(trial.gain),
                brief(trial.peak),
            ]);
        }
        let Extent { cells, steps: [_, steps], .. } = Extent::of(self.size);
        let [tetrahedra, hexahedra] =
            [Cells::Six, Cells::Hexahedra].map(|kind| kind.fill(cells, [1.0; 3]).cell_count());
        let step = brief(1e3 * STEP);
        report
            .text(format!(
                "## Released from impossible shapes\n\nA cube of 10 cm, {tetrahedra} tetrahedra or {hexahedra} hexahedra, E = 10 kPa, \
                 ν = 0.4, damped at {DAMPING} 1/s; {steps} steps of {step} ms, or until it is at rest. One side is held where it rests, or \
                 none. Its vertices are put at random \
                 places in a box twice as large; all in one point, on a line, in a plane; mirrored; stretched 1000 times; one \
                 vertex out through the opposite side. It is back when no distance within a cell differs from that at rest by \
                 more than a millionth of the size, and no cell is inverted. Gain: the largest in a step, and peak: the largest \
                 energy at all, both of the energy at the start, where the forces have a potential; where they have none, or it jumps, \
                 any step may gain. A step is not solved where its report says so: linearised, its linear system; in full, forces without a potential may have no balance to be found, and \
                 the step is linearised.",
            ))
            .table(methods)
            .text(
                "Which shapes come back, in explicit steps and in those of backward Euler, linearised and in full; held and free. \
                 M: cannot, the law is blind to reflections (take `stable-neo-hookean`, `neo-hookean`, or the model \
                 `corotational`). S: cannot by symmetry, no direction out of a point or a line is better than another. T: takes \
                 rotations for strain, and comes to rest turned. W: nodes that remember their place may have it in a twist. Where nothing of this is in the way: A, at rest in another shape that holds, \
                 whose energy is least there too: disturbed by a thousandth of the size and let go in explicit steps, it comes back to itself (take the model \
                 `corotational` on tetrahedra, which leaves all of these shapes). Where it does not, the energy is only stationary there, and long implicit \
                 steps hold tissue in such a place: it is disturbed as much and goes on; D, back after that; E, at rest in another \
                 shape all the same; I, the same with inverted cells. +, not at rest yet; U, a step was undone.",
            )
            .table(self.shapes())
            .data(all)
    }

    fn shapes(&self) -> Table {
        let heads: Vec<String> = Shape::ALL.iter().flat_map(|shape| [shape.name().to_owned(), "free".into()]).collect();
        let head: Vec<&str> = std::iter::once("model and law").chain(heads.iter().map(String::as_str)).collect();
        let mut table = Table::new("shapes", &head);
        for combination in Combination::able() {
            let mut row = vec![combination.name()];
            for shape in Shape::ALL {
                for held in [true, false] {
                    let of = |trial: &&Trial| {
                        let case = &trial.case;
                        let method =
                            case.method.never_gains() || case.method.stays_bounded() || case.method == Method::EXPLICIT;
                        case.combination == combination && case.shape == shape && case.held == held && method
                    };
                    row.push(self.trials.iter().filter(of).map(Trial::letter).collect::<Vec<_>>().join(" "));
                }
            }
            table.push(row);
        }
        table
    }

    fn over_ranges(&self, report: Report) -> Report {
        let heads = [
            &["integrator", "settings", "all steps made", "some not solved"][..],
            &ranges::KINDS,
            &["no numbers", "panics", "largest gain"],
        ];
        let mut table = Table::new("ranges", &heads.concat());
        for method in Method::all() {
            let of: Vec<_> =
                self.ranges.iter().filter(|tally| tally.method == method && tally.refused.is_none()).collect();
            let sum =
                |number: &dyn Fn(&RangeTally) -> u32| of.iter().map(|tally| number(tally)).sum::<u32>().to_string();
            let conserving = of.iter().filter(|tally| tally.combination.has_energy());
            let mut row = vec![method.name.into()];
            row.extend([sum(&|tally| tally.tried), sum(&|tally| tally.made), sum(&|tally| tally.unsolved)]);
            row.extend(ranges::KINDS.map(|kind| sum(&|tally| tally.undone_as(kind).count() as u32)));
            row.extend([
                sum(&|tally| tally.not_numbers),
                sum(&|tally| tally.panics),
                brief(conserving.map(|tally| tally.gain).fold(0.0, f64::max)),
            ]);
            table.push(row);
        }
        let [youngs, poissons, steps] = ranges::grids(self.size);
        let besides = ranges::besides(self.size).map_or(String::new(), |[young, poisson, step]| {
            format!("; and E = {} Pa with ν = {} and {} s", plain(young), plain(poisson), plain(step))
        });
        report
            .text(format!(
                "## Every stiffness, step and unit\n\nThe cube, held on one side and undamped, falls under its weight for {} steps. E in \
                 Pa: {}; ν: {}; steps in s: {}; each with each, in metres and in millimetres{besides}. Its own weight is a \
                 kilopascal. Gain: of all energies that are about, gravity's included.",
                ranges::STEPS,
                listed(youngs),
                listed(poissons),
                listed(steps)
            ))
            .table(table)
            .text("Which settings are undone, how many of them, and over which of these numbers they are spread:")
            .table(self.undone_over_ranges())
    }

    fn undone_over_ranges(&self) -> Table {
        let mut table = Table::new(
            "ranges-undone",
            &["model and law", "integrator", "what is said", "settings", "E [Pa]", "ν", "step [s]"],
        );
        for tally in self.ranges.iter().filter(|tally| tally.refused.is_none()) {
            for kind in ranges::KINDS {
                let there: Vec<_> = tally.undone_as(kind).collect();
                if there.is_empty() {
                    continue;
                }
                let spread = |number: fn(&Undone) -> f64| {
                    let mut numbers: Vec<f64> = there.iter().map(|undone| number(undone)).collect();
                    numbers.sort_by(f64::total_cmp);
                    numbers.dedup();
                    listed(&numbers)
                };
                table.push(vec![
                    tally.combination.name(),
                    tally.method.name.into(),
                    kind.into(),
                    there.len().to_string(),
                    spread(|undone| undone.young),
                    spread(|undone| undone.poisson),
                    spread(|undone| undone.step),
                ]);
            }
        }
        table
    }

    fn told_differently(&self, report: Report) -> Report {
        let mut table = Table::new(
            "sameness",
            &["model and law", "integrator", "displacement", "millimetres", "turned", "renumbered"],
        );
        for row in &self.sameness {
            table.push(vec![
                row.combination.name(),
                row.method.into(),
                brief(row.displacement),
                brief(row.units),
                row.turned.map_or("–".into(), brief),
                brief(row.renumbered),
            ]);
        }
        report
            .text(format!(
                "## The same motion told differently\n\nA bar bends under its weight for {} s: in millimetres, turned and shifted \
                 in {} ways, with nodes and cells in random order. Largest difference, of the largest displacement (which \
                 is given over the size). –: the law takes rotations for strain.",
                plain(sameness::TIME),
                sameness::turns(self.size)
            ))
            .table(table)
    }

    fn cut(&self, report: Report) -> Report {
        let table = |name, cuts: &[Cuts]| {
            let mut table = Table::new(
                name,
                &[
                    "model and law",
                    "integrators",
                    "cuts",
                    "steps made",
                    "undone",
                    "down to nothing",
                    "left over",
                    "panics",
                ],
            );
            for combination in Combination::able() {
                let of: Vec<_> = cuts
                    .iter()
                    .filter(|cuts| cuts.combination == combination && !matches!(cuts.end, End::Refused(_)))
                    .collect();
                let ended = |end| of.iter().filter(|cuts| cuts.end == end).count().to_string();
                table.push(vec![
                    combination.name(),
                    of.len().to_string(),
                    of.iter().map(|cuts| cuts.cuts).sum::<usize>().to_string(),
                    of.iter().map(|cuts| cuts.steps).sum::<u32>().to_string(),
                    of.iter().map(|cuts| cuts.undone).sum::<u32>().to_string(),
                    ended(End::Nothing),
                    ended(End::Leftover),
                    ended(End::Panicked),
                ]);
            }
            table
        };
        let cut = |hexahedra: bool| {
            let of =
                self.cuts_to_nothing.iter().filter(|cuts| (cuts.combination.cells == Cells::Hexahedra) == hexahedra);
            let cells = of.map(|cuts| cuts.cuts).max().unwrap_or(0);
            format!("{cells} {}", if hexahedra { "hexahedra" } else { "tetrahedra" })
        };
        report
            .text("## Cut while inside out\n\nThe mirrored cube, held on one side, loses a cell before each step until none is left.")
            .table(table("cut-inverted", &self.inverted_cuts))
            .text(format!(
                "## Cut down to nothing\n\nA held cube of {} under its weight loses them one by one, at random, with an \
                 explicit step now and then. Nothing of mass, volume or energy is left in the end, and the world goes on.",
                [false, true].map(cut).join(" or ")
            ))
            .table(table("cut-to-nothing", &self.cuts_to_nothing))
    }

    fn single_elements(&self, report: Report) -> Report {
        let mut table = Table::new(
            "elements",
            &[
                "model and law",
                "precision",
                "tried",
                "refused as flat",
                "in range",
                "broken in range",
                "beyond range",
                "panics",
            ],
        );
        for tally in &self.elements {
            let ElementTally { combination, single, tried, refused, in_range, broken, overflown, panics, .. } = tally;
            table.push(vec![
                combination.name(),
                if *single { "single" } else { "double" }.into(),
                tried.to_string(),
                refused.to_string(),
                in_range.to_string(),
                broken.to_string(),
                overflown.to_string(),
                panics.to_string(),
            ]);
        }
        let tried: u64 = self.elements.iter().map(|tally| tally.tried).sum();
        report
            .text(format!(
                "## Single elements\n\n{} elements in {} deformations each, {tried} in all, slivers among them, of sizes down to denormal \
                 numbers and up to the largest that there are, put in points, lines, planes, mirrors and random shapes: forces, products and energy. Broken: a \
                 number that is none or infinite although every power of the deformation that the law takes is within the range of \
                 the precision. Beyond that range numbers overflow, and steps that would are undone.",
                tried / DEFORMATIONS as u64,
                DEFORMATIONS
            ))
            .table(table)
    }
}

impl Trial {
    /// Whether it is at rest in another shape that nothing but force leads out of.
    fn holds_elsewhere(&self) -> bool {
        matches!(self.outcome, Outcome::Elsewhere { is_steady: true, .. })
    }

    fn why(&self) -> &'static str {
        match (&self.outcome, self.case.obstacle()) {
            (Outcome::Refused(why) | Outcome::Undone(why), _) => why,
            (Outcome::Back, _) => "",
            (Outcome::Elsewhere { is_steady: true, .. }, None) => {
                "holds in another shape: take the model corotational on tetrahedra"
            }
            (_, None) => "",
            (_, Some(Obstacle::Mirror)) => "blind to reflections: take stable-neo-hookean",
            (_, Some(Obstacle::Symmetry)) => "no direction is better than another",
            (_, Some(Obstacle::Turned)) => "takes rotations for strain",
            (_, Some(Obstacle::Twist)) => "its places are found in a twist too",
        }
    }

    fn letter(&self) -> &'static str {
        match (&self.outcome, self.case.obstacle()) {
            (Outcome::Back, _) if self.disturbances > 0 => "D",
            (Outcome::Back, _) => "✓",
            (Outcome::Refused(_), _) => "–",
            (Outcome::Undone(_), _) => "U",
            (Outcome::NotANumber | Outcome::Panicked, _) => "!",
            (_, Some(Obstacle::Mirror)) => "M",
            (_, Some(Obstacle::Symmetry)) => "S",
            (_, Some(Obstacle::Turned)) => "T",
            (_, Some(Obstacle::Twist)) => "W",
            (Outcome::Elsewhere { is_steady: true, .. }, None) => "A",
            (Outcome::Elsewhere { inverted: 0, .. }, None) => "E",
            (Outcome::Elsewhere { .. }, None) => "I",
            (Outcome::Moving, None) => "+",
        }
    }
}
