//! Where a report was made: without that, its times say nothing.

use std::fs;

/// What the times of a report depend on, a line each.
pub(super) fn lines() -> Vec<(&'static str, String)> {
    let cores = std::thread::available_parallelism().map_or_else(|_| "unknown".to_owned(), |n| n.to_string());
    let build = if cfg!(debug_assertions) {
        "with debug assertions: its times are not those of a release build"
    } else {
        "release"
    };
    vec![
        ("carom", env!("CARGO_PKG_VERSION").to_owned()),
        ("compiler", env!("CAROM_COMPILER").to_owned()),
        ("build", build.to_owned()),
        ("compiled for", format!("{} {}", std::env::consts::ARCH, std::env::consts::OS)),
        ("processor", processor().unwrap_or_else(|| "unknown".to_owned())),
        ("cores", format!("{cores}, of which one is used at a time")),
        ("system", system().unwrap_or_else(|| std::env::consts::OS.to_owned())),
    ]
}

/// The processor's name, where the system tells it.
fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn system() -> Option<String> {
    let release = fs::read_to_string("/proc/sys/kernel/osrelease").ok()?;
    Some(format!("Linux {}", release.trim()))
}
