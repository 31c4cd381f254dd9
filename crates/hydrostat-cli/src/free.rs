//! What is free, as `calibrate` and `plan` are told.

use hydrostat::description::CalibrationFlags;

#[derive(clap::Args)]
pub(crate) struct FreeArgs {
    /// What may change, such as youngs_modulus,length; a+b gives several parts one value, * stands for every name
    #[arg(long = "free", value_name = "NAMES", value_delimiter = ',')]
    pub(crate) names: Vec<String>,
    /// What is known beforehand, such as "youngs_modulus=54 GPa +- 3 GPa"; may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    prior: Vec<String>,
    /// Between which values to stay, such as "length=380 mm to 400 mm"; may be repeated
    #[arg(long, value_name = "NAME=RANGE")]
    bounds: Vec<String>,
}

impl FreeArgs {
    /// With other names, where the command has some of its own.
    pub(crate) fn flags(&self, names: &[String]) -> CalibrationFlags {
        CalibrationFlags {
            free: names.to_vec(),
            prior: self.prior.clone(),
            bounds: self.bounds.clone(),
            ..CalibrationFlags::default()
        }
    }
}
