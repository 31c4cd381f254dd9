//! Experiment files.

use crate::*;

edits! { in_experiment EXPERIMENT:
    missing_column r#"column = "mass""# => r#"column = "mas""#, r#"lab/table.csv has no column "mas"
 --> lab/bench.toml:7:10, key vary.1.column
  |
7 | column = "mas"
  |          ^^^^^
hint: did you mean "mass"?
"#;

    missing_column_unlike_any r#"column = "mass""# => r#"column = "load""#, r#"lab/table.csv has no column "load"
 --> lab/bench.toml:7:10, key vary.1.column
  |
7 | column = "load"
  |          ^^^^^^
hint: its columns: mass [g], tip x [mm], tip y [mm], error [mm], error [%], angle [deg]
"#;

    column_of_another_kind r#"column = "mass""# => r#"column = "tip x""#, r#"found a length, expected a mass, such as "20 g"
 --> lab/table.csv:2:10
  |
2 | mass [g],tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  |          ^^^^^^^^^^
"#;

    column_named_twice r#"x = "tip x""# => r#"x = "error""#, r#"lab/table.csv has several columns "error"
  --> lab/bench.toml:12:5, key measure.1.x
   |
12 | x = "error"
   |     ^^^^^^^
hint: give the whole header, which must be unique: error [mm] or error [%]
"#;

    two_angles "# bench" => r#"[bench]
mount_angle = "30 deg"
[[vary]]
quantity = "mount_angle"
column = "angle""#, r#"the mount angle is both varied here and fixed in [bench]
  --> lab/bench.toml:22:12, key vary.2.quantity
   |
22 | quantity = "mount_angle"
   |            ^^^^^^^^^^^^^
"#;

    unknown_variation r#""hung_mass""# => r#""weight""#, r#"found "weight", expected "hung_mass", "mount_angle", "force", "displacement" or "tension"
 --> lab/bench.toml:6:12, key vary.1.quantity
  |
6 | quantity = "weight"
  |            ^^^^^^^^
"#;

    direction_of_a_mass r#"quantity = "hung_mass""# => r#"quantity = "hung_mass"
direction = [0, 1, 0]"#, r#""direction" does not apply to hung_mass
 --> lab/bench.toml:7:13, key vary.1.direction
  |
7 | direction = [0, 1, 0]
  |             ^^^^^^^^^
"#;

    force_without_direction r#"quantity = "hung_mass""# => r#"quantity = "force""#, r#"missing key "direction", expected three numbers, such as [0, -1, 0]
 --> lab/bench.toml:5:1, key vary.1
  |
5 | [[vary]]
  | ^^^^^^^^
"#;

    point_beyond_the_tip r#"at = "tip" # point"# => r#"at = "1 m""#, r#"found "1 m", expected a length from 0 mm to the robot's length, 390 mm
  --> lab/bench.toml:11:6, key measure.1.at
   |
11 | at = "1 m"
   |      ^^^^^
"#;

    point_without_column r#"x = "tip x"
y = "tip y"
"# => "", r#"this point has no column: give one or more of x, y and z
  --> lab/bench.toml:10:1, key measure.1
   |
10 | [[measure]]
   | ^^^^^^^^^^^
"#;

    no_reading_error r#"reading_error = "0.5 mm"
"# => "", r#"missing key "reading_error", expected a length, such as "390 mm"
  --> lab/bench.toml:10:1, key measure.1
   |
10 | [[measure]]
   | ^^^^^^^^^^^
"#;

    bench_axes_parallel "# bench" => r#"[bench]
x = [0, 1, 0]"#, r#"the bench's x and y axes are parallel
  --> lab/bench.toml:20:5, key bench.x
   |
20 | x = [0, 1, 0]
   |     ^^^^^^^^^
"#;

    robot_file_missing r#"robot = "rod.toml""# => r#"robot = "rods.toml""#, r#"cannot read rods.toml: no such file
 --> lab/bench.toml:2:9, key robot
  |
2 | robot = "rods.toml"
  |         ^^^^^^^^^^^
"#;

    set_nowhere r#""section.rod.length""# => r#""section.bar.length""#, r#"the robot has no "bar" to set "section.bar.length" in
  --> lab/bench.toml:18:32, key variant.shorter.set.section.bar.length
   |
18 | set = { "section.bar.length" = "380 mm" }
   |                                ^^^^^^^^
"#;

    set_unknown_key r#""section.rod.length""# => r#""section.rod.lenght""#, r#"unknown key "lenght"
  --> lab/bench.toml:18:9, key variant.shorter.set.section.rod.lenght
   |
18 | set = { "section.rod.lenght" = "380 mm" }
   |         ^^^^^^^^^^^^^^^^^^^^
hint: did you mean "length"?
"#;

    set_impossible r#""section.rod.length" = "380 mm""# => r#""section.rod.length" = "-380 mm""#, r#"found "-380 mm", expected a length above 0 m
  --> lab/bench.toml:18:32, key variant.shorter.set.section.rod.length
   |
18 | set = { "section.rod.length" = "-380 mm" }
   |                                ^^^^^^^^^
"#;

}
