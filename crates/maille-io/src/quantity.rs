//! What a plot shows of a limit.

/// What is shown of a limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// 1 + l1, length over original length along the pull.
    #[default]
    Stretch,
    /// l1.
    L1,
    /// λ1 − 1, with λ1 the larger eigenvalue of C = FᵀF: what the thesis plots.
    Lambda1,
}
