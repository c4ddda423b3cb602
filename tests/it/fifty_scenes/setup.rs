//! A bench as plain numbers, from which both the scene's text and the reference solution are made.

use std::f64::consts::PI;
use std::fmt::Write as _;

use crate::random_scenes::SCOPE;

/// An isotropic material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    pub name: &'static str,
    /// Young's modulus (Pa).
    pub modulus: f64,
    /// Poisson's ratio (1).
    pub ratio: f64,
    /// Density (kg/m³).
    pub density: f64,
}

/// A sphere, or a cylinder with flat faces.
#[derive(Debug, Clone, Copy)]
pub struct Bead {
    pub material: Material,
    /// Diameter (m).
    pub diameter: f64,
    /// Height of a cylinder (m).
    pub height: Option<f64>,
    /// Mass (kg).
    pub mass: f64,
}

impl Bead {
    /// Curvature of its faces (1/m).
    pub fn curvature(&self) -> f64 {
        if self.height.is_some() { 0.0 } else { 2.0 / self.diameter }
    }

    /// The same bead with another mass (kg): a hollow or a loaded one.
    pub fn weighing(self, mass: f64) -> Self {
        Self { mass, ..self }
    }
}

/// A solid sphere of this diameter (mm).
pub fn sphere(material: Material, millimetres: f64) -> Bead {
    let diameter = 1e-3 * millimetres;
    let mass = material.density * PI / 6.0 * diameter.powi(3);
    Bead { material, diameter, height: None, mass }
}

/// A solid cylinder of this diameter and height (mm).
pub fn cylinder(material: Material, millimetres: f64, height: f64) -> Bead {
    let (diameter, height) = (1e-3 * millimetres, 1e-3 * height);
    let mass = material.density * PI / 4.0 * diameter * diameter * height;
    Bead { material, diameter, height: Some(height), mass }
}

/// What stands at an end of the chain.
#[derive(Debug, Clone, Copy)]
pub enum End {
    Free,
    /// A constant force towards the chain (N).
    Force(f64),
    /// A flat wall and, at the top, the force with which it presses (N).
    Wall(Material, f64),
}

/// The law of a loss.
#[derive(Debug, Clone, Copy)]
pub enum Law {
    /// `gamma d'`, coefficient in N s/m.
    Dashpot,
    /// `3/2 A eta d^0.5 d'`, coefficient in s.
    KuwabaraKono,
    /// `F1 sgn(d') |d'|^alpha`, coefficient in N at 1 m/s; the exponent (1).
    Power(f64),
}

/// A loss in all contacts, and its coefficients in single ones.
#[derive(Debug, Clone)]
pub struct Loss {
    pub law: Law,
    pub coefficient: f64,
    /// Contacts, each by the body below it in a chain with a striker (1 is the striker's contact),
    /// with their own coefficients.
    pub single: Vec<(usize, f64)>,
}

/// A bench.
#[derive(Debug, Clone)]
pub struct Setup {
    /// What is extreme in it.
    pub name: &'static str,
    /// From top to bottom.
    pub beads: Vec<Bead>,
    /// The striker and its speed (m/s).
    pub striker: Option<(Bead, f64)>,
    pub top: End,
    pub bottom: End,
    /// Acceleration of free fall (m/s²).
    pub gravity: f64,
    /// A constant pull (N) on a particle, counted from 1.
    pub magnet: Option<(usize, f64)>,
    pub losses: Vec<Loss>,
    /// Whether contacts with losses end where their force comes back to zero; else where the
    /// overlap does.
    pub zero_force: bool,
    /// Particles, counted from 1, with their initial velocities (m/s).
    pub velocities: Vec<(usize, f64)>,
    /// Particles with sensors and the offsets of their plates (1).
    pub sensors: Vec<(usize, f64)>,
    /// How long the motion is followed (s).
    pub duration: f64,
}

impl Setup {
    /// Bodies from top to bottom, the striker first.
    pub fn bodies(&self) -> Vec<Bead> {
        self.striker.iter().map(|(bead, _)| *bead).chain(self.beads.iter().copied()).collect()
    }

    /// Index of the first particle among the bodies.
    pub fn first(&self) -> usize {
        usize::from(self.striker.is_some())
    }

    /// Name of body `index` in the scene; what lies beyond an end is a wall.
    fn body_name(&self, index: Option<usize>) -> String {
        match index {
            Some(0) if self.striker.is_some() => "striker".to_owned(),
            Some(index) if index < self.bodies().len() => format!("p{}", index + 1 - self.first()),
            _ => "wall".to_owned(),
        }
    }

