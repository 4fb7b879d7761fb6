//! `viscera bench capacity`.

use std::num::NonZero;
use std::thread::available_parallelism;
use std::time::Instant;

use viscera::executor::Executor;
use viscera_io::grouped;

use super::arguments::CapacityArguments;
use super::organ::{Care, Measured, Pace, Sizing};
use super::search::{Found, largest};
use crate::failure::Failure;
use crate::instruction_set::instruction_set;
use crate::tables::{table, table_text};
use crate::terminal::{heading, say};
use crate::units::with_prefix;

pub(super) fn capacity(arguments: &CapacityArguments) -> Result<(), Failure> {
    let (care, tolerance, duration) = match arguments.quick {
        true => (Care { windows: 3, window: 0.1 }, 0.1, "about three minutes"),
        false => (Care { windows: 7, window: 0.3 }, 0.02, "some six minutes"),
    };
    let cores = available_parallelism().map_or(1, NonZero::get);
    say(&format!(
        "the largest liver that is moved in real time, to {:.0} %; this takes {duration}, on a machine that does nothing else\n",
        100.0 * tolerance
    ));
    let begin = Instant::now();
    let mut table = table(&[
        "in a second",
        "cores",
        "tetrahedra",
        "nodes",
        "edge",
        "sub-steps",
        "ms per step",
        "ns per tetrahedron",
    ]);
    let mut sizing = Sizing::default();
    let all = (cores > 1).then_some(cores);
    for pace in Pace::ALL {
        for threads in std::iter::once(1).chain(all) {
            let executor = Executor::threads(threads).map_err(Failure::problem)?;
            let found = largest(pace.step(), tolerance, |cells| pace.measure(cells, &executor, care, &mut sizing))?;
            table.add_row(row(pace, threads, found));
        }
    }
    let settings: Vec<_> = Pace::ALL.iter().map(|pace| pace.settings()).collect();
    say(&format!(
        "{}\n\n{}\n{}\nmachine: {cores} cores, {}\nmeasured in {:.0} s",
        table_text(&table),
        heading("settings"),
        settings.join("\n"),
        instruction_set(),
        begin.elapsed().as_secs_f64()
    ));
    Ok(())
}

fn row(pace: Pace, threads: usize, found: Found) -> [String; 8] {
    let (sign, measured) = match found {
        Found::Largest(measured) => ("", measured),
        Found::AtLeast(measured) => ("≥ ", measured),
        Found::Less(measured) => ("< ", measured),
    };
    let Measured { cells, nodes, edge, time, substeps } = measured;
    [
        pace.name().to_owned(),
        threads.to_string(),
        format!("{sign}{}", grouped(cells)),
        grouped(nodes),
        with_prefix(edge, "m"),
        format!("{substeps:.1}"),
        format!("{:.3}", 1e3 * time),
        format!("{:.2}", 1e9 * time / cells as f64),
    ]
}
