//! The bins of evaluated predictions as CSV.

use super::Evaluated;
use crate::report::number::plain;
use std::io;

/// `kind,property,bin,count,low,high,mean,share`, one row a bin, from 1.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl io::Write, report: &Evaluated) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(["kind", "property", "bin", "count", "low", "high", "mean", "share"])?;
    for kind in &report.kinds {
        for property in &kind.properties {
            let bins = property.quality.iter().flat_map(|quality| &quality.score.bins);
            for (number, bin) in (1_u32..).zip(bins) {
                let [low, high, mean, share] = [bin.low, bin.high, bin.mean, bin.share].map(plain);
                let (number, count) = (number.to_string(), bin.count.to_string());
                table.write_record([
                    &kind.name,
                    &property.name,
                    &number,
                    &count,
                    &low,
                    &high,
                    &mean,
                    &share,
                ])?;
            }
        }
    }
    table.flush()
}
