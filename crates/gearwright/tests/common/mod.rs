//! What the tests of the program share: running it in a scratch folder.
// every test binary uses a part of it
#![allow(dead_code, unused_macros)]

/// A spur-pair case: what follows the kind, two equal gears, what follows their load.
macro_rules! spur_pair {
    ($head:literal, $tail:literal) => {
        concat!(
            "kind = \"spur-pair\"\n",
            $head,
            r#"
[mesh]
module_mm = 6.0
pressure_angle_deg = 20.0
centre_distance_mm = 150.1

[pinion]
teeth = 25
profile_shift = 0.0
tip_diameter_mm = 162.0
root_diameter_mm = 135.0
bore_diameter_mm = 60.0
facewidth_mm = 16.0

[gear]
teeth = 25
profile_shift = 0.0
tip_diameter_mm = 162.0
root_diameter_mm = 135.0
bore_diameter_mm = 60.0
facewidth_mm = 16.0

[load]
torque_n_m = 200.0
"#,
            $tail
        )
    };
}

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Runs the program in a folder.
pub fn gearwright(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gearwright")).args(arguments).current_dir(folder).output().unwrap()
}

/// Output as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder that goes away with the test.
pub struct Scratch(tempfile::TempDir);

impl Scratch {
    /// An empty one.
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file, with the folders it needs.
    pub fn write(&self, name: &str, content: &str) -> PathBuf {
        let file = self.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, content).unwrap();
        file
    }

    /// Runs a case text into a folder of its name; the folder and its summary.
    pub fn run(&self, name: &str, content: &str) -> (PathBuf, Value) {
        self.write(&format!("{name}.toml"), content);
        let output = gearwright(self.path(), &["run", &format!("{name}.toml"), "--out", name]);
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        let screen = text(&output.stdout);
        assert!(screen.lines().count() < 25, "more than one screen: {screen}");
        let folder = self.path().join(name);
        let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
        (folder, serde_json::from_str(&summary).unwrap())
    }

    /// Names in it, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
