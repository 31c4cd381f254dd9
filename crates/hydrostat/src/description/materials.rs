//! Built-in materials, and those of a robot file.

use super::quantity::{DENSITY, FRACTION, STRESS, rounded};
use super::reader::{Node, Table, is_name, nearest};
use crate::Error;
use crate::model::Material;

pub(super) const MATERIAL_KEYS: &[&str] =
    &["youngs_modulus", "poisson_ratio", "shear_modulus", "density", "strain_limit"];

/// A material that a robot file can name without defining it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuiltIn {
    pub id: &'static str,
    pub description: &'static str,
    /// Pa.
    pub youngs_modulus: f64,
    /// Pa.
    pub shear_modulus: f64,
    /// kg/m^3.
    pub density: f64,
    /// As a fraction.
    pub strain_limit: f64,
    pub source: &'static str,
}

/// Typical values: a real wire differs by 10 % or more, so measure it (`hydrostat calibrate`).
pub const BUILT_IN: &[BuiltIn] = &[
    BuiltIn {
        id: "nitinol",
        description: "superelastic nickel titanium, austenite",
        youngs_modulus: 75e9,
        shear_modulus: isotropic(75e9, 0.33),
        density: 6450.0,
        strain_limit: 0.01,
        source: "E at the low end of 75-83 GPa, Poisson's ratio 0.33, 6.45 g/cm^3: Wikipedia, Nickel titanium, and SMA Inc., \
                 Selected Properties of NiTi; limit: linear below 1 %, Gray 2009",
    },
    BuiltIn {
        id: "spring_steel",
        description: "music wire ASTM A228, 0.8 to 1.6 mm",
        youngs_modulus: 200e9,
        shear_modulus: 81.7e9,
        density: 7850.0,
        strain_limit: 0.007,
        source: "E, G and elastic limit 65 % of strength: Shigley, Mechanical Engineering Design, Table 10-5; \
                 density 0.284 lb/in^3: suppliers' tables for A228",
    },
    BuiltIn {
        id: "stainless_steel",
        description: "stainless spring wire AISI 302/304, ASTM A313",
        youngs_modulus: 193e9,
        shear_modulus: 69e9,
        density: 7920.0,
        strain_limit: 0.006,
        source: "E 28 Mpsi, G 10 Mpsi, density 0.286 lb/in^3: suppliers' tables for A313; limit 65 % of strength: Shigley, Table 10-5",
    },
    BuiltIn {
        id: "fibreglass",
        description: "pultruded glass-fibre rod, fibres along the rod",
        youngs_modulus: 41e9,
        shear_modulus: 4.3e9,
        density: 1970.0,
        strain_limit: 0.0125,
        source: "E, G and density of unidirectional E-glass/epoxy: Daniel and Ishai, Engineering Mechanics of Composite \
                 Materials, Table A.4; limit: least bend diameter 80 rod diameters, Tencom, Material Properties",
    },
    BuiltIn {
        id: "carbon",
        description: "pultruded carbon-fibre rod, fibres along the rod",
        youngs_modulus: 134e9,
        shear_modulus: 7.0e9,
        density: 1500.0,
        strain_limit: 0.01,
        source: "E and density: Goodwinds, Technical Material Specifications; G of AS4/3501-6: Daniel and Ishai, Table A.4; \
                 limit: 70 % of Goodwinds's ultimate 1.4 %",
    },
    BuiltIn {
        id: "peek",
        description: "polyether ether ketone, unfilled (Victrex 450G)",
        youngs_modulus: 4.0e9,
        shear_modulus: isotropic(4.0e9, 0.4),
        density: 1300.0,
        strain_limit: 0.025,
        source: "Victrex, PEEK 450G data sheet; limit: yield strength 100 MPa / E",
    },
    BuiltIn {
        id: "abs",
        description: "acrylonitrile butadiene styrene, moulded; printed parts are softer",
        youngs_modulus: 2.3e9,
        shear_modulus: isotropic(2.3e9, 0.4),
        density: 1050.0,
        strain_limit: 0.019,
        source: "middle of the ranges of Granta MaterialUniverse, ABS (2.0-2.9 GPa, 0.394-0.422, 1020-1080 kg/m^3); limit: yield 44 MPa / E",
    },
    BuiltIn {
        id: "pla",
        description: "polylactic acid, printed with the strands along the rod",
        youngs_modulus: 3.0e9,
        shear_modulus: isotropic(3.0e9, 0.36),
        density: 1240.0,
        strain_limit: 0.015,
        source: "E 3.04 GPa and elongation at yield 1.5 %: Stratasys PLA data sheet (XZ); density and Poisson's ratio: usual for PLA",
    },
    BuiltIn {
        id: "ecoflex_00_30",
        description: "silicone rubber Ecoflex 00-30, linearised",
        youngs_modulus: 118e3,
        shear_modulus: isotropic(118e3, 0.5),
        density: 1070.0,
        strain_limit: 1.0,
        source: "Smooth-On technical bulletin: 10 psi at 100 % strain, of a neo-Hookean rubber: E = 3 x stress / 1.75",
    },
    BuiltIn {
        id: "dragon_skin_30",
        description: "silicone rubber Dragon Skin 30, linearised",
        youngs_modulus: 1.016e6,
        shear_modulus: isotropic(1.016e6, 0.5),
        density: 1080.0,
        strain_limit: 1.0,
        source: "Smooth-On technical bulletin: 86 psi at 100 % strain, of a neo-Hookean rubber: E = 3 x stress / 1.75",
    },
];

