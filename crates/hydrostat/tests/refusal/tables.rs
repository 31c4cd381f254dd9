//! Tables of measurements.

use crate::*;

edits! { in_table TABLE:
    column_given_twice "angle [deg]" => "mass [g]", r#"lab/table.csv has several columns "mass"
 --> lab/bench.toml:7:10, key vary.1.column
  |
7 | column = "mass"
  |          ^^^^^^
hint: give the whole header, which must be unique: mass [g] or mass [g]
"#;

    unit_missing_in_header "mass [g]" => "mass", r#"the column "mass" has no unit, expected a mass, such as "20 g"
 --> lab/table.csv:2:1
  |
2 | mass,tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  | ^^^^
hint: write the unit in brackets, as in "mass [kg]"
"#;

    unknown_unit_in_header "mass [g]" => "mass [gr]", r#"unknown unit "gr"
 --> lab/table.csv:2:1
  |
2 | mass [gr],tip x [mm],tip y [mm],error [mm],error [%],angle [deg]
  | ^^^^^^^^^
hint: did you mean "gf"?
"#;

    cell_not_a_number "300.5" => "300,5", r#"found 7 cells, but the header has 6
 --> lab/table.csv:4:1
  |
4 | 10,300,5,-100.25,1,2,0
  | ^^^^^^^^^^^^^^^^^^^^^^
hint: cells are separated by commas; decimals are written with a point
"#;

    cell_text "300.5" => "n/a", r#"found "n/a" in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,n/a,-100.25,1,2,0
  |    ^^^
"#;

    cell_nan "300.5" => "NaN", r#"found "NaN" in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,NaN,-100.25,1,2,0
  |    ^^^
"#;

    cell_empty "300.5" => "", r#"found an empty cell in column "tip x", expected a number
 --> lab/table.csv:4:4
  |
4 | 10,,-100.25,1,2,0
  |    ^
"#;

    negative_mass "10," => "-10,", r#"found a negative mass, expected at least 0
 --> lab/table.csv:4:1
  |
4 | -10,300.5,-100.25,1,2,0
  | ^^^
"#;

    row_too_short ",300.5,-100.25" => ",300.5", r#"found 5 cells, but the header has 6
 --> lab/table.csv:4:1
  |
4 | 10,300.5,1,2,0
  | ^^^^^^^^^^^^^^
hint: cells are separated by commas; decimals are written with a point
"#;

    no_rows r#"0,350.5,-20.00,1,2,0
10,300.5,-100.25,1,2,0
"# => "", r#"the file has no rows of data
 --> lab/table.csv:1:1
  |
1 | # hung masses
  | ^
"#;

}
