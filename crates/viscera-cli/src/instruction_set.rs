/// The instruction set that kernels run with on this machine, in lower case.
pub(crate) fn instruction_set() -> String {
    format!("{:?}", viscera::math::dispatch_level()).split(['(', ' ', '{']).next().unwrap_or_default().to_lowercase()
}
