//! Robot files that an experiment names.

use crate::*;

edits! { in_rod ROD:
    robot_wrong r#""390 mm""# => r#""390 N""#, r#"found a force, expected a length, such as "390 mm"
  --> lab/rod.toml:16:10, key section.rod.length
   |
16 | length = "390 N"
   |          ^^^^^^^
"#;

}
