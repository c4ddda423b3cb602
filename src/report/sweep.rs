//! Text about a sweep.

use crate::quantity::engineering;
use crate::sweep::gather::Gap;
use crate::sweep::summary::{Failure, GatherSummary, SweepSummary};

/// Gaps that are named one by one.
const NAMED_GAPS: usize = 10;

/// Output of `sweep`.
pub fn sweep(summary: &SweepSummary) -> String {
    let SweepSummary { sweep, scene, runs, of_shard, finished_before, done, .. } = summary;
    let part = summary.shard.as_ref().map_or(String::new(), |s| format!(", {s}: {of_shard} runs"));
    let accuracy = summary
        .accuracy
        .map_or("each scene's accuracy".to_owned(), |accuracy| format!("accuracy {accuracy:e}"));
    let threads = if summary.threads == 1 { "thread" } else { "threads" };
    let mut lines = vec![
        format!("{sweep}: {} of {scene}{part}", counted(*runs)),
        format!("  at {accuracy}, {}, {} {threads}", summary.instructions, summary.threads),
    ];
    if *finished_before > 0 {
        lines.push(format!("  before      {}", counted(*finished_before)));
    }
    let rate = *done as f64 / summary.wall_s.max(1e-9);
    let speed = if *done > 0 {
        format!(" in {}, {rate:.0} a second", engineering(summary.wall_s, "s", 3))
    } else {
        String::new()
    };
    lines.push(format!("  now         {}{speed}", counted(*done)));
    if let Some(gathering) = &summary.gathered {
        lines.extend(results(gathering));
    } else {
        lines.extend(failures(summary.failed, summary.first_failed.as_ref()));
        lines.push(format!("  log         {}", summary.log));
    }
    lines.join("\n")
}

/// Output of `gather`.
pub fn gathering(gathering: &GatherSummary) -> String {
    let GatherSummary { folder, logs, runs, finished, .. } = gathering;
    let files = if *logs == 1 { "log" } else { "logs" };
    let mut lines = vec![format!("{folder}: {finished} of {} in {logs} {files}", counted(*runs))];
    lines.extend(results(gathering));
    lines.join("\n")
}

fn results(gathering: &GatherSummary) -> Vec<String> {
    let mut lines = failures(gathering.failed, gathering.first_failed.as_ref());
    let missing: u64 = gathering.missing.iter().map(|gap| gap.last - gap.first + 1).sum();
    if missing > 0 {
        let gaps = gathering.missing.iter().take(NAMED_GAPS).map(gap);
        let more = gathering.missing.len().saturating_sub(NAMED_GAPS);
        let more = if more > 0 { format!(" and {more} more rows") } else { String::new() };
        let gaps = gaps.collect::<Vec<_>>().join(", ");
        lines.push(format!("  missing     {}: {gaps}{more}", counted(missing)));
    }
    lines.extend(gathering.tables.iter().map(|table| format!("  table       {table}")));
    lines
}

fn failures(failed: u64, first: Option<&Failure>) -> Vec<String> {
    let Some(Failure { run, reason }) = first else { return Vec::new() };
    vec![format!("  no results  {}; the first, run {run}: {reason}", counted(failed))]
}

fn gap(gap: &Gap) -> String {
    if gap.first == gap.last {
        gap.first.to_string()
    } else {
        format!("{}-{}", gap.first, gap.last)
    }
}

fn counted(runs: u64) -> String {
    if runs == 1 { "1 run".to_owned() } else { format!("{runs} runs") }
}
