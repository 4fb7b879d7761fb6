//! The force between two samples of the simulation: what each extrapolation leaves of the force that tissue stepped in every
//! millisecond gives.

mod motion;

use viscera_haptics::{Contact, Extrapolation, LocalModel, Matrix, Sample};

use crate::plot::{Plot, Scale};
use crate::references::Vector;
use crate::report::{Table, brief};
use crate::{Report, Size, ValidationError};
use motion::{Felt, PERIOD};

/// From where on errors count: the channel has its samples, and the tissue swings with the hand [s].
const COUNTED_FROM: f64 = 0.2;
/// Offset of the hand that probes the stiffness [m].
const PROBE: f64 = 0.5e-3;

/// What was found.
pub struct Extrapolations {
    /// Tetrahedra.
    pub cells: usize,
    /// Largest force on the hand [N].
    pub largest: f64,
    /// Errors over the hand's way.
    pub rows: Vec<Row>,
    /// Largest error of each method on linear tissue that is at rest in every millisecond, over the largest force.
    pub at_rest: Vec<(Method, f64)>,
}

/// How the force goes on after a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// As it is.
    Hold,
    /// With time.
    Time,
    /// With position along the last way.
    Position,
    /// By a stiffness that is learnt from the samples.
    Learnt,
    /// By the stiffness of the tissue, found by moving the hand by half a millimetre.
    Probed,
}

/// What gives the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// The true force, at once: what is left is the extrapolation's error.
    Exact,
    /// The true force, one interval late, as simulations that compute all the time give it.
    Late,
    /// A simulation in implicit steps of the interval, one interval late.
    Coarse,
}

/// The error of a method.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What gave the samples.
    pub samples: Samples,
    /// From one sample to the next [ms].
    pub interval: u32,
    /// The method.
    pub method: Method,
    /// Root mean square of the error, over the largest force.
    pub rms: f64,
    /// Largest error, over the largest force.
    pub worst: f64,
}

impl Method {
    const ALL: [Self; 5] = [Self::Hold, Self::Time, Self::Position, Self::Learnt, Self::Probed];

    fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Time => "time",
            Self::Position => "position",
            Self::Learnt => "linearised, learnt",
            Self::Probed => "linearised, probed",
        }
    }

    fn model(self) -> LocalModel {
        let extrapolation = match self {
            Self::Hold => Extrapolation::Hold,
            Self::Time => Extrapolation::Time,
            Self::Position => Extrapolation::Position,
            Self::Learnt | Self::Probed => Extrapolation::Linearised,
        };
        LocalModel::new(extrapolation, 2.0, f64::INFINITY, 0.0)
    }
}

impl Samples {
    const ALL: [Self; 3] = [Self::Exact, Self::Late, Self::Coarse];

    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact, at once",
            Self::Late => "exact, one interval late",
            Self::Coarse => "of implicit steps of that interval, one interval late",
        }
    }
}

/// # Errors
/// [`ValidationError`] where a step fails.
pub fn study(size: Size) -> Result<Extrapolations, ValidationError> {
    let (intervals, duration): (&[u32], f64) =
        if size == Size::Full { (&[2, 4, 8, 16, 32], 3.0) } else { (&[8, 16, 32], 1.5) };
    let truth = Probed::new(size, 1, duration)?;
    let largest = truth.felt.largest();
    let mut rows = Vec::new();
    for samples in Samples::ALL {
        for &interval in intervals {
            let given = match samples {
                Samples::Coarse => &Probed::new(size, interval, duration)?,
                Samples::Exact | Samples::Late => &truth,
            };
            let late = if samples == Samples::Exact { 0 } else { interval as usize };
            for method in Method::ALL {
                let (rms, worst) = errors(method, &given.samples(interval, method), late, &truth.felt)?;
                rows.push(Row { samples, interval, method, rms: rms / largest, worst: worst / largest });
            }
        }
    }
    // Until shortly before the hand turns: there the last way is short, and the bound on how far a force goes on is met.
    let rest = motion::at_rest_along_a_line(size, if size == Size::Full { 240 } else { 160 })?;
    let mut at_rest = Vec::new();
    for method in [Method::Hold, Method::Time, Method::Position, Method::Learnt] {
        let samples = Probed { felt: rest.clone(), offset: Vec::new(), step: 1 }.samples(16, method);
        at_rest.push((method, errors_from(0.04, method, &samples, 0, &rest)?.1 / rest.largest()));
    }
    Ok(Extrapolations { cells: motion::cells(size)?, largest, rows, at_rest })
}

/// A simulation, and three of a hand that is off by a little along each axis.
struct Probed {
    felt: Felt,
    offset: Vec<Felt>,
    /// Length of its steps [ms].
    step: u32,
}

impl Probed {
    fn new(size: Size, step: u32, duration: f64) -> Result<Self, ValidationError> {
        let axes = [Vector::new(PROBE, 0.0, 0.0), Vector::new(0.0, PROBE, 0.0), Vector::new(0.0, 0.0, PROBE)];
        let felt = motion::stepped(size, step, duration, Vector::ZERO)?;
        let offset = axes.map(|offset| motion::stepped(size, step, duration, offset)).into_iter();
        Ok(Self { felt, offset: offset.collect::<Result<_, _>>()?, step })
    }

