//! The rest of a robot file.

use crate::*;

edits! { robot_error ROD:
    negative_modulus r#""54 GPa""# => r#""-54 GPa""#, r#"found "-54 GPa", expected force per area above 0 Pa
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "-54 GPa"
  |                  ^^^^^^^^^
"#;

    negative_density r#""6.45 g/cm^3""# => r#""-6.45 g/cm^3""#, r#"found "-6.45 g/cm^3", expected mass per volume of at least 0 kg/m^3
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "-6.45 g/cm^3"
   |           ^^^^^^^^^^^^^^
"#;

    density_in_the_wrong_unit r#""6.45 g/cm^3""# => r#""6.80 g/mm^3""#, r#"a density of 6800000 kg/m^3 is impossible
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.80 g/mm^3"
   |           ^^^^^^^^^^^^^
hint: "6.80 g/cm^3" was probably meant
"#;

    poisson_ratio_too_large "= 0.33" => "= 0.7", r#"found 0.7, expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = 0.7
   |                 ^^^
"#;

    poisson_ratio_in_quotes "= 0.33" => r#"= "0.33""#, r#"found "0.33", expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = "0.33"
   |                 ^^^^^^
hint: a number without a unit is written without quotes
"#;

    poisson_ratio_nan "= 0.33" => "= nan", r#"found nan, expected a number above -1 and at most 0.5
  --> rod.toml:10:17, key material.niti.poisson_ratio
   |
10 | poisson_ratio = nan
   |                 ^^^
"#;

    two_ways_to_the_shear_modulus "poisson_ratio = 0.33" => r#"poisson_ratio = 0.33
shear_modulus = "20 GPa""#, r#""poisson_ratio" and "shear_modulus" are two ways to give the same thing
  --> rod.toml:11:17, key material.niti.shear_modulus
   |
11 | shear_modulus = "20 GPa"
   |                 ^^^^^^^^
hint: keep one of them
"#;

    no_way_to_the_shear_modulus r#"poisson_ratio = 0.33
"# => "", r#"missing key "poisson_ratio", expected a number such as 0.33 (or "shear_modulus" instead)
 --> rod.toml:8:1, key material.niti
  |
8 | [material.niti]
  | ^^^^^^^^^^^^^^^
"#;

    unknown_key "density =" => "dencity =", r#"unknown key "dencity"
  --> rod.toml:11:1, key material.niti.dencity
   |
11 | dencity = "6.45 g/cm^3"
   | ^^^^^^^
hint: did you mean "density"?
"#;

    unknown_key_unlike_any "density =" => r#"colour = 3
density ="#, r#"unknown key "colour"
  --> rod.toml:11:1, key material.niti.colour
   |
11 | colour = 3
   | ^^^^^^
hint: known keys here: youngs_modulus, poisson_ratio, shear_modulus, density, strain_limit
"#;

    missing_key r#"density = "6.45 g/cm^3"
"# => "", r#"missing key "density", expected mass per volume, such as "6450 kg/m^3"
 --> rod.toml:8:1, key material.niti
  |
8 | [material.niti]
  | ^^^^^^^^^^^^^^^
"#;

    wrong_type r#"name = "trunk""# => "name = true", r#"found true or false, expected a name, such as "trunk"
 --> rod.toml:1:8, key name
  |
1 | name = true
  |        ^^^^
"#;

    empty_name r#"name = "trunk""# => r#"name = " ""#, r#"found an empty text, expected a name, such as "trunk"
 --> rod.toml:1:8, key name
  |
1 | name = " "
  |        ^^^
"#;

    normal_along_tangent "normal = [0, 1, 0]" => "normal = [2, 0, 0]", r#"the normal is parallel to the tangent
 --> rod.toml:6:10, key base.normal
  |
6 | normal = [2, 0, 0]
  |          ^^^^^^^^^
"#;

    tangent_zero "tangent = [1, 0, 0]" => "tangent = [0, 0, 0]", r#"found a direction of length zero
 --> rod.toml:5:11, key base.tangent
  |
5 | tangent = [0, 0, 0]
  |           ^^^^^^^^^
"#;

    tangent_of_two "tangent = [1, 0, 0]" => "tangent = [1, 0]", r#"found a list of 2, expected three numbers, such as [0, 0, 1]
 --> rod.toml:5:11, key base.tangent
  |
5 | tangent = [1, 0]
  |           ^^^^^^
"#;

    syntax r#""390 mm""# => "390 mm", r#"not TOML: string values must be quoted, expected literal string
  --> rod.toml:16:10
   |
16 | length = 390 mm
   |          ^^^^^^
hint: texts and values with a unit stand in quotes: "390 mm"
"#;

    key_given_twice "density =" => r#"density = "1 g/cm^3"
density ="#, r#"not TOML: duplicate key
  --> rod.toml:12:1
   |
12 | density = "6.45 g/cm^3"
   | ^^^^^^^
"#;

}