const fn isotropic(youngs_modulus: f64, poisson_ratio: f64) -> f64 {
    youngs_modulus / (2.0 * (1.0 + poisson_ratio))
}

impl BuiltIn {
    fn material(&self) -> Material {
        Material {
            name: self.id.to_string(),
            youngs_modulus: self.youngs_modulus,
            shear_modulus: self.shear_modulus,
            density: self.density,
            strain_limit: Some(self.strain_limit),
        }
    }
}

/// The materials that the file defines.
pub(super) fn read(robot: &Table, warnings: &mut Vec<Error>) -> Result<Vec<Material>, Error> {
    let Some(node) = robot.get("material") else {
        return Ok(Vec::new());
    };
    let entries = node.entries("tables with a name, such as [material.niti]")?;
    entries.iter().map(|entry| read_material(&entry.name, &entry.node, warnings)).collect()
}

/// The material of that name, own or built-in.
pub(super) fn find(own: &[Material], node: &Node) -> Result<Material, Error> {
    let name = node.text("the name of a material, such as \"nitinol\"")?;
    let own_name = own.iter().find(|material| material.name == name).cloned();
    let found =
        own_name.or_else(|| BUILT_IN.iter().find(|material| material.id == name).map(BuiltIn::material));
    found.ok_or_else(|| {
        let names = own.iter().map(|material| material.name.as_str());
        let known: Vec<&str> = names.chain(BUILT_IN.iter().map(|material| material.id)).collect();
        node.error(format!("unknown material \"{name}\"")).hint(match nearest(name, &known) {
            Some(other) => format!("did you mean \"{other}\"?"),
            None => format!("define [material.{name}], or take one of {}", known.join(", ")),
        })
    })
}

fn read_material(name: &str, node: &Node, warnings: &mut Vec<Error>) -> Result<Material, Error> {
    if !is_name(name) {
        return Err(node.error("the name of a material may have letters, digits, - and _ only"));
    }
    let table = node.table(MATERIAL_KEYS)?;
    let youngs_modulus = read_youngs_modulus(&table, warnings)?;
    let shear_modulus = read_shear_modulus(&table, youngs_modulus, warnings)?;
    let density = read_density(&table, warnings)?;
    let strain_limit = table
        .get("strain_limit")
        .map(|node| node.quantity_where(&FRACTION, "above 0 %", |limit| limit > 0.0))
        .transpose()?;
    Ok(Material { name: name.to_string(), youngs_modulus, shear_modulus, density, strain_limit })
}

fn read_youngs_modulus(table: &Table, warnings: &mut Vec<Error>) -> Result<f64, Error> {
    let node = table.quantity("youngs_modulus", &STRESS)?;
    let value = node.positive(&STRESS)?;
    if !(1e3..=1500e9).contains(&value) {
        warnings.push(
            node.error(format!("a Young's modulus of {:e} Pa is implausible", rounded(value)))
                .hint("solids lie between 1 kPa (gels) and 1200 GPa (diamond)"),
        );
    }
    Ok(value)
}

fn read_shear_modulus(table: &Table, youngs_modulus: f64, warnings: &mut Vec<Error>) -> Result<f64, Error> {
    table.either("poisson_ratio", "shear_modulus")?;
    if let Some(node) = table.get("shear_modulus") {
        let value = node.positive(&STRESS)?;
        // Fibres along the rod make G far smaller than E/3, nothing makes it larger than E.
        if value > youngs_modulus {
            let message = format!("a shear modulus of {:.3} E is implausible", value / youngs_modulus);
            warnings.push(node.error(message).hint("an isotropic material has E/3 <= G < E/2 or so"));
        }
        return Ok(value);
    }
    let expected = "a number above -1 and at most 0.5";
    let node = table.require("poisson_ratio", "a number such as 0.33 (or \"shear_modulus\" instead)")?;
    let ratio = node.number(expected)?;
    if ratio > -1.0 && ratio <= 0.5 {
        return Ok(isotropic(youngs_modulus, ratio));
    }
    Err(node.refuse(expected))
}

/// Densities of solids, kg/m^3: below, above, and beyond what counting other parts in may explain.
const LIGHTEST: f64 = 1.0;
const DENSEST: f64 = 25_000.0;
const IMPOSSIBLE: f64 = 250_000.0;

fn read_density(table: &Table, warnings: &mut Vec<Error>) -> Result<f64, Error> {
    let node = table.quantity("density", &DENSITY)?;
    let value = node.not_negative(&DENSITY)?;
    if value <= DENSEST && (value == 0.0 || value >= LIGHTEST) {
        return Ok(value);
    }
    let text = node.text("")?;
    let hint = if text.contains("g/mm^3") && value <= 1e3 * DENSEST {
        format!("\"{}\" was probably meant", text.replace("mm^3", "cm^3"))
    } else if text.ends_with(" g/cm^3") && value <= 1e3 * DENSEST {
        format!("\"{}\" was probably meant", text.replace("g/cm^3", "kg/m^3"))
    } else {
        "solids lie between 1 kg/m^3 (aerogels) and 22600 kg/m^3 (osmium)".to_string()
    };
    let judged = |word| node.error(format!("a density of {} kg/m^3 is {word}", rounded(value))).hint(hint);
    // somewhat too dense may be meant: mass of other parts counted in
    if value > IMPOSSIBLE {
        return Err(judged("impossible"));
    }
    warnings.push(judged("implausible"));
    Ok(value)
}