    /// Samples every so many milliseconds, with the stiffness where the method wants it.
    fn samples(&self, interval: u32, method: Method) -> Vec<Sample> {
        let every = (interval / self.step) as usize;
        let numbers = (every - 1..self.felt.moments.len()).step_by(every);
        let sample = |number: usize| {
            let moment = self.felt.moments[number];
            let fall = |axis: usize| (moment.force - self.offset[axis].moments[number].force) / PROBE;
            Sample {
                time: moment.time,
                position: moment.tip,
                force: moment.force,
                stiffness: (method == Method::Probed).then(|| Matrix::from_columns(fall(0), fall(1), fall(2))),
                contact: Contact::Holding,
            }
        };
        numbers.map(sample).collect()
    }
}

/// Root mean square and maximum of the error [N], where samples come so many milliseconds `late`.
fn errors(method: Method, samples: &[Sample], late: usize, truth: &Felt) -> Result<(f64, f64), ValidationError> {
    errors_from(COUNTED_FROM, method, samples, late, truth)
}

fn errors_from(
    from: f64,
    method: Method,
    samples: &[Sample],
    late: usize,
    truth: &Felt,
) -> Result<(f64, f64), ValidationError> {
    let (mut model, mut coming) = (method.model(), samples.iter().peekable());
    let (mut squares, mut worst, mut count) = (0.0, 0.0_f64, 0);
    for moment in &truth.moments {
        // Half a period for rounding: samples lie on the periods.
        let due = moment.time - late as f64 * PERIOD + 0.5 * PERIOD;
        while let Some(sample) = coming.next_if(|sample| sample.time <= due) {
            model.push(*sample)?;
        }
        if let Some(force) = model.force(moment.time, moment.tip).filter(|_| moment.time > from) {
            let error = (force - moment.force).norm();
            squares += error * error;
            worst = worst.max(error);
            count += 1;
        }
    }
    Ok(((squares / f64::from(count.max(1))).sqrt(), worst))
}

impl Extrapolations {
    /// The rows of a kind of samples and a method, with rising intervals.
    pub fn of(&self, samples: Samples, method: Method) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.samples == samples && row.method == method)
    }

    /// By which power of the interval the error grows, over the whole range.
    pub fn order(&self, samples: Samples, method: Method) -> f64 {
        let rows: Vec<&Row> = self.of(samples, method).collect();
        match (rows.first(), rows.last()) {
            (Some(first), Some(last)) => {
                (last.rms / first.rms).ln() / (f64::from(last.interval) / f64::from(first.interval)).ln()
            }
            _ => f64::NAN,
        }
    }

    /// The page.
    pub fn report(&self) -> Report {
        let mut report = Report::new("The force between two samples").text(format!(
            "A liver of 30 cm in {} tetrahedra (3 kPa, Poisson ratio 0.4, St Venant–Kirchhoff), held at its back; a hand holds the edge \
             of its left lobe with a grasper and moves it on a bent way of some 3 cm, up to 0.15 m/s. Stepped in full, 1000 times a \
             second, it says what the hand should feel: up to {} N. A channel that has a sample every so many milliseconds makes \
             up the force in between. Errors are root mean squares over the largest force, in percent; the order is the power of the interval \
             by which they grow over the whole range.",
            self.cells,
            brief(self.largest)
        ));
        report = report.text(
            "What is probed is the stiffness of tissue that has come to rest with the hand; a hand that moves feels inertia and damping as \
             well. Along the way of the hand the samples have them in them, and what is learnt or probed says what they say; across it, what is \
             learnt says what it did before, and what is probed the stiffness at rest.",
        );
        for (samples, name) in [(Samples::Exact, "exact"), (Samples::Late, "late"), (Samples::Coarse, "coarse")] {
            let intervals: Vec<u32> = self.of(samples, Method::Hold).map(|row| row.interval).collect();
            let mut head = vec!["method".to_owned()];
            head.extend(intervals.iter().map(|interval| format!("{interval} ms")));
            head.push("order".into());
            head.extend(intervals.last().map(|interval| format!("worst at {interval} ms")));
            let mut table = Table::new(name, &head.iter().map(String::as_str).collect::<Vec<_>>());
            let mut plot = Plot {
                name,
                title: format!("Samples {}", samples.name()),
                x: "interval [ms]",
                y: "error [%]",
                scale: Scale::Logarithmic,
                curves: Vec::new(),
            };
            for method in Method::ALL {
                let mut row = vec![method.name().to_owned()];
                row.extend(self.of(samples, method).map(|row| brief(100.0 * row.rms)));
                row.push(format!("{:.2}", self.order(samples, method)));
                row.extend(self.of(samples, method).last().map(|row| brief(100.0 * row.worst)));
                table.push(row);
                let points = self.of(samples, method).map(|row| (f64::from(row.interval), 100.0 * row.rms));
                plot.curve(method.name(), points.collect());
            }
            report = report.text(format!("## Samples {}", samples.name())).table(table).plot(plot);
        }
        let mut table = Table::new("at-rest", &["method", "largest error"]);
        for (method, error) in &self.at_rest {
            table.push(vec![method.name().into(), format!("{error:.1e}")]);
        }
        report
            .text(
                "## Linear tissue, at rest in every millisecond\n\nMoved to and fro along a line, 2 cm in a second, and brought to rest in every millisecond; samples every 16 ms. What follows the position is exact there but for \
                 rounding, as long as it has not to go on for more than twice the last way, at the turn of the hand.",
            )
            .table(table)
    }
}