    /// The scene's text.
    pub fn text(&self) -> String {
        let mut text = format!("title = \"{}\"\nduration = \"{:e} s\"\n", self.name, self.duration);
        let walls = [self.top, self.bottom].into_iter().filter_map(|end| match end {
            End::Wall(material, _) => Some(material),
            _ => None,
        });
        let used = self.bodies().into_iter().map(|bead| bead.material).chain(walls);
        let mut materials: Vec<Material> = Vec::new();
        for material in used {
            if !materials.contains(&material) {
                materials.push(material);
            }
        }
        for Material { name, modulus, ratio, .. } in materials {
            line(
                &mut text,
                &format!(
                    "[materials.{name}]\nyoungs_modulus = \"{modulus:e} Pa\"\npoissons_ratio = {ratio}"
                ),
            );
        }
        let body = |bead: &Bead| {
            let height = bead.height.map_or(String::new(), |h| format!("height = \"{h:e} m\"\n"));
            let Bead { material, diameter, mass, .. } = bead;
            format!(
                "material = \"{}\"\ndiameter = \"{diameter:e} m\"\n{height}mass = \"{mass:e} kg\"",
                material.name
            )
        };
        for (index, bead) in self.beads.iter().enumerate() {
            line(&mut text, &format!("[particles.p{}]\n{}", index + 1, body(bead)));
        }
        let names: Vec<String> = (1..=self.beads.len()).map(|i| format!("\"p{i}\"")).collect();
        let (top, bottom) = (end(self.top), end(self.bottom));
        line(
            &mut text,
            &format!(
                "[chain]\ntop = {top}\nbottom = {bottom}\n[[chain.segments]]\nparticles = [{}]",
                names.join(", ")
            ),
        );
        if let Some((bead, speed)) = &self.striker {
            line(&mut text, &format!("[striker]\n{}\nspeed = \"{speed:e} m/s\"", body(bead)));
        }
        for (particle, velocity) in &self.velocities {
            line(
                &mut text,
                &format!(
                    "[[initial_velocities]]\nparticle = {particle}\nvelocity = \"{velocity:e} m/s\""
                ),
            );
        }
        self.effects(&mut text);
        for (index, (particle, offset)) in self.sensors.iter().enumerate() {
            line(
                &mut text,
                &format!(
                    "[sensors.s{index}]\nmodel = \"pzt-5a-710pf\"\nparticle = {particle}\noffset = {offset:?}"
                ),
            );
        }
        text + SCOPE
    }

    fn effects(&self, text: &mut String) {
        if self.gravity != 0.0 {
            line(text, &format!("[effects.gravity]\nacceleration = \"{:e} m/s^2\"", self.gravity));
        }
        if let Some((particle, force)) = self.magnet {
            line(
                text,
                &format!(
                    "[effects.magnet_preload]\nforce = \"{force:e} N\"\nparticle = {particle}"
                ),
            );
        }
        let end = if self.zero_force { "zero_force" } else { "zero_overlap" };
        for Loss { law, coefficient, single } in &self.losses {
            let (table, key, unit, more) = match law {
                Law::Dashpot => ("dashpot", "gamma", "N*s/m", String::new()),
                Law::KuwabaraKono => ("kuwabara_kono", "eta", "s", String::new()),
                Law::Power(exponent) => {
                    let more = format!("exponent = {exponent:?}\n");
                    ("power_law_loss", "force_at_1_m_per_s", "N", more)
                }
            };
            line(
                text,
                &format!(
                    "[effects.{table}]\n{more}{key} = \"{coefficient:e} {unit}\"\nend_of_contact = \"{end}\""
                ),
            );
            for (contact, coefficient) in single {
                let upper = self.body_name(contact.checked_sub(1));
                let lower = self.body_name(Some(*contact));
                line(
                    text,
                    &format!(
                        "[[effects.{table}.contacts]]\nbetween = [\"{upper}\", \"{lower}\"]\n{key} = \"{coefficient:e} {unit}\""
                    ),
                );
            }
        }
    }
}

fn line(text: &mut String, part: &str) {
    writeln!(text, "{part}").expect("text");
}

fn end(end: End) -> String {
    match end {
        End::Free => "\"free\"".to_owned(),
        End::Force(force) => format!("{{ force = \"{force:e} N\" }}"),
        End::Wall(material, preload) if preload > 0.0 => {
            format!("{{ wall = \"{}\", preload = \"{preload:e} N\" }}", material.name)
        }
        End::Wall(material, _) => format!("{{ wall = \"{}\" }}", material.name),
    }
}
