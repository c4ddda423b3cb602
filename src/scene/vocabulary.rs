//! Words that people try in scenes and that are no keys: what there is instead, or that there is
//! nothing. `docs/limits.md` says the same at length.

/// Words, and what to say of them.
const ANSWERS: &[(&[&str], &str)] = &[
    (
        &["actuator", "piezo", "shaker", "excitation", "source", "generator", "force_input"],
        "a driven end is [drive] with displacement or stack, and a signal",
    ),
    (
        &["damping", "damper", "viscosity", "dissipation", "loss", "losses"],
        "losses are [effects.dashpot], kuwabara_kono and power_law_loss",
    ),
    (
        &["restitution", "coefficient_of_restitution", "cor"],
        "[effects.plasticity] model = \"walton_braun\" takes a restitution",
    ),
    (
        &["plastic", "yielding", "yield", "elastoplastic"],
        "contacts that yield are [effects.plasticity], by the yield_strength of materials",
    ),
    (
        &["friction", "rotation", "rolling", "torsion", "spin", "tangential"],
        "there is none: bodies move along one line without turning; a loss in contacts is the nearest",
    ),
    (
        &["2d", "3d", "dimension", "dimensions", "lattice", "packing", "rows", "columns"],
        "there is none: a scene is one chain of bodies along one line",
    ),
    (
        &["adhesion", "cohesion", "jkr", "dmt", "capillary", "liquid"],
        "there is none: contacts only push; magnets pull by [effects.magnet_preload]",
    ),
    (
        &["resonator", "resonators", "mass_in_mass", "woodpile", "modes"],
        "there is none: bodies are rigid but for their contacts",
    ),
    (&["fracture", "breakage", "wear", "fatigue"], "there is none: bodies neither break nor wear"),
    (
        &["rod", "bar", "plate", "hopkinson", "membrane", "anvil"],
        "rods and plates are ends: chain.bottom = { rod = \"<material>\", diameter = \"<length>\" }",
    ),
    (
        &["bits", "resolution", "high_resolution", "vertical_resolution", "enob"],
        "the converter's bits are those of the oscilloscope: [scope] bits = 12, from 8 to 16",
    ),
    (
        &["creep", "hardening", "work_hardening"],
        "there is none: contacts that yield are perfectly plastic",
    ),
    (
        &["keep", "indentation", "indentations"],
        "[effects.plasticity] keep_indentations = true keeps indentations from shot to shot",
    ),
    (
        &["laser", "ldv", "vibrometer", "interferometer"],
        "a laser vibrometer is [vibrometers.NAME] with particle and sensitivity",
    ),
    (
        &["accelerometer", "strain_gauge", "strain"],
        "sensors of motion are [accelerometers.NAME] and [strain_gauges.NAME]",
    ),
];

/// What to say of a word that is no key; none if nothing is known of it.
pub fn answer(word: &str) -> Option<&'static str> {
    let word = word.to_ascii_lowercase();
    let is_it = |known: &&str| {
        let slips = if known.len() > 5 { 2 } else { 0 };
        strsim::damerau_levenshtein(known, &word) <= slips
    };
    ANSWERS.iter().find(|(words, _)| words.iter().any(is_it)).map(|(_, answer)| *answer)
}
