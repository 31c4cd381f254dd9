//! `[[tendon]]` and `[actuation]`.

use crate::*;

edits! { robot_error ROD:
    tendon_that_ends_nowhere "# more" => r#"[[tendon]]
name = "a"
ends = "rood"
radius = "8 mm""#, r#"there is no section "rood" for the tendon to end at
  --> rod.toml:26:8, key tendon.a.ends
   |
26 | ends = "rood"
   |        ^^^^^^
hint: did you mean "rod"?
"#;

    two_inputs_for_one_tendon "# more" => r#"[[tendon]]
name = "a"
ends = "rod"
radius = "8 mm"
[actuation]
tension = { a = "2 N" }
displacement = { a = "2 mm" }"#, r#"tendon "a" is commanded twice, by tension and by displacement
  --> rod.toml:30:22, key actuation.displacement.a
   |
30 | displacement = { a = "2 mm" }
   |                      ^^^^^^
hint: keep one of them
"#;

    negative_tension "# more" => r#"[[tendon]]
name = "a"
ends = "rod"
radius = "8 mm"
[actuation]
tension = { a = "-2 N" }"#, r#"found a tension of -2 N, expected 0 N or more
  --> rod.toml:29:17, key actuation.tension.a
   |
29 | tension = { a = "-2 N" }
   |                 ^^^^^^
hint: a tendon only pulls
"#;

    command_of_no_tendon "# more" => r#"[[tendon]]
name = "left"
ends = "rod"
radius = "8 mm"
[actuation]
tension = { lft = "2 N" }"#, r#"there is no tendon "lft"
  --> rod.toml:29:19, key actuation.tension.lft
   |
29 | tension = { lft = "2 N" }
   |                   ^^^^^
hint: did you mean "left"?
"#;

    hole_outside_its_guide r#"# guides"# => r#"guides = { spacing = "10 mm", diameter = "15 mm" }
[[tendon]]
name = "a"
ends = "rod"
radius = "8 mm""#, r#"the hole at a radius of 8 mm lies outside the guide at s = 10 mm, whose radius is 7.5 mm
  --> rod.toml:23:10, key tendon.a.radius
   |
23 | radius = "8 mm"
   |          ^^^^^^
hint: use larger guides or a smaller radius
"#;
}
