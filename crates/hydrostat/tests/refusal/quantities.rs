//! Values with a unit.

use crate::*;

edits! { robot_error ROD:
    bare_number r#""390 mm""# => "390", r#"found a number without a unit, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = 390
   |          ^^^
"#;

    wrong_dimension r#""6.45 g/cm^3""# => r#""6.80 mm""#, r#"found a length, expected mass per volume, such as "6450 kg/m^3"
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.80 mm"
   |           ^^^^^^^^^
"#;

    unknown_unit r#""390 mm""# => r#""390 mmm""#, r#"unknown unit "mmm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390 mmm"
   |          ^^^^^^^^^
hint: did you mean "mm"?
"#;

    units_run_together r#""[0, 0, 0.01] N m""# => r#""[0, 0, 0.01] Nm""#, r#"unknown unit "Nm"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "[0, 0, 0.01] Nm"
   |          ^^^^^^^^^^^^^^^^^
hint: did you mean "N m"?
"#;

    wrong_case r#""54 GPa""# => r#""54 gpa""#, r#"unknown unit "gpa"
 --> rod.toml:9:18, key material.niti.youngs_modulus
  |
9 | youngs_modulus = "54 gpa"
  |                  ^^^^^^^^
hint: did you mean "GPa"?
"#;

    unit_nobody_knows r#""390 mm""# => r#""390 cubits""#, r#"unknown unit "cubits"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390 cubits"
   |          ^^^^^^^^^^^^
hint: known units: m in ft, g t lb oz, s min h, N kgf gf lbf, Pa bar psi, J W Hz, rad deg rev, %, 1; with prefixes as in mm, kN, GPa
"#;

    ambiguous_unit r#""6.45 g/cm^3""# => r#""6.45 kg/m s""#, r#""kg/m s" can be read in two ways
  --> rod.toml:11:11, key material.niti.density
   |
11 | density = "6.45 kg/m s"
   |           ^^^^^^^^^^^^^
hint: repeat the slash, as in "kg/m/s", or write the divided units last
"#;

    missing_unit r#""390 mm""# => r#""390""#, r#"found a number without a unit, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390"
   |          ^^^^^
"#;

    decimal_comma r#""390 mm""# => r#""390,5 mm""#, r#"found ",5 mm" after a number, expected a unit
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "390,5 mm"
   |          ^^^^^^^^^^
hint: write decimals with a point and thousands without a mark: 1.5, 2000
"#;

    no_number r#""390 mm""# => r#""long""#, r#"found "long", expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "long"
   |          ^^^^^^
"#;

    empty_quantity r#""390 mm""# => r#""""#, r#"found an empty text, expected a length, such as "390 mm"
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = ""
   |          ^^
"#;

    not_a_number r#""390 mm""# => r#""NaN mm""#, r#""NaN mm" is not a finite number
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "NaN mm"
   |          ^^^^^^^^
"#;

    infinite r#""390 mm""# => r#""-inf mm""#, r#""-inf mm" is not a finite number
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "-inf mm"
   |          ^^^^^^^^^
"#;

    too_large r#""390 mm""# => r#""1e999 mm""#, r#""1e999 mm" is too large to compute with
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "1e999 mm"
   |          ^^^^^^^^^^
"#;

    vector_of_two r#""[0, 0, 0.01] N m""# => r#""[0, 0] N m""#, r#"found a list of 2, expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "[0, 0] N m"
   |          ^^^^^^^^^^^^
"#;

    vector_as_array r#""[0, 0, 0.01] N m""# => "[0, 0, 0.01]", r#"found a list without a unit, expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = [0, 0, 0.01]
   |          ^^^^^^^^^^^^
"#;

    vector_expected r#""[0, 0, 0.01] N m""# => r#""0.01 N m""#, r#"found "0.01 N m", expected three components, such as "[0, 0, 1] N m"
  --> rod.toml:23:10, key load.1.moment
   |
23 | moment = "0.01 N m"
   |          ^^^^^^^^^^
"#;

}
