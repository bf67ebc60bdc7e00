//! Who may touch whom in a state of one large crowd, as the forces found it: whoever asks the same of that state need not
//! search again.

/// Pairs who may touch within a step.
#[derive(Clone, Copy, Debug)]
pub struct Close<'a> {
    /// Agents, the smaller number first, each pair once.
    pub(super) pairs: &'a [(u32, u32)],
    /// Between any other two who are in the scene is a gap of more than this, m, however it is rounded.
    pub(super) edge: f64,
}
