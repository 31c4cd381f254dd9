#![allow(clippy::all)]
use hydrostat::description::*;
#[test] fn t() {
  println!("{:#?}", builtin::robot()); let e = builtin::experiment(); match e { Ok(e)=>println!("{:#?}", (e.value.published, e.value.inputs, e.value.points, e.value.rows.len(), e.value.variants.len(), e.warnings)), Err(e)=>println!("{e}") }
  builtin::fitted_experiment().unwrap();
  let files=templates::bench("my bench"); match parse_experiment(&files[0].text, "x/y.toml", &mut |p| Ok(files.iter().find(|f| f.name==p).unwrap().text.clone())) { Ok(e)=>println!("{:?}", e.value.rows), Err(e)=>println!("{e}")}
  println!("{:?}", parse_robot(&templates::rod("a").text, "a.toml").map(|r| r.value.loads));
  for t in ["", "# x\n", "name = ", "name = \"a\"\n[[section]]\nlength = 3\n", "name = \"a\"\n[material.x]\nyoungs_modulus = \"5 mm\"", "name = \"a\"\n[material.x]\nyoungs_modulus = \"5 GPa\"\npoisson_ratio=0.3", "nam = \"a\"", "name='a'\nname='b'","name='a'\n[[section]]\nname='q'\nlength='1 m'\n[[section]]\nname='q'\n"] {
     if let Err(e) = parse_robot(t, "f.toml") { println!("{e}\n") } }
}
