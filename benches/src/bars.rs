use std::collections::BTreeMap;

/// Beams of the benches that bars speak of, in tetrahedra, and the smallest and the largest one.
const SIZES: [usize; 2] = [12_288, 98_304];
const SMALLEST: usize = 1_536;
const LARGEST: usize = 1_001_472;

/// Iterations of an implicit step.
const ITERATIONS: f64 = 25.0;

/// What was measured, by the names of the benches.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Time of an element [s], and its share of the machine's peak in words.
    measured: BTreeMap<String, (f64, String)>,
}

impl Results {
    /// Adds a measurement: the time of an element [s], and its share of a peak in words.
    pub fn add(&mut self, name: String, seconds: f64, share: String) {
        self.measured.insert(name, (seconds, share));
    }

    fn seconds(&self, name: &str, precision: &str, elements: usize) -> Option<f64> {
        self.measured.get(&format!("{name}/{precision}/{elements}")).map(|(seconds, _)| *seconds)
    }

    /// The number that a share begins with [%].
    fn share(&self, name: &str, elements: usize) -> Option<f64> {
        let (_, share) = self.measured.get(&format!("{name}/f32/{elements}"))?;
        share.trim_start().split(' ').next()?.parse().ok()
    }

    /// Lines that set measurements against what is asked for, of those that were made.
    pub fn bars(&self) -> Vec<String> {
        let mut lines = Vec::new();
        for size in SIZES {
            let mut at_least = |name: &str, percent: f64| {
                let line = |share| bar(&format!("{name}, {size}"), share, percent, "% of peak", share >= percent);
                lines.extend(self.share(name, size).map(line));
            };
            at_least("substep/total-lagrangian/st-venant-kirchhoff", 33.0);
            at_least("substep/total-lagrangian/stable-neo-hookean", 25.0);
            at_least("product/corotational", 25.0);
            at_least("forces/tensor-mass", 50.0);
            let mut at_most = |name: String, value: Option<f64>, limit: f64, unit: &str| {
                lines.extend(value.map(|value| bar(&name, value, limit, unit, value <= limit)));
            };
            let iteration = self.seconds("implicit/corotational", "f32", size);
            let product = self.seconds("product/corotational", "f32", size);
            at_most(
                format!("implicit/corotational, {size}"),
                iteration.map(|t| t * ITERATIONS * 1e9),
                160.0,
                "ns a step",
            );
            let ratio = iteration.zip(product).map(|(iteration, product)| iteration / product);
            at_most(format!("implicit/corotational over its products, {size}"), ratio, 1.3, "times");
            for name in
                ["substep/total-lagrangian/st-venant-kirchhoff", "product/corotational", "implicit/corotational"]
            {
                let (single, double) = (self.seconds(name, "f32", size), self.seconds(name, "f64", size));
                let ratio = single.zip(double).map(|(single, double)| double / single);
                at_most(format!("{name}, f64 over f32, {size}"), ratio, 2.0, "times");
            }
            for name in ["substep/total-lagrangian/st-venant-kirchhoff", "implicit/corotational"] {
                let two = self.seconds(&format!("{name}/threads-2"), "f32", size);
                let gain = self.seconds(name, "f32", size).zip(two).map(|(one, two)| one / two);
                let line = |gain| bar(&format!("{name} on 2 threads, {size}"), gain, 1.8, "times", gain >= 1.8);
                lines.extend(gain.map(line));
            }
        }
        let name = "substep/total-lagrangian/st-venant-kirchhoff";
        let growth = self.seconds(name, "f32", SMALLEST).zip(self.seconds(name, "f32", LARGEST));
        let growth = growth.map(|(small, large)| large / small);
        lines.extend(
            growth.map(|growth| bar(&format!("{name}, growth to {LARGEST}"), growth, 1.5, "times", growth < 1.5)),
        );
        let removals = self.measured.iter().filter(|(name, _)| name.starts_with("removal/"));
        lines.extend(
            removals.map(|(name, (seconds, _))| bar(name, seconds * 1e9, 1000.0, "ns", seconds * 1e9 <= 1000.0)),
        );
        lines
    }
}

fn bar(name: &str, measured: f64, wanted: f64, unit: &str, holds: bool) -> String {
    let verdict = if holds { "holds" } else { "MISSED" };
    format!("{name:<72} {measured:9.2} for {wanted:7.1} {unit:<10} {verdict}")
}
