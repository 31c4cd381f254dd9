//! `[[section]]`, its profile and its guides.

use crate::*;

edits! { robot_error ROD:
    negative_length r#""390 mm""# => r#""-390 mm""#, r#"found "-390 mm", expected a length above 0 m
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "-390 mm"
   |          ^^^^^^^^^
"#;

    zero_length r#""390 mm""# => r#""0 mm""#, r#"found "0 mm", expected a length above 0 m
  --> rod.toml:16:10, key section.rod.length
   |
16 | length = "0 mm"
   |          ^^^^^^
"#;

    section_in_single_brackets "[[section]]" => "[section]", r#"found a table, expected [[section]] in double brackets, since there can be several
  --> rod.toml:14:1, key section
   |
14 | [section]
   | ^^^^^^^^^
"#;

    profile_as_text r#"{ diameter = "1.5 mm" }"# => r#""1.5 mm""#, r#"found "1.5 mm", expected a table
  --> rod.toml:18:11, key section.rod.profile
   |
18 | profile = "1.5 mm"
   |           ^^^^^^^^
"#;

    duplicate_name "# more" => r#"[[section]]
name = "rod"
"#, r#"the name "rod" is given twice
  --> rod.toml:25:8, key section.rod.name
   |
25 | name = "rod"
   |        ^^^^^
"#;

    bad_name r#"name = "rod""# => r#"name = "rod 1""#, r#"found "rod 1", expected a name of letters, digits, - and _
  --> rod.toml:15:8, key section.1.name
   |
15 | name = "rod 1"
   |        ^^^^^^^
"#;

    unknown_material r#"material = "niti""# => r#"material = "spring_stel""#, r#"unknown material "spring_stel"
  --> rod.toml:17:12, key section.rod.material
   |
17 | material = "spring_stel"
   |            ^^^^^^^^^^^^^
hint: did you mean "spring_steel"?
"#;

    unknown_material_unlike_any r#"material = "niti""# => r#"material = "wood""#, r#"unknown material "wood"
  --> rod.toml:17:12, key section.rod.material
   |
17 | material = "wood"
   |            ^^^^^^
hint: define [material.wood], or take one of niti, nitinol, spring_steel, stainless_steel, fibreglass, carbon, peek, abs, pla, ecoflex_00_30, dragon_skin_30
"#;

    bore_too_wide r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", inner_diameter = "1.6 mm" }"#, r#"the inner diameter at the section's base, 1.6 mm, must be below the outer diameter, 1.5 mm
  --> rod.toml:18:51, key section.rod.profile.inner_diameter
   |
18 | profile = { diameter = "1.5 mm", inner_diameter = "1.6 mm" }
   |                                                   ^^^^^^^^
"#;

    bore_too_wide_at_the_tip r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", inner_diameter = "1 mm", tip_diameter = "0.8 mm" }"#, r#"the inner diameter at the section's tip, 1 mm, must be below the outer diameter, 0.8 mm
  --> rod.toml:18:11, key section.rod.profile
   |
18 | profile = { diameter = "1.5 mm", inner_diameter = "1 mm", tip_diameter = "0.8 mm" }
   |           ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
"#;

    round_and_strip r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", height = "1 mm" }"#, r#"a profile is either round (diameter) or a strip (width and height)
  --> rod.toml:18:24, key section.rod.profile.diameter
   |
18 | profile = { diameter = "1.5 mm", height = "1 mm" }
   |                        ^^^^^^^^
"#;

    negative_shear_coefficient r#"{ diameter = "1.5 mm" }"# => r#"{ diameter = "1.5 mm", shear_coefficient = -1 }"#, r#"found -1, expected a number above 0, such as 0.9
  --> rod.toml:18:54, key section.rod.profile.shear_coefficient
   |
18 | profile = { diameter = "1.5 mm", shear_coefficient = -1 }
   |                                                      ^^
"#;

    rest_curvature_folds r#"material = "niti""# => r#"material = "niti"
rest_curvature = "[1400, 0, 0] 1/m""#, r#"a rod this thick cannot be bent this much: its inner side would overlap itself
  --> rod.toml:18:18, key section.rod.rest_curvature
   |
18 | rest_curvature = "[1400, 0, 0] 1/m"
   |                  ^^^^^^^^^^^^^^^^^^
hint: curvature times half the thickness must be below 1, and is 1.050
"#;

    guides_two_ways "# guides" => r#"guides = { spacing = "10 mm", positions = "[10, 20] mm" }"#, r#""spacing" and "positions" are two ways to give the same thing
  --> rod.toml:19:43, key section.rod.guides.positions
   |
19 | guides = { spacing = "10 mm", positions = "[10, 20] mm" }
   |                                           ^^^^^^^^^^^^^
hint: keep one of them
"#;

    guides_no_way "# guides" => r#"guides = { mass = "1 g" }"#, r#"missing key "spacing", expected a length, such as "390 mm" (or "positions")
  --> rod.toml:19:10, key section.rod.guides
   |
19 | guides = { mass = "1 g" }
   |          ^^^^^^^^^^^^^^^^
"#;

    guide_outside "# guides" => r#"guides = { positions = "[10, 400] mm" }"#, r#"a guide at 400 mm is outside its section, 0 mm to 390 mm
  --> rod.toml:19:24, key section.rod.guides.positions
   |
19 | guides = { positions = "[10, 400] mm" }
   |                        ^^^^^^^^^^^^^^
"#;

    guides_out_of_order "# guides" => r#"guides = { positions = "[20, 10] mm" }"#, r#"guides must go from base to tip, but 10 mm follows 20 mm
  --> rod.toml:19:24, key section.rod.guides.positions
   |
19 | guides = { positions = "[20, 10] mm" }
   |                        ^^^^^^^^^^^^^
"#;

    guide_spacing_too_long "# guides" => r#"guides = { spacing = "1 m" }"#, r#"found "1 m", expected a length above 0 m and at most the section's length, 390 mm
  --> rod.toml:19:22, key section.rod.guides.spacing
   |
19 | guides = { spacing = "1 m" }
   |                      ^^^^^
"#;

    guides_without_number "# guides" => r#"guides = { spacing = "1 nm" }"#, r#"this spacing makes 390000000 guides, more than 10000
  --> rod.toml:19:22, key section.rod.guides.spacing
   |
19 | guides = { spacing = "1 nm" }
   |                      ^^^^^^
"#;

}
