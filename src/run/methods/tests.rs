//! Names and settings of the methods.

use std::collections::BTreeSet;

use super::*;

#[test]
fn names_are_unique_and_each_method_changes_something_of_its_own() {
    let names: BTreeSet<_> = METHODS.iter().map(|m| m.name).collect();
    assert_eq!(names.len(), METHODS.len());
    let scenes: BTreeSet<String> = METHODS
        .iter()
        .map(|method| {
            let mut scene = Scene::default();
            method.apply_to_scene(&mut scene);
            format!("{scene:?}")
        })
        .collect();
    // `substep-120` is the default by another name, as one point of its curve.
    assert_eq!(scenes.len(), METHODS.len() - 1);
}

#[test]
fn methods_tell_what_other_options_are_lost_beside_them() {
    let names = |told: fn(&NamedMethod) -> bool| -> Vec<&str> {
        let methods = METHODS.iter().filter(|method| told(method));
        methods.map(|method| method.name).collect()
    };
    let own_substep = names(NamedMethod::has_own_substep);
    assert!(own_substep.iter().all(|name| name.starts_with("substep-")));
    assert_eq!(own_substep.len(), 5);
    let lost = names(NamedMethod::is_lost_on_reference);
    for (name, is_lost) in [
        (DEFAULT, false),
        ("nearest-64", true),
        ("paper", true),
        ("rounds-1", true),
        ("segments-4", false),
        (ROOT_PAPER, false),
        (LEAN_0, false),
        ("substep-60", false),
    ] {
        assert_eq!(lost.contains(&name), is_lost, "{name}");
    }
}
