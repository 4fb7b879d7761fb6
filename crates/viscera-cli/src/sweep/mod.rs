//! `viscera sweep`: a scene with many values of its parameters, as one table.

mod case;
mod table;

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::arguments::SweepArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal;
use case::{Row, cases};
use table::write;

pub(crate) fn sweep(arguments: &SweepArguments) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let open = OpenScene::open(&arguments.scene)?;
    open.file()?;
    let cases = cases(&arguments.vary)?;
    // A key that is wrong is wrong in every case: it is shown before any of them runs.
    if let Some(first) = cases.first() {
        first.change(&open.scene).and_then(|scene| scene.check()).map_err(Failure::scene)?;
    }
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}.csv", open.name)));
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| Failure::input(format!("{}: {error}", folder.display())))?;
    }
    let rows: Mutex<Vec<Option<Row>>> = Mutex::new(vec![None; cases.len()]);
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(None));
    let work = || {
        while !interrupt.is_asked() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(number) else { break };
            let Some(row) = case.run(&open.scene, &interrupt) else { break };
            if !arguments.quiet {
                terminal::complain(&format!("{} of {}: {}", number + 1, cases.len(), row.summary()));
            }
            // A row is written as soon as it is there: what is computed survives whatever comes.
            let mut rows = rows.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            rows[number] = Some(row);
            if let Err(error) = write(&path, &rows) {
                *failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(Failure::problem(error));
                break;
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..arguments.threads {
            scope.spawn(work);
        }
        work();
    });
    if let Some(failure) = failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(failure);
    }
    let done = rows.lock().unwrap_or_else(std::sync::PoisonError::into_inner).iter().flatten().count();
    if done < cases.len() {
        let left = format!("interrupted after {done} of {} cases; their rows are in {}", cases.len(), path.display());
        return Err(Failure::Interrupted(left));
    }
    terminal::say(&format!("{}: {done} cases", path.display()));
    Ok(())
}
