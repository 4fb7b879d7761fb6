//! The program as a person meets it: started in a folder, with arguments, read by its text, its files and its exit code.

mod checkpoints;
mod full_disks;
mod guide;
mod interruption;
mod measuring;
mod meshes;
mod messages;
mod precompute;
mod reproducing;
mod results;
#[cfg(target_os = "linux")]
mod serving;
mod tissues;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;
use viscera::mesh::{NamedRegion, TetMesh};

/// What a started program said, and how it ended.
struct Outcome {
    code: Option<i32>,
    out: String,
    err: String,
}

/// A folder to work in; it goes away with the test.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self { folder: TempDir::new().expect("a temporary folder") }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder in the temporary folder");
        fs::write(path, text).expect("a file in the temporary folder");
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn read_bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("JSON")
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_viscera"));
        command.args(arguments).current_dir(self.folder.path());
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            command.env_remove(name);
        }
        command
    }

    fn viscera(&self, arguments: &[&str]) -> Outcome {
        outcome(self.command(arguments).output().expect("the program starts"))
    }
}

fn outcome(output: Output) -> Outcome {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    Outcome { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

impl Outcome {
    /// The program ended with this code; otherwise what it said is shown.
    #[track_caller]
    fn ends_with(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout:\n{}\nstderr:\n{}", self.out, self.err);
        self
    }

    /// It complained in these words.
    #[track_caller]
    fn complains(self, words: &str) -> Self {
        assert!(self.err.contains(words), "`{words}` is not in:\n{}", self.err);
        self
    }

    /// It said these words.
    #[track_caller]
    fn says(self, words: &str) -> Self {
        assert!(self.out.contains(words), "`{words}` is not in:\n{}", self.out);
        self
    }
}

/// A sample of another crate's tests.
fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../viscera-io/tests/data").join(name)
}

/// A small soft cube that hangs from its upper side.
const CUBE: &str = r#"title = "A cube that hangs"
duration = "0.1 s"
step = "10 ms"

[body.cube]
mesh = { generate = "box", size = ["10 cm", "10 cm", "10 cm"], cells = [2, 2, 2] }
density = 1000
law = { kind = "st-venant-kirchhoff", young = "10 kPa", poisson = 0.4 }
fix = "y-max"
"#;

/// A box of 6 144 tetrahedra, and the same with its nodes in no order: 64 has no divisor in common with their number.
fn plain_and_tangled() -> [TetMesh; 2] {
    let mut plain = TetMesh::box_grid([8, 8, 16], [0.1, 0.1, 0.2]);
    let region = |nodes| NamedRegion { nodes, ..NamedRegion::default() };
    plain.regions = [("y-max".to_owned(), region(plain.regions["y-max"].nodes.clone()))].into();
    let nodes = plain.nodes.len();
    let renamed = |node: u32| (node as usize * 64 % nodes) as u32;
    let mut tangled = plain.clone();
    plain.nodes.iter().zip(0..).for_each(|(&place, node)| tangled.nodes[renamed(node) as usize] = place);
    tangled.cells.iter_mut().flatten().for_each(|node| *node = renamed(*node));
    tangled.regions.values_mut().flat_map(|region| &mut region.nodes).for_each(|node| *node = renamed(*node));
    [plain, tangled]
}
