//! Every indicator of every channel of a recording:
//! `cargo run --release -p hums --features io --example recording -- FILE RATE_HZ SPEED_HZ TEETH`,
//! rate 0 to take it from the file. The shaft turns at constant speed; blocks of samples are streamed.

use hums::difference::RemovalRule;
use hums::indicator::GearAnalyzer;
use hums::io::{open, text::TextOptions};
use hums::tachometer::Shaft;
use hums::tsa::{Averager, TsaOptions};
use std::error::Error;
use std::path::Path;

/// Samples a block; memory does not grow with the file.
const BLOCK: usize = 1 << 16;
/// Longest record a constant-speed shaft is laid out for, samples.
const LONGEST: usize = 1 << 40;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, rate, speed, teeth] = &arguments[..] else {
        return Err("give FILE RATE_HZ SPEED_HZ TEETH".into());
    };
    let mut reader = open(Path::new(file), &TextOptions::default())?;
    let (rate, speed, teeth): (f64, f64, usize) = (rate.parse()?, speed.parse()?, teeth.parse()?);
    let rate = if rate > 0.0 { rate } else { reader.rate().ok_or("the file states no rate")? };

    let shaft = Shaft::constant(speed, LONGEST, rate)?;
    let options = TsaOptions::per_turn(hums::resample::samples_per_period(rate, &shaft, 1.0)?);
    let names = reader.channels().to_vec();
    let mut averagers =
        names.iter().map(|_| Averager::new(rate, shaft.clone(), options.clone())).collect::<hums::Result<Vec<_>>>()?;
    let mut columns = vec![Vec::new(); names.len()];
    while reader.read_block(BLOCK, &mut columns)? > 0 {
        for (averager, column) in averagers.iter_mut().zip(&mut columns) {
            averager.push(column);
            column.clear();
        }
    }

    let rule = RemovalRule::sidebands(teeth, 1);
    let analyzer = GearAnalyzer::new(options.samples_per_period, &rule)?;
    for (name, averager) in names.iter().zip(averagers) {
        let average = averager.finish()?;
        println!(
            "\n{name}: {} blocks of {} samples, {} with gaps; noise floor {:.3e}",
            average.blocks,
            average.samples.len(),
            average.skipped,
            average.noise_floor()
        );
        for entry in analyzer.analyze(&average.samples)?.table {
            let value = match &entry.value {
                Ok(value) => format!("{value:.6}"),
                Err(reason) => format!("- ({reason})"),
            };
            println!("  {:<28} {:<14} {value}", entry.indicator.name(), entry.signal.name());
        }
    }
    Ok(())
}
