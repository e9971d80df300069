//! Every file-system call of publishing, of the recovery after it and of entries, refused and killed in turn: results stay whole, old or new,
//! and no file of the user is lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gearwright_store::fault::{Fault, Faulty};
use gearwright_store::file_system::{Disk, FileSystem};
use gearwright_store::folder::verify_on;
use gearwright_store::{Digest, Found, Ignored, ResultsFolder, StoreError, read_entry, verify, write_entry};

const OLD: [(&str, &str); 4] =
    [("a.csv", "old a"), ("b.csv", "old b"), ("sub/c.csv", "old c"), ("gone.csv", "old gone")];
const NEW: [(&str, &str); 5] =
    [("a.csv", "new a"), ("b.csv", "new b"), ("d.csv", "new d"), ("e", "new e"), ("sub/c.csv", "new c")];
/// Put into the old results: free names, names the new results take, a result that was edited.
const USERS: [(&str, &str); 5] = [
    ("notes.txt", "user's notes"),
    ("sub/mine.txt", "user's file in a folder of results"),
    ("d.csv", "user's d"),
    ("e/inner.txt", "user's file in a folder that becomes a result"),
    ("b.csv", "user's edited b"),
];

fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, content) in files {
        let file = folder.join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, content).unwrap();
    }
}

fn publish(disk: Arc<dyn FileSystem>, target: &Path, files: &[(&str, &str)]) -> Result<PathBuf, StoreError> {
    let results = ResultsFolder::create_on(disk, target)?;
    for (name, content) in files {
        let file = results.file(name);
        // the run's own writing: of no interest here, and dead with the process
        if let Some(folder) = file.parent()
            && fs::create_dir_all(folder).is_ok()
        {
            let _ = fs::write(file, content);
        }
    }
    results.publish()
}

/// A scratch folder, in memory where there is such a place: thousands of syncs take minutes on a disk.
fn scratch() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    made.unwrap()
}

/// A scratch folder with old results and the user's files in `target`.
fn scene() -> (tempfile::TempDir, PathBuf) {
    let scratch = scratch();
    let target = scratch.path().join("target");
    publish(Arc::new(Disk), &target, &OLD).unwrap();
    write(&target, &USERS);
    (scratch, target)
}

/// Contents of all files below a folder, by path.
fn contents(folder: &Path) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            all.extend(contents(&path).into_iter().map(|(inner, content)| (format!("{name}/{inner}"), content)));
        } else {
            all.insert(name, fs::read_to_string(&path).unwrap());
        }
    }
    all
}

/// Checks the target after recovery: old or new results, whole, and every file of the user. Returns whether they are new.
fn whole(target: &Path, about: &str) -> bool {
    let found = verify(target).unwrap_or_else(|error| panic!("{about}: {error}"));
    let contents = contents(target);
    let is_new = contents.get("a.csv").map(String::as_str) == Some("new a");
    let expected = if is_new { &NEW[..] } else { &OLD[..] };
    // an edited result counts as changed as long as it stands at the result's name
    let changed: &[&str] = if is_new { &[] } else { &["b.csv"] };
    assert_eq!((found.changed.as_slice(), found.missing.len()), (changed.map_strings().as_slice(), 0), "{about}");
    for (name, content) in expected.iter().filter(|(name, _)| !changed.contains(name)) {
        assert_eq!(contents.get(*name).map(String::as_str), Some(*content), "{about}: {name}");
    }
    for (name, content) in USERS {
        let copies = contents.values().filter(|own| *own == content).count();
        assert_eq!(copies, 1, "{about}: the user's {name} is there {copies} times");
    }
    let leftover = contents.values().filter(|own| own.starts_with(if is_new { "old" } else { "new" })).count();
    assert_eq!(leftover, 0, "{about}: results of both runs in one folder: {contents:?}");
    is_new
}

trait MapStrings {
    fn map_strings(&self) -> Vec<String>;
}

impl MapStrings for &[&str] {
    fn map_strings(&self) -> Vec<String> {
        self.iter().map(ToString::to_string).collect()
    }
}

/// Names beside the target.
fn beside(target: &Path) -> Vec<String> {
    let entries = fs::read_dir(target.parent().unwrap()).unwrap();
    let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name != "target");
    names.sort();
    names
}

/// Calls of one publication without a fault.
fn calls() -> usize {
    let (_scratch, target) = scene();
    let disk = Arc::new(Faulty::new(Fault::Refuse, usize::MAX));
    publish(disk.clone(), &target, &NEW).unwrap();
    assert!(whole(&target, "no fault"));
    assert_eq!(beside(&target), [""; 0]);
    disk.calls()
}

