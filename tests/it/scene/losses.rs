//! Mistakes in the tables of losses.

use super::{Mistake, load};

/// Stands before what the bench of these tests has on.
const OLD: &str = "[effects.scope_noise]";

/// A loss in front of the bench's other effects, and what must be said about it: key, found,
/// expected.
fn told(text: &str, key: &str, found: &str, expected: &str) {
    let new = format!("{text}\n\n{OLD}");
    Mistake { old: OLD, new: &new, key, found, expected }.is_told();
}

#[test]
fn losses_out_of_range_or_incomplete() {
    let end = "end_of_contact = \"zero_force\"";
    for (text, key, found, expected) in [
        ("[effects.dashpot]\ngamma = ¦\"-1 N*s/m\"\nEND", "dashpot.gamma", "-1 N*s/m", "from 0 to"),
        ("[effects.dashpot]\ngamma = ¦\"1 GN*s/m\"\nEND", "dashpot.gamma", "1 GN*s/m", "100000"),
        ("[effects.dashpot]\ngamma = ¦\"1 N/m\"\nEND", "dashpot.gamma", "a stiffness", "a damping"),
        ("¦[effects.dashpot]\nEND", "dashpot.gamma", "no such key", "a damping coefficient"),
        (
            "¦[effects.dashpot]\ngamma = \"1 N*s/m\"",
            "dashpot.end_of_contact",
            "no such key",
            "zero_force",
        ),
        (
            "[effects.dashpot]\ngamma = \"1 N*s/m\"\nend_of_contact = ¦\"never\"",
            "dashpot.end_of_contact",
            "never",
            "\"zero_overlap\", \"zero_force\"",
        ),
        (
            "[effects.kuwabara_kono]\neta = ¦\"-1 us\"\nEND",
            "kuwabara_kono.eta",
            "-1 us",
            "from 0 to",
        ),
        ("[effects.kuwabara_kono]\neta = ¦\"1 s\"\nEND", "kuwabara_kono.eta", "1 s", "0.001"),
        (
            "[effects.power_law_loss]\nforce_at_1_m_per_s = \"1 N\"\nexponent = ¦0.5\nEND",
            "power_law_loss.exponent",
            "0.5",
            "from 1 to 5",
        ),
        (
            "[effects.dashpot]\ngamma = \"1 N*s/m\"\nEND\n[[effects.dashpot.contacts]]\nbetween = ¦[\"can\", \"can\"]\ngamma = \"2 N*s/m\"",
            "dashpot.contacts.1.between",
            "do not touch",
            "ball and can",
        ),
        (
            "[effects.dashpot]\ngamma = \"1 N*s/m\"\nEND\n[[effects.dashpot.contacts]]\nbetween = ¦[\"can\"]\ngamma = \"2 N*s/m\"",
            "dashpot.contacts.1.between",
            "1 names",
            "two kinds",
        ),
        (
            "[effects.dashpot]\ngamma = \"1 N*s/m\"\nEND\n[effects.kuwabara_kono]\neta = \"1 us\"\nend_of_contact = ¦\"zero_overlap\"",
            "kuwabara_kono.end_of_contact",
            "zero_overlap",
            "a contact ends once",
        ),
    ] {
        told(&text.replace("END", end), &format!("effects.{key}"), found, expected);
    }
}

/// A linearised contact never opens, so a loss in it has no end.
#[test]
fn losses_need_contacts_that_end() {
    let text = "base = \"linear-300-cells\"\n[effects.dashpot]\ngamma = \"1 N*s/m\"\nend_of_contact = \"zero_force\"\n";
    let error = load(text).expect_err("a loss in linearised contacts").to_string();
    assert!(error.contains("is linearised and has a loss"), "{error}");
}

/// A pair of bodies has a coefficient of its own, and a coefficient of zero is no loss.
#[test]
fn contacts_have_losses_of_their_own() {
    let scene = load(
        "base = \"magnet-0.61g\"\n[effects.dashpot]\ngamma = \"1 N*s/m\"\nend_of_contact = \"zero_force\"\n\
         [[effects.dashpot.contacts]]\nbetween = [\"ferromagnetic_sphere\", \"striker\"]\ngamma = \"0 N*s/m\"\n\
         [[effects.dashpot.contacts]]\nbetween = [\"ptfe_sphere\", \"wall\"]\ngamma = \"3 N*s/m\"\n",
    )
    .expect("a scene");
    let gamma: Vec<Option<f64>> =
        scene.chain.contacts().iter().map(|c| c.loss.map(|loss| loss.dashpot)).collect();
    assert_eq!(gamma.len(), 40);
    assert_eq!(gamma[..3], [None, None, Some(1.0)]);
    assert!(gamma[2..39].iter().all(|g| *g == Some(1.0)), "{gamma:?}");
    assert_eq!(gamma[39], Some(3.0));
}
