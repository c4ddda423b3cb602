//! stub
/// stub
pub fn run(_set: crate::recording::TraceSet, _title: String) -> std::io::Result<()> {
    Ok(())
}
