//! `viscera precompute`: responses of pre-computed bodies, kept in files.

use std::io::Write;
use std::path::PathBuf;

use indicatif::ProgressBar;
use viscera_io::write::write_atomically;

use crate::arguments::PrecomputeArguments;
use crate::built_in::OpenScene;
use crate::failure::Failure;
use crate::run::executor;
use crate::terminal;

pub(crate) fn precompute(arguments: &PrecomputeArguments) -> Result<(), Failure> {
    let (open, executor) = (OpenScene::open(&arguments.scene)?, executor(arguments.threads)?);
    let bar = ProgressBar::new(0);
    let progress = |body: &str, done: usize, of: usize| {
        bar.set_message(body.to_owned());
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    };
    let all = open.scene.precompute(&executor, &progress).map_err(Failure::scene)?;
    bar.finish_and_clear();
    if all.is_empty() {
        return Err(Failure::problem(format!(
            "no body of `{}` is of the model `precomputed`: there is nothing to do",
            open.name
        )));
    }
    for of in all {
        // A scene that names no file gets one that is named after the body, where a built-in scene can have it too.
        let path = of.file.clone().unwrap_or_else(|| PathBuf::from(format!("{}.responses", of.body)));
        let bytes = of.responses.to_bytes();
        write_atomically(&path, |file| file.write_all(&bytes)).map_err(Failure::input)?;
        let megabytes = bytes.len() as f64 / 1e6;
        terminal::say(&format!("{}: {megabytes:.1} MB in {}", of.body, path.display()));
        if of.file.is_none() {
            terminal::say(&format!(
                "  to use it: model = {{ kind = \"precomputed\", responses = \"{}\" }}",
                path.display()
            ));
        }
    }
    Ok(())
}
