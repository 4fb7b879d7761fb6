//! What an experiment found, ready to be shown.

use viscera_io::picture::Image;
use viscera_validation::plot::Plot;
use viscera_validation::{Block, Report as StudyPage, Table};

use crate::{Amount, Relation};

/// The part of the report that is one experiment's.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// A sentence or two on what is shown.
    pub shown: String,
    /// Names and values of what was chosen.
    pub settings: Vec<(&'static str, String)>,
    /// Published values and ours.
    pub comparisons: Vec<Comparison>,
    /// What has to hold.
    pub relations: Vec<Relation>,
    /// The rest, from top to bottom.
    pub parts: Vec<Part>,
    /// What is missing to run it, where something is: then the rest is empty.
    pub missing: Option<String>,
}

/// A quantity as published and as found here.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What is compared.
    pub quantity: String,
    /// As published.
    pub published: Amount,
    /// As found here.
    pub ours: Amount,
    /// Why the two differ; empty where they do not.
    pub why: String,
}

/// Something to read or to look at.
#[derive(Clone, Debug)]
pub enum Part {
    /// A paragraph.
    Text(String),
    /// A table, with the line above it.
    Table(String, Table),
    /// Curves.
    Plot(Plot),
    /// Pictures beside each other.
    Pictures(Vec<Photograph>),
}

/// A picture, the name of its file, and the line below it.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// Name of the file, without the ending.
    pub name: String,
    /// What is seen.
    pub caption: String,
    /// The picture.
    pub image: Image,
}

impl Section {
    /// A section that shows this.
    pub fn new(shown: impl Into<String>) -> Self {
        Self { shown: shown.into(), ..Self::default() }
    }

    /// A section that cannot be filled, and what it takes.
    pub fn missing(shown: impl Into<String>, what: impl Into<String>) -> Self {
        Self { missing: Some(what.into()), ..Self::new(shown) }
    }

    /// Adds a setting.
    pub fn setting(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.settings.push((name, value.into()));
        self
    }

    /// Adds a comparison of two numbers in `unit`.
    pub fn compare(
        self,
        quantity: impl Into<String>,
        unit: &'static str,
        [published, ours]: [f64; 2],
        why: impl Into<String>,
    ) -> Self {
        self.compare_amounts(quantity, [published, ours].map(|value| Amount::number(value, unit)), why)
    }

    /// Adds a comparison of what a paper says or shows with what was found.
    pub fn compare_words(
        self,
        quantity: impl Into<String>,
        [published, ours]: [&str; 2],
        why: impl Into<String>,
    ) -> Self {
        self.compare_amounts(quantity, [published, ours].map(|words| Amount::Words(words.into())), why)
    }

    fn compare_amounts(
        mut self,
        quantity: impl Into<String>,
        [published, ours]: [Amount; 2],
        why: impl Into<String>,
    ) -> Self {
        self.comparisons.push(Comparison { quantity: quantity.into(), published, ours, why: why.into() });
        self
    }

    /// Adds what has to hold.
    pub fn relation(mut self, relation: Relation) -> Self {
        self.relations.push(relation);
        self
    }

    /// Adds a paragraph.
    pub fn text(mut self, text: impl Into<String>) -> Self {
        self.parts.push(Part::Text(text.into()));
        self
    }

    /// Adds a table under a line.
    pub fn table(mut self, line: impl Into<String>, table: Table) -> Self {
        self.parts.push(Part::Table(line.into(), table));
        self
    }

    /// Adds curves.
    pub fn plot(mut self, plot: Plot) -> Self {
        self.parts.push(Part::Plot(plot));
        self
    }

    /// Adds pictures beside each other.
    pub fn pictures(mut self, pictures: Vec<Photograph>) -> Self {
        self.parts.push(Part::Pictures(pictures));
        self
    }

    /// Adds the tables and plots of a study, each table under the line that `line` has for its name.
    pub fn study(mut self, page: &StudyPage, line: impl Fn(&str) -> String) -> Self {
        for block in page.blocks() {
            self = match block {
                Block::Text(_) => self,
                Block::Table(table) | Block::Data(table) => self.table(line(table.name()), table.clone()),
                Block::Plot(plot) => self.plot(plot.clone()),
            };
        }
        self
    }

    /// Whether everything holds that has to.
    pub fn holds(&self) -> bool {
        self.relations.iter().all(|relation| relation.holds)
    }
}
