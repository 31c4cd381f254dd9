//! What is only implausible.

use crate::*;

edits! { robot_warning ROD:
    density_of_nothing r#""6.45 g/cm^3""# => r#""0.5 kg/m^3""#, r#"a density of 0.5 kg/m^3 is implausible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "0.5 kg/m^3"
   |           ^^^^^^^^^^^^
hint: solids lie between 1 kg/m^3 (aerogels) and 22600 kg/m^3 (osmium)
"#;

    density_absurd r#""6.45 g/cm^3""# => r#""68 g/cm^3""#, r#"a density of 68000 kg/m^3 is implausible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "68 g/cm^3"
   |           ^^^^^^^^^^^
hint: "68 kg/m^3" was probably meant
"#;

    stiffer_than_diamond r#""54 GPa""# => r#""54000 GPa""#, r#"a Young's modulus of 5.4e13 Pa is implausible
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54000 GPa"
  |                  ^^^^^^^^^^^
hint: solids lie between 1 kPa (gels) and 1200 GPa (diamond)
"#;

    softer_than_gel r#""54 GPa""# => r#""54 Pa""#, r#"a Young's modulus of 5.4e1 Pa is implausible
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54 Pa"
  |                  ^^^^^^^
hint: solids lie between 1 kPa (gels) and 1200 GPa (diamond)
"#;

    thick_robot r#""390 mm""# => r#""4 mm""#, r#"the robot is only 2.66667 times as long as it is thick
  --> rod.toml:14:1, key section.rod
   |
14 | [[section]]
   | ^^^^^^^^^^^
hint: rod theory is made for slender bodies, 10 times and more
"#;

    gravity_absurd r#""[0, -9.81, 0] m/s^2""# => r#""[0, -981, 0] m/s^2""#, r#"a gravity of 981 m/s^2 is implausible
 --> rod.toml:2:11, key gravity
  |
2 | gravity = "[0, -981, 0] m/s^2"
  |           ^^^^^^^^^^^^^^^^^^^^
hint: the Earth's is 9.81 m/s^2
"#;

    gravity_in_millimetres r#""[0, -9.81, 0] m/s^2""# => r#""[0, -9.81, 0] mm/s^2""#, r#"a gravity of 0.00981 m/s^2 is implausible
 --> rod.toml:2:11, key gravity
  |
2 | gravity = "[0, -9.81, 0] mm/s^2"
  |           ^^^^^^^^^^^^^^^^^^^^^^
hint: the Earth's is 9.81 m/s^2
"#;

    shear_coefficient_absurd r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", shear_coefficient = 2 }"#, r#"a shear coefficient of 2 is implausible
  --> rod.toml:18:54, key section.rod.profile.shear_coefficient
   |
18 | profile = { diameter = "1.5 mm", shear_coefficient = 2 }
   |                                                      ^
hint: 0.9 for a round rod, 5/6 for a strip, 1 as in the thesis
"#;

    shear_modulus_absurd "poisson_ratio = 0.33" => r#"shear_modulus = "60 GPa""#, r#"a shear modulus of 1.111 E is implausible
  --> rod.toml:10:17, key material.niti.shear_modulus
   |
10 | shear_modulus = "60 GPa"
   |                 ^^^^^^^^
hint: an isotropic material has E/3 <= G < E/2 or so
"#;

}