#[test]
fn a_call_that_fails_costs_neither_old_results_nor_new_ones() {
    let calls = calls();
    let mut refused = 0;
    for fault in [Fault::Refuse, Fault::Half] {
        for at in 0..calls {
            let about = format!("{fault:?} at call {at} of {calls}");
            let (_scratch, target) = scene();
            let result = publish(Arc::new(Faulty::new(fault, at)), &target, &NEW);
            assert!(target.join("manifest.sha256").is_file(), "{about}: nothing stands at the target");
            let is_new = whole(&target, &about);
            match result {
                Ok(_) => assert!(is_new, "{about}: reported as published"),
                Err(StoreError::Unpublished { kept, .. }) => {
                    refused += 1;
                    assert!(!is_new && verify(&kept).unwrap().is_intact(), "{about}");
                    assert_eq!(contents(&kept).get("a.csv").map(String::as_str), Some("new a"), "{about}");
                }
                Err(_) => refused += 1,
            }
            // the next run goes through and tidies up
            publish(Arc::new(Disk), &target, &NEW).unwrap();
            assert!(whole(&target, &about));
            assert!(beside(&target).iter().all(|name| name.starts_with("target.unpublished")), "{about}");
        }
    }
    println!("reliability: {} publications with a failing call, {refused} refused, 0 with results lost", 2 * calls);
}

#[test]
fn a_kill_at_any_call_leaves_what_the_next_start_makes_whole() {
    let calls = calls();
    let (mut kills, mut nested, mut new) = (0, 0, 0);
    for fault in [Fault::KillBefore, Fault::KillAfter] {
        for at in 0..calls {
            let about = format!("{fault:?} at call {at} of {calls}");
            let killed = |target: &Path| {
                let result = publish(Arc::new(Faulty::new(fault, at)), target, &NEW);
                // only the removal of the lock may come after the last step that counts
                assert!(result.is_err() || at + 4 > calls, "{about}: a dead process reports success");
            };
            let (_scratch, target) = scene();
            killed(&target);
            kills += 1;
            let interrupted = target.with_file_name(".target.gearwright-old").exists();
            new += usize::from(whole(&target, &about));
            publish(Arc::new(Disk), &target, &NEW).unwrap();
            assert!(whole(&target, &about));
            assert_eq!(beside(&target), [""; 0], "{about}");
            // the recovery may be killed as well, at any of its calls
            if !interrupted || fault == Fault::KillAfter {
                continue;
            }
            for step in 0.. {
                let (_scratch, target) = scene();
                killed(&target);
                let disk = Arc::new(Faulty::new(Fault::KillAfter, step));
                let recovered = verify_on(disk.clone(), &target);
                whole(&target, &format!("{about}, recovery killed at call {step}"));
                nested += 1;
                if recovered.is_ok() && disk.calls() <= step {
                    break;
                }
            }
        }
    }
    println!("reliability: {kills} kills of a publication and {nested} of its recovery, {new} finished as new, 0 lost");
}

/// The child of the test below: publishes and aborts at a call.
#[test]
fn child_that_aborts() {
    let (Ok(target), Ok(at)) = (std::env::var("GEARWRIGHT_STORE_TARGET"), std::env::var("GEARWRIGHT_STORE_ABORT"))
    else {
        return;
    };
    let _ = publish(Arc::new(Faulty::new(Fault::Abort, at.parse().unwrap())), Path::new(&target), &NEW);
}

#[test]
fn a_process_that_really_dies_is_survived_and_its_lock_is_free() {
    let calls = calls();
    for at in 0..calls {
        let (_scratch, target) = scene();
        let status = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "child_that_aborts"])
            .env("GEARWRIGHT_STORE_TARGET", &target)
            .env("GEARWRIGHT_STORE_ABORT", at.to_string())
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .status()
            .unwrap();
        assert!(!status.success(), "call {at} was not reached");
        whole(&target, &format!("abort at call {at}"));
        publish(Arc::new(Disk), &target, &NEW).unwrap();
        assert_eq!(beside(&target), [""; 0], "abort at call {at}");
    }
    println!("reliability: {calls} processes aborted while publishing, 0 with results lost");
}

#[test]
fn only_one_run_writes_to_a_target() {
    let (_scratch, target) = scene();
    let first = ResultsFolder::create(&target).unwrap();
    assert!(matches!(ResultsFolder::create(&target), Err(StoreError::Busy { .. })));
    assert!(verify(&target).is_ok(), "results can be checked while a run is under way");
    drop(first);
    assert_eq!(beside(&target), [""; 0]);
    assert!(ResultsFolder::create(&target).is_ok());
}

