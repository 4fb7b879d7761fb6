/// How an equilibrium was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticReport {
    /// The load steps that succeeded.
    pub steps: Vec<LoadStep>,
    /// How many shares of the load failed and were halved.
    pub retries: usize,
}

/// One step of the load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    /// Share of the load at its end, from 0 to 1.
    pub share: f64,
    /// Residuals, relative to loads and reactions: before each iteration and after the last.
    pub residuals: Vec<f64>,
}

impl StaticReport {
    /// Newton iterations of all steps that succeeded.
    pub fn iterations(&self) -> usize {
        self.steps.iter().map(|step| step.residuals.len() - 1).sum()
    }
}
