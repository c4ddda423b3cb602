//! Materials: densities, numbers of shipped ones changed, and mistakes that are answered.

use hertzscope::note::Note;
use hertzscope::scene::Scene;

/// A ball of 10 mm.
const BALL: &str = "material = \"steel_52100\"\ndiameter = \"10 mm\"";

/// A wall, two balls of `ball` and a striker; `more` stands before the tables.
fn scene(ball: &str, more: &str) -> Result<Scene, String> {
    struck(ball, more, BALL)
}

/// The same with a striker of this `shape`.
fn struck(ball: &str, more: &str, shape: &str) -> Result<Scene, String> {
    let text = format!(
        "duration = \"100 us\"\n{more}\n[particles.ball]\n{ball}\n\
         [chain]\ntop = \"free\"\nbottom = {{ wall = \"steel_440c\" }}\n\
         [[chain.segments]]\nrepeat = 2\nparticles = [\"ball\"]\n\
         [striker]\n{shape}\nspeed = \"0.1 m/s\"\n\
         [sensors.s]\nmodel = \"pzt-5a-710pf\"\nparticle = 2\n\
         [scope]\nmodel = \"tds2014\"\ntime_base = \"10 us/div\"\n\
         trigger = {{ source = \"CH1\", level = \"200 mV\", slope = \"rise\", mode = \"auto\" }}\n\
         ch1 = {{ input = \"s\", scale = \"1 V/div\" }}\n"
    );
    Scene::from_text("s", "s.toml", &text).map_err(|error| error.to_string())
}

/// pi/6 d^3 and pi/4 d^2 h, worked out by hand: 0.5236 cm3 of steel at 7.81 g/cm3, 0.1571 cm3 of
/// brass at 8.47 g/cm3.
#[test]
fn masses_follow_from_density_and_shape() {
    let rod = "material = \"brass\"\ndiameter = \"10 mm\"\nheight = \"2 mm\"";
    let scene = struck(BALL, "", rod).expect("a scene");
    let striker = scene.spec.striker.as_ref().expect("a striker");
    for (body, mass) in [(&scene.spec.particles[0], 4.0893e-3), (striker, 1.3305e-3)] {
        assert!((body.mass / mass - 1.0).abs() < 1e-4, "{}", body.mass);
    }
    assert!(mass_notes(&scene).is_empty(), "{:?}", scene.notes);
}

fn mass_notes(scene: &Scene) -> Vec<Note> {
    let notes = scene.notes.iter().filter(|note| note.code == "mass_not_of_its_material");
    notes.cloned().collect()
}

/// Balls on a wall without a word on gravity, and balls of nearly a metre.
#[test]
fn a_missing_weight_and_a_large_ball_are_noted() {
    let codes = |scene: &Scene| scene.notes.iter().map(|note| note.code).collect::<Vec<_>>();
    let ball = "material = \"steel_440c\"\ndiameter = \"9.5 mm\"";
    let scene = scene(ball, "").expect("a scene");
    assert_eq!(codes(&scene), ["gravity_off"]);
    let told = "[effects.gravity]\nacceleration = \"9.81 m/s^2\"\nstate = \"off\"";
    assert_eq!(codes(&self::scene(ball, told).expect("a scene")), [""; 0]);
    let large = self::scene(&ball.replace("9.5", "950"), told).expect("a scene");
    assert!(codes(&large).contains(&"large_body"), "{:?}", large.notes);
}

#[test]
fn a_mass_that_does_not_go_with_its_shape_is_noted() {
    let ball = "material = \"steel_440c\"\ndiameter = \"9.5 mm\"\nmass = ";
    let notes = |mass: &str| mass_notes(&scene(&format!("{ball}\"{mass}\""), "").expect("a scene"));
    assert!(notes("3.5 g").is_empty());
    let [note] = &notes("3.5 kg")[..] else { panic!("one note") };
    assert!(
        note.sentence.contains("ball: its mass of 3500 g is 1019")
            && note.sentence.contains("3.43 g"),
        "{note}"
    );
}

#[test]
fn one_number_of_a_shipped_material_is_changed_alone() {
    let softer = "[materials.ptfe]\nyoungs_modulus = \"1 GPa\"";
    let scene = scene("material = \"ptfe\"\ndiameter = \"4.76 mm\"", softer).expect("a scene");
    let ball = &scene.spec.particles[0];
    assert_eq!([ball.elasticity.youngs_modulus, ball.elasticity.poissons_ratio], [1e9, 0.46]);
    // 2170 kg/m3 of a sphere of 4.76 mm.
    assert!((ball.mass / 0.12254e-3 - 1.0).abs() < 1e-3, "{}", ball.mass);
}

#[test]
fn common_mistakes_are_answered() {
    let ball = "material = \"ptfe\"\ndiameter = \"4.76 mm\"";
    for (ball, more, words) in [
        ("materal = \"ptfe\"\ndiameter = \"4.76 mm\"", "", "did you mean `material`?"),
        (
            "material = \"ptfe\"\ndiameter = \"4,76 mm\"",
            "",
            "expected a decimal point: \"4.76 mm\"",
        ),
        (ball, "effects.gravity = \"off\"", "`effects.gravity = false` to switch the effect off"),
    ] {
        let error = scene(ball, more).expect_err("a mistake");
        assert!(error.contains(words), "{error}");
    }
}