#[test]
fn what_is_not_gearwrights_is_left_alone() {
    let scratch = tempfile::tempdir().unwrap();
    let target = scratch.path().join("target");
    // an empty folder may be taken
    fs::create_dir(&target).unwrap();
    publish(Arc::new(Disk), &target, &NEW).unwrap();
    fs::remove_dir_all(&target).unwrap();
    fs::create_dir(&target).unwrap();
    for content in [("photo.jpg", "x"), ("manifest.sha256", "of another program")] {
        write(&target, &[content]);
        assert!(matches!(ResultsFolder::create(&target), Err(StoreError::Foreign { .. })), "{content:?}");
    }
    assert_eq!(contents(&target).len(), 2);
    assert!(matches!(verify(&target), Err(StoreError::NoManifest { .. })));
    let (_scratch, target) = scene();
    let manifest = target.join("manifest.sha256");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replacen("a.csv", "x.csv", 1)).unwrap();
    assert!(matches!(ResultsFolder::create(&target), Err(StoreError::Damaged { .. })));
    assert!(matches!(verify(&target), Err(StoreError::Damaged { .. })));
}

#[test]
fn a_target_taken_during_an_exchange_is_not_overwritten() {
    let (_scratch, target) = scene();
    fs::rename(&target, target.with_file_name(".target.gearwright-old")).unwrap();
    write(&target, &[("photo.jpg", "x")]);
    assert!(matches!(ResultsFolder::create(&target), Err(StoreError::Taken { .. })));
    assert!(target.join("photo.jpg").exists() && target.with_file_name(".target.gearwright-old").exists());
}

#[test]
fn folders_made_for_the_results_go_when_nothing_comes_of_them() {
    let scratch = tempfile::tempdir().unwrap();
    drop(ResultsFolder::create(&scratch.path().join("out/deep/target")).unwrap());
    assert!(!scratch.path().join("out").exists());
}

#[cfg(unix)]
#[test]
fn links_are_followed_to_the_target_and_never_through_it() {
    let (scratch, target) = scene();
    let link = scratch.path().join("link");
    std::os::unix::fs::symlink(&target, &link).unwrap();
    let outside = scratch.path().join("outside.txt");
    fs::write(&outside, "outside").unwrap();
    std::os::unix::fs::symlink(&outside, target.join("way_out")).unwrap();
    publish(Arc::new(Disk), &link, &NEW).unwrap();
    assert!(whole(&target, "by a link"));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::symlink_metadata(target.join("way_out")).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&outside).unwrap(), "outside");
}

#[test]
fn entries_come_back_to_the_bit_or_not_at_all() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("table.entry");
    let key = Digest::of_value(&("case", 1.0)).unwrap();
    let values = vec![0.1 + 0.2, 1.0 / 3.0, f64::MIN_POSITIVE, -0.0];
    assert_eq!(read_entry::<Vec<f64>>(&Disk, &file, key), Found::Absent);
    write_entry(&Disk, &file, key, &values).unwrap();
    assert_eq!(read_entry(&Disk, &file, key), Found::Value(values.clone()));
    let other = Digest::of_value(&("case", 2.0)).unwrap();
    assert_eq!(read_entry::<Vec<f64>>(&Disk, &file, other), Found::Ignored(Ignored::OtherKey));
    let bytes = fs::read(&file).unwrap();
    let mut seen = 0;
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << bit;
            fs::write(&file, &changed).unwrap();
            match read_entry::<Vec<f64>>(&Disk, &file, key) {
                // another letter case of a hexadecimal digit, or another blank, is the same entry
                Found::Value(found) => assert_eq!((found.as_slice(), at < 240), (values.as_slice(), true), "{at}"),
                _ => seen += 1,
            }
        }
        fs::write(&file, &bytes[..at]).unwrap();
        assert!(matches!(read_entry::<Vec<f64>>(&Disk, &file, key), Found::Ignored(_)), "cut at {at}");
    }
    println!("reliability: {} entries with a flipped bit, {seen} seen, 0 taken up with another value", 8 * bytes.len());
    // another program's
    let text = String::from_utf8(bytes).unwrap();
    let program = gearwright_store::program().unwrap().to_string();
    fs::write(&file, text.replacen(&program, &"0".repeat(64), 1)).unwrap();
    assert_eq!(read_entry::<Vec<f64>>(&Disk, &file, key), Found::Ignored(Ignored::OtherProgram));
}

#[test]
fn an_entry_is_the_old_or_the_new_one_whatever_fails() {
    let key = Digest::of(b"key");
    for fault in [Fault::Refuse, Fault::Half, Fault::KillBefore, Fault::KillAfter] {
        for at in 0..4 {
            let scratch = tempfile::tempdir().unwrap();
            let file = scratch.path().join("run.checkpoint");
            write_entry(&Disk, &file, key, &"old").unwrap();
            let disk = Faulty::new(fault, at);
            let written = write_entry(&disk, &file, key, &"new");
            assert_eq!(written.is_err(), at < disk.calls(), "{fault:?} at {at}");
            let found: Found<String> = read_entry(&Disk, &file, key);
            let expected = if written.is_ok() { vec!["new"] } else { vec!["old", "new"] };
            assert!(expected.iter().any(|e| found == Found::Value((*e).to_owned())), "{fault:?} at {at}: {found:?}");
        }
    }
}
