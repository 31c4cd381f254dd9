//! `[[load]]`.

use crate::*;

edits! { robot_error ROD:
    load_beyond_the_tip r#"at = "tip""# => r#"at = "400 mm""#, r#"found "400 mm", expected a length from 0 mm to the robot's length, 390 mm
  --> rod.toml:22:6, key load.1.at
   |
22 | at = "400 mm"
   |      ^^^^^^^^
"#;

    load_at_no_place r#"at = "tip""# => r#"at = "end""#, r#"found "end", expected "tip" or an arc length, such as "120 mm"
  --> rod.toml:22:6, key load.1.at
   |
22 | at = "end"
   |      ^^^^^
"#;

    load_without_place r#"at = "tip"
"# => "", r#"missing key "at", expected "tip" or an arc length, such as "120 mm"
  --> rod.toml:21:1, key load.1
   |
21 | [[load]]
   | ^^^^^^^^
"#;

    load_of_nothing r#"moment = "[0, 0, 0.01] N m"
"# => "", r#"this load has no force, moment, mass, force_per_length or moment_per_length
  --> rod.toml:21:1, key load.1
   |
21 | [[load]]
   | ^^^^^^^^
"#;

    load_mass_and_force r#"moment = "[0, 0, 0.01] N m""# => r#"mass = "20 g"
force = "[0, -0.2, 0] N""#, r#""mass" and "force" cannot stand in one load: a hung mass acts by its weight
  --> rod.toml:24:9, key load.1.force
   |
24 | force = "[0, -0.2, 0] N"
   |         ^^^^^^^^^^^^^^^^
hint: loads add up: write a second [[load]]
"#;

    load_at_and_along r#"at = "tip""# => r#"at = "tip"
from = "10 mm""#, r#"a load acts either at a point (at) or along a stretch (from, to)
  --> rod.toml:23:8, key load.1.from
   |
23 | from = "10 mm"
   |        ^^^^^^^
"#;

    load_along_nothing r#"at = "tip"
moment = "[0, 0, 0.01] N m""# => r#"from = "200 mm"
to = "100 mm"
force_per_length = "[0, 1, 0] N/m""#, r#"the load's stretch, 200 mm to 100 mm, has no length
  --> rod.toml:22:8, key load.1.from
   |
22 | from = "200 mm"
   |        ^^^^^^^^
"#;

    load_frame r#"at = "tip""# => r#"at = "tip"
frame = "tool""#, r#"found "tool", expected "world" (a dead load) or "body" (follows the section)
  --> rod.toml:23:9, key load.1.frame
   |
23 | frame = "tool"
   |         ^^^^^^
"#;

    negative_mass r#"moment = "[0, 0, 0.01] N m""# => r#"mass = "-20 g""#, r#"found "-20 g", expected a mass of at least 0 kg
  --> rod.toml:23:8, key load.1.mass
   |
23 | mass = "-20 g"
   |        ^^^^^^^
"#;

}
