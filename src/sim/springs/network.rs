//! Nodes and springs of a blade's centre line or a billboard's mesh.
//!
//! O09 section 5.4 gives a billboard structural springs along its rows and columns and shear
//! springs along both diagonals of its cells; the lowest row stands in the ground. A blade has
//! structural springs along its segments and bend springs over every second node; its root is
//! pinned. Bend springs over every second node of a billboard are Provot's, and optional here.

use crate::base::{Real, Vec3};

use super::crumpled::AtRest;
use super::{literal, shares};

/// A spring between two nodes of which at least one is movable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring<R> {
    /// Indices of its nodes, the smaller one first.
    pub ends: [usize; 2],
    pub rest_length: R,
    /// Unit vector from the second to the first node at rest.
    pub rest_direction: Vec3<R>,
    /// r₁ and r₂.
    pub shares: [R; 2],
}

/// A network of springs. Its nodes are in an order in which every movable node has a spring to one
/// before it.
#[derive(Clone, Debug)]
pub struct Network<R> {
    /// Rest places of the nodes, in metres.
    pub rest: Vec<Vec3<R>>,
    pub pinned: Vec<bool>,
    /// Sorted by their later node.
    pub springs: Vec<Spring<R>>,
    /// λmax of the springs' stiffness at rest, with weight 2 beside pins; 0 without springs.
    pub largest_eigenvalue: f64,
    /// Springs of each node, as indices into `springs`.
    pub(super) of_node: Vec<Vec<usize>>,
    /// Earlier nodes that each node has a spring to.
    earlier: Vec<Vec<usize>>,
    /// The nodes are a blade's centre line, whose segments keep their lengths exactly.
    pub(super) is_blade: bool,
    /// Nodes in a row of a billboard; 0 for chains.
    pub(super) columns: usize,
}

/// Pairs of nodes of a blade's springs: its segments, then every second node.
pub fn blade_pairs(segments: usize) -> impl Iterator<Item = [usize; 2]> + Clone {
    let structural = (0..segments).map(|j| [j, j + 1]);
    let bend = (0..segments.saturating_sub(1)).map(|j| [j, j + 2]);
    structural.chain(bend)
}

/// Pairs of nodes of a billboard's springs: its rows and columns, both diagonals of its cells and, with
/// `bend`, every second node of rows and columns. The earlier node comes first.
pub fn billboard_pairs(columns: usize, rows: usize, bend: bool) -> Vec<[usize; 2]> {
    let at = |column: usize, row: usize| row * columns + column;
    let reach = if bend { 2 } else { 1 };
    let mut pairs = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let here = at(column, row);
            for far in 1..=reach {
                if column + far < columns {
                    pairs.push([here, at(column + far, row)]);
                }
                if row + far < rows {
                    pairs.push([here, at(column, row + far)]);
                }
            }
            if column + 1 < columns && row + 1 < rows {
                pairs.push([here, at(column + 1, row + 1)]);
                pairs.push([at(column + 1, row), at(column, row + 1)]);
            }
        }
    }
    pairs
}

/// Leaves out pairs of pinned nodes and sorts the others by their later node.
pub fn in_order(pairs: &mut Vec<[usize; 2]>, pinned: impl Fn(usize) -> bool) {
    pairs.retain(|pair| !(pinned(pair[0]) && pinned(pair[1])));
    pairs.sort_by_key(|pair| (pair[1], pair[0]));
}

/// Earlier nodes that each node is paired with, of pairs in order.
pub fn earlier_nodes(nodes: usize, pairs: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let mut earlier = vec![Vec::new(); nodes];
    for &[first, second] in pairs {
        earlier[second].push(first);
    }
    earlier
}

impl<R: Real> Network<R> {
    /// A blade whose centre line rests at `rest`, root first.
    pub fn blade(rest: &[Vec3<R>]) -> Self {
        let pinned = (0..rest.len()).map(|j| j == 0).collect();
        let pairs = blade_pairs(rest.len().saturating_sub(1));
        Self {
            is_blade: true,
            ..Self::new(rest.to_vec(), pinned, pairs)
        }
    }

    /// A chain of structural springs alone, whose lengths are not laid out: what the stability
    /// bounds of chains are about.
    pub fn chain(rest: &[Vec3<R>]) -> Self {
        let pinned = (0..rest.len()).map(|j| j == 0).collect();
        let segments = rest.len().saturating_sub(1);
        Self::new(rest.to_vec(), pinned, (0..segments).map(|j| [j, j + 1]))
    }

    /// A billboard of rows of `columns` nodes, the lowest row first and pinned. Nodes beyond the
    /// last whole row are left out. `bend` adds springs over every second node of rows and columns.
    pub fn billboard(rest: &[Vec3<R>], columns: usize, bend: bool) -> Self {
        let columns = columns.max(1);
        let rows = rest.len() / columns;
        let pairs = billboard_pairs(columns, rows, bend);
        let nodes = rest[..rows * columns].to_vec();
        let pinned = (0..nodes.len()).map(|j| j < columns).collect();
        Self {
            columns,
            ..Self::new(nodes, pinned, pairs.into_iter())
        }
    }

    fn new(rest: Vec<Vec3<R>>, pinned: Vec<bool>, pairs: impl Iterator<Item = [usize; 2]>) -> Self {
        let mut pairs: Vec<_> = pairs.collect();
        in_order(&mut pairs, |node| pinned[node]);
        let earlier = earlier_nodes(rest.len(), &pairs);
        let springs: Vec<Spring<R>> = pairs
            .into_iter()
            .map(|ends| {
                let across = rest[ends[0]] - rest[ends[1]];
                Spring {
                    ends,
                    rest_length: across.length(),
                    rest_direction: across.unit_or(-Vec3::UP),
                    shares: shares(ends.map(|end| pinned[end])).map(R::of),
                }
            })
            .collect();
        let mut of_node = vec![Vec::new(); rest.len()];
        for (index, spring) in springs.iter().enumerate() {
            for end in spring.ends {
                of_node[end].push(index);
            }
        }
        Self {
            largest_eigenvalue: literal::largest_eigenvalue(rest.len(), &springs),
            rest,
            pinned,
            springs,
            of_node,
            earlier,
            is_blade: false,
            columns: 0,
        }
    }

    /// What puts crumpled nodes back.
    pub(super) fn at_rest(&self) -> AtRest<'_, R> {
        AtRest {
            nodes: &self.rest,
            columns: self.columns,
            pinned: self.pinned.iter().take_while(|&&pinned| pinned).count(),
            earlier: &self.earlier,
        }
    }

    /// ½Σ(‖l‖ − l₀)², in m².
    pub fn energy(&self, nodes: &[Vec3<R>]) -> R {
        let half = R::of(0.5);
        self.springs.iter().fold(R::ZERO, |sum, spring| {
            let [a, b] = spring.ends;
            let longer = (nodes[a] - nodes[b]).length() - spring.rest_length;
            sum + half * longer * longer
        })
    }

    /// Largest relative change of a spring's length; bend springs of a blade may change theirs
    /// and are left out.
    pub fn strain(&self, nodes: &[Vec3<R>]) -> R {
        self.springs
            .iter()
            .filter(|spring| !self.is_blade || spring.ends[1] == spring.ends[0] + 1)
            .filter(|spring| spring.rest_length > R::ZERO)
            .fold(R::ZERO, |worst, spring| {
                let [a, b] = spring.ends;
                let length = (nodes[a] - nodes[b]).length();
                worst.max((length / spring.rest_length - R::ONE).abs())
            })
    }
}
