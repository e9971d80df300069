//! The schemas that editors read are the ones the program checks with.

use std::path::Path;

use gearwright_case::kind::KINDS;

#[test]
fn checked_in_schemas_are_current() {
    for kind in KINDS {
        let name = kind.name;
        let current = format!("{}\n", serde_json::to_string_pretty(&(kind.schema)()).unwrap());
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("schema/{name}.schema.json"));
        let kept = std::fs::read_to_string(file).unwrap();
        assert!(current == kept, "run: gearwright schema {name} > crates/gearwright-case/schema/{name}.schema.json");
    }
}
