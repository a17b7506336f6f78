//! The grid of a refined billboard and the springs woven through it.
//!
//! O09 section 5.4: structural springs along rows and columns, shear springs along both diagonals of
//! every cell; the lowest row is pinned. Provot's bend springs over every second node of rows and
//! columns are optional. All billboards of a scene have the same grid, and every cell of one the same
//! four sides, so that a spring needs to know only which of six rest lengths is its own.

use crate::sim::springs::literal::any_pose_eigenvalue;
use crate::sim::springs::network::{billboard_pairs, earlier_nodes, in_order};
use crate::sim::springs::shares;

/// Fewest and most columns or rows.
pub const ALONG: [usize; 2] = [3, 9];

/// Columns and rows of nodes, the lowest row first; node `j` is in row `j / columns`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Grid {
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    /// A grid within the limits of [`ALONG`].
    ///
    /// # Errors
    ///
    /// Fewer or more columns or rows.
    pub fn new([columns, rows]: [u32; 2]) -> Result<Self, GridError> {
        let [fewest, most] = ALONG;
        let grid = Self {
            columns: columns as usize,
            rows: rows as usize,
        };
        for (along, asked) in [("columns", grid.columns), ("rows", grid.rows)] {
            if asked < fewest || asked > most {
                return Err(GridError { along, asked });
            }
        }
        Ok(grid)
    }

    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    /// Nodes that are not pinned.
    pub fn movable(&self) -> usize {
        self.nodes() - self.columns
    }

    /// Column and row of a node.
    pub fn place(&self, node: usize) -> [usize; 2] {
        [node % self.columns, node / self.columns]
    }
}

/// A grid that no billboard has.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "a refined billboard of {asked} {along} is asked for; it has {} to {} of them",
    ALONG[0],
    ALONG[1]
)]
pub struct GridError {
    along: &'static str,
    asked: usize,
}

/// Which of a billboard's rest lengths a spring has.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Side {
    /// Between neighbours of a row, and of a column.
    Row,
    Column,
    /// From a node to the next column of the next row, and to the column before.
    Rising,
    Falling,
    /// Between every second node of a row, and of a column.
    RowBend,
    ColumnBend,
}

/// Kinds of sides.
pub const SIDES: usize = 6;

impl Side {
    /// Columns and rows from the earlier node to the later one.
    pub fn steps(self) -> [i32; 2] {
        match self {
            Self::Row => [1, 0],
            Self::Column => [0, 1],
            Self::Rising => [1, 1],
            Self::Falling => [-1, 1],
            Self::RowBend => [2, 0],
            Self::ColumnBend => [0, 2],
        }
    }

    pub const ALL: [Self; SIDES] = [
        Self::Row,
        Self::Column,
        Self::Rising,
        Self::Falling,
        Self::RowBend,
        Self::ColumnBend,
    ];

    pub fn is_bend(self) -> bool {
        matches!(self, Self::RowBend | Self::ColumnBend)
    }
}

/// A spring, without its rest length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// The earlier node first.
    pub ends: [usize; 2],
    pub side: Side,
    /// r₁ and r₂.
    pub shares: [f64; 2],
}

/// The springs of a grid, sorted by their later node.
#[derive(Clone, Debug)]
pub struct Weave {
    pub grid: Grid,
    pub springs: Vec<Thread>,
    /// Springs of each node, as indices.
    pub of_node: Vec<Vec<usize>>,
    /// Earlier nodes that each node has a spring to.
    pub earlier: Vec<Vec<usize>>,
    /// λmax of the springs' stiffness in any pose and for any lengths, with weight 2 beside pins.
    pub largest_eigenvalue: f64,
}

impl Weave {
    /// `bend` adds springs over every second node of rows and columns.
    pub fn new(grid: Grid, bend: bool) -> Self {
        let pinned = |node: usize| node < grid.columns;
        let mut pairs = billboard_pairs(grid.columns, grid.rows, bend);
        in_order(&mut pairs, pinned);
        let mut of_node = vec![Vec::new(); grid.nodes()];
        for (index, ends) in pairs.iter().enumerate() {
            for &end in ends {
                of_node[end].push(index);
            }
        }
        Self {
            grid,
            earlier: earlier_nodes(grid.nodes(), &pairs),
            largest_eigenvalue: any_pose_eigenvalue(grid.nodes(), pairs.iter().copied(), pinned),
            springs: pairs
                .iter()
                .map(|&ends| Thread {
                    ends,
                    side: side(grid, ends),
                    shares: shares(ends.map(pinned)),
                })
                .collect(),
            of_node,
        }
    }

    /// Whether there are springs over every second node.
    pub fn has_bends(&self) -> bool {
        self.springs.iter().any(|spring| spring.side.is_bend())
    }
}

fn side(grid: Grid, [earlier, later]: [usize; 2]) -> Side {
    let ([c0, r0], [c1, r1]) = (grid.place(earlier), grid.place(later));
    let steps = [c1 as i32 - c0 as i32, r1 as i32 - r0 as i32];
    let found = Side::ALL.into_iter().find(|side| side.steps() == steps);
    found.unwrap_or(Side::Row)
}
