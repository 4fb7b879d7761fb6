use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::solver::{LinearSolver, Stop};
use viscera::world::{Integrator, Substep};

use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{
    FullNewtonFile, IntegratorFile, IntegratorName, LinearFile, MatrixFile, NewtonFile, NewtonName, PreconditionerFile,
    SceneFile, SolverFile, SubstepFile,
};

/// Iterations of the linear solver where the scene gives a tolerance alone.
const MOST_ITERATIONS: u32 = 2000;

/// The integrator of the scene, each of its settings known to it.
pub(super) fn integrator(file: &SceneFile, root: &Site) -> Result<Integrator, SceneErrors> {
    let settings = &file.integrator;
    let site = root.key("integrator");
    if settings.kind != IntegratorName::QuasiStatic {
        only(&site, [("solver", settings.solver.is_some())], "`quasi-static`")?;
    }
    if settings.kind != IntegratorName::Newmark {
        only(&site, [("beta", settings.beta.is_some()), ("gamma", settings.gamma.is_some())], "`newmark`")?;
    }
    let implicit_ones = "`backward-euler`, `newmark`, `bdf2`, `energy-momentum`";
    let of_systems = [
        ("linear", settings.linear.is_some()),
        ("matrix", settings.matrix.is_some()),
        ("preconditioner", settings.preconditioner.is_some()),
    ];
    if settings.kind == IntegratorName::Explicit {
        only(&site, [("newton", settings.newton.is_some())], &format!("{implicit_ones}, `quasi-static`"))?;
    } else if let SubstepFile::Fixed(_) = file.substep {
        let message = "`substep` is a setting of the integrator `explicit`";
        return Err(root
            .key("substep")
            .error(message, "the others make each step at once: set `step`, leave this out"));
    }
    let scheme = match settings.kind {
        IntegratorName::Explicit => {
            only(&site, of_systems, implicit_ones)?;
            return Ok(Integrator::Explicit(match file.substep {
                SubstepFile::Automatic(_) => Substep::Automatic,
                SubstepFile::Fixed(time) => Substep::Fixed(time.0),
            }));
        }
        IntegratorName::QuasiStatic => {
            only(&site, of_systems, implicit_ones)?;
            return Ok(Integrator::QuasiStatic(quasi_static(settings.newton)));
        }
        IntegratorName::BackwardEuler => Scheme::BackwardEuler,
        IntegratorName::Newmark => newmark(settings),
        IntegratorName::Bdf2 => Scheme::Bdf2,
        IntegratorName::EnergyMomentum => Scheme::EnergyMomentum,
    };
    implicit(settings, scheme, &site).map(Integrator::Implicit)
}

/// Refuses keys that are given and belong to something else.
fn only<const N: usize>(site: &Site, keys: [(&str, bool); N], owner: &str) -> Result<(), SceneErrors> {
    match keys.into_iter().find(|(_, given)| *given) {
        Some((key, _)) => Err(site
            .key(key)
            .error(format!("`{key}` is a setting of {owner}"), "take such an integrator, or leave it out")),
        None => Ok(()),
    }
}

fn newmark(file: &IntegratorFile) -> Scheme {
    Scheme::Newmark { beta: file.beta.unwrap_or(0.25), gamma: file.gamma.unwrap_or(0.5) }
}

fn quasi_static(newton: Option<NewtonFile>) -> QuasiStatic {
    match newton {
        None | Some(NewtonFile::Named(NewtonName::Full)) => QuasiStatic::default(),
        Some(NewtonFile::Named(NewtonName::Linearised)) => QuasiStatic { small_strain: true, ..QuasiStatic::default() },
        Some(NewtonFile::Full(FullNewtonFile { tolerance, iterations })) => {
            QuasiStatic { tolerance, iterations: iterations as usize, ..QuasiStatic::default() }
        }
    }
}

/// What solves the equilibria of the scene, where it is not the world's own solver.
pub(super) fn static_solver(file: &IntegratorFile) -> Option<Box<dyn LinearSolver>> {
    (file.solver == Some(SolverFile::Direct)).then(factorisation)
}

#[cfg(feature = "direct")]
fn factorisation() -> Box<dyn LinearSolver> {
    Box::new(viscera_direct::Cholesky::default())
}

/// The engine's own, where the sparse one would be too much to compile and to load: the same answer to rounding, slower beyond some
/// ten thousand unknowns.
#[cfg(not(feature = "direct"))]
fn factorisation() -> Box<dyn LinearSolver> {
    Box::new(viscera::solver::Envelope::default())
}

fn implicit(file: &IntegratorFile, scheme: Scheme, site: &Site) -> Result<Implicit, SceneErrors> {
    let linearised = match file.newton {
        None => scheme == Scheme::BackwardEuler,
        Some(newton) => newton == NewtonFile::Named(NewtonName::Linearised),
    };
    if linearised && scheme == Scheme::EnergyMomentum {
        let message = "`energy-momentum` keeps no energy where its steps are linearised";
        return Err(site.key("newton").error(message, "take \"full\", or another integrator"));
    }
    let mut settings = match linearised {
        true => Implicit { scheme, ..Implicit::default() },
        false => Implicit::accurate(scheme),
    };
    if let Some(NewtonFile::Full(full)) = file.newton {
        settings.newton = Newton::Full { relative: full.tolerance, at_most: full.iterations };
    }
    settings.linear = match file.linear {
        None => settings.linear,
        Some(LinearFile { tolerance: Some(relative), iterations }) => {
            Stop::Tolerance { relative, at_most: iterations.unwrap_or(MOST_ITERATIONS) }
        }
        Some(LinearFile { tolerance: None, iterations: Some(iterations) }) => Stop::Iterations(iterations),
        Some(LinearFile { tolerance: None, iterations: None }) => {
            let help = "give `iterations` for a fixed number, `tolerance` for as many as it takes, or both";
            return Err(site.key("linear").error("the linear solver has no end", help));
        }
    };
    settings.matrix = match file.matrix {
        None | Some(MatrixFile::MatrixFree) => MatrixForm::Free,
        Some(MatrixFile::Assembled) => MatrixForm::Assembled,
    };
    settings.preconditioner = match file.preconditioner {
        None | Some(PreconditionerFile::BlockJacobi) => Preconditioning::BlockJacobi,
        Some(PreconditionerFile::Multigrid) => Preconditioning::Multigrid,
    };
    Ok(settings)
}
