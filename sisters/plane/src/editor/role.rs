/// Whether an object of a map hides what is behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Role {
    /// It hides nothing.
    #[default]
    Plain,
    /// It hides.
    Wall,
    /// It hides until it is opened.
    Door,
}
