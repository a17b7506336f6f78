//! The drawn mesh: which diamonds are split, changed from frame to frame (ROAM, Duchaineau et al.
//! 1997).
//!
//! Two queues lead each change: unsplit diamonds with a triangle in the mesh, most urgent first,
//! and split ones of which nothing is split further, least urgent first. Every viewpoint changes
//! all urgencies, so the queues are filled anew from the mesh of the frame before; the work of
//! splitting and merging is that of what changed. Deviation: neighbours are not linked but follow
//! from a diamond's coordinates, so the mesh is a byte per sample and the list of split points.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use super::Bintree;
use super::geometry::{Diamond, Point, Triangle};
use super::lattice::Side;
use super::urgency::{Judge, MeshDetail};
use super::viewpoint::Viewpoint;

/// Marks of a lattice point.
const SPLIT: u8 = 1;
const LISTED: u8 = 2;

/// A mesh over one terrain.
#[derive(Clone, Debug)]
pub struct Mesh {
    marks: Vec<u8>,
    /// Points marked as listed: all that are split, and some that were.
    listed: Vec<u32>,
    pins: HashSet<u32>,
    pinned: Vec<[Point; 2]>,
    triangles: usize,
    last: Option<(Viewpoint, MeshDetail, MeshChange)>,
}

/// What a change of the mesh did, and what it left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshChange {
    pub triangles: usize,
    pub splits: usize,
    pub merges: usize,
    /// Largest error left, in pixels. Above the error that need not be mended it is one in the
    /// picture.
    pub worst_px: f32,
    /// The budget kept diamonds from being split that should have been.
    pub is_bound: bool,
}

/// Why a mesh cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    #[error("a budget of {budget} triangles is below the {roots} that the terrain has unsplit")]
    BudgetTooSmall { budget: usize, roots: usize },
}

/// An urgency and a point, ordered by both; urgencies are never negative, so their bits order
/// like their values.
fn entry(urgency: f32, index: usize) -> u64 {
    u64::from(urgency.to_bits()) << 32 | index as u64
}

fn urgency_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

struct Queues {
    split: BinaryHeap<u64>,
    merge: BinaryHeap<Reverse<u64>>,
}

impl Mesh {
    pub fn new(tree: &Bintree) -> Self {
        Self {
            marks: vec![0; tree.lattice.points()],
            listed: Vec::new(),
            pins: HashSet::new(),
            pinned: Vec::new(),
            triangles: root_count(tree),
            last: None,
        }
    }

    /// Triangles of the whole mesh, in view or not.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Bytes the mesh keeps.
    pub fn bytes(&self) -> usize {
        self.marks.capacity() + self.listed.capacity() * size_of::<u32>()
    }

    /// Keeps rectangles of the terrain at full resolution from the next update on, in view or
    /// not: first and last corner of each, in samples from the field's corner.
    pub fn pin(&mut self, tree: &Bintree, rectangles: Vec<[Point; 2]>) {
        if rectangles == self.pinned {
            return;
        }
        self.pins.clear();
        for rectangle in &rectangles {
            for root in tree.lattice.roots().flatten() {
                pin_below(tree, &mut self.pins, &root, rectangle);
            }
        }
        self.pinned = rectangles;
        self.last = None;
    }

    /// Splits and merges until every error is at most `detail.error_px` or the budget binds; then
    /// what is split is what was most urgent.
    ///
    /// # Errors
    /// A budget that does not even hold the unsplit roots.
    pub fn update(
        &mut self,
        tree: &Bintree,
        viewpoint: &Viewpoint,
        detail: &MeshDetail,
    ) -> Result<MeshChange, MeshError> {
        let roots = root_count(tree);
        if detail.budget < roots {
            let budget = detail.budget;
            return Err(MeshError::BudgetTooSmall { budget, roots });
        }
        if let Some((v, d, change)) = &self.last
            && (v, d) == (viewpoint, detail)
        {
            return Ok(MeshChange {
                splits: 0,
                merges: 0,
                ..*change
            });
        }
        let pins = std::mem::take(&mut self.pins);
        let judge = Judge::new((&tree.lattice, &tree.wedgies), viewpoint, detail, &pins);
        let mut change = MeshChange::default();
        let mut queues = self.fill_queues(tree, &judge);
        self.merge_idle(tree, &judge, detail, &mut queues, &mut change);
        self.split_urgent(tree, &judge, detail, &mut queues, &mut change);
        self.pins = pins;
        change.triangles = self.triangles;
        self.last = Some((*viewpoint, *detail, change));
        Ok(change)
    }

    /// Both queues for the mesh as it is.
    fn fill_queues(&mut self, tree: &Bintree, judge: &Judge<'_>) -> Queues {
        let marks = &mut self.marks;
        self.listed.retain(|&index| {
            let mark = &mut marks[index as usize];
            if *mark & SPLIT == 0 {
                *mark = 0;
            }
            *mark != 0
        });
        let (mut split, mut merge) = (Vec::new(), Vec::new());
        let mut wants = |diamond: &Diamond| {
            let urgency = judge.urgency(diamond);
            if urgency > 0.0 {
                split.push(entry(urgency, tree.lattice.index(diamond.centre)));
            }
        };
        for [root, _] in tree.lattice.roots() {
            if let Some(diamond) = root.split_point().and_then(|p| tree.diamond(p))
                && !self.is_split(tree, diamond.centre)
            {
                wants(&diamond);
            }
        }
        for &index in &self.listed {
            let centre = tree.lattice.point(index);
            let Some(diamond) = tree.diamond(centre) else {
                continue;
            };
            let mut is_leaf = true;
            for child in diamond.children().filter_map(|p| tree.diamond(p)) {
                if self.is_split(tree, child.centre) {
                    is_leaf = false;
                    continue;
                }
                // A child of two split points is listed once.
                let [a, b] = child.parents();
                let other = if a == centre { b } else { a };
                let is_others = tree.lattice.holds(other)
                    && self.is_split(tree, other)
                    && tree.lattice.index(other) < index as usize;
                if !is_others {
                    wants(&child);
                }
            }
            if is_leaf {
                merge.push(Reverse(entry(judge.urgency(&diamond), index as usize)));
            }
        }
        Queues {
            split: split.into(),
            merge: merge.into(),
        }
    }

    /// Merges what need not be split, and what a lowered budget no longer holds.
    fn merge_idle(
        &mut self,
        tree: &Bintree,
        judge: &Judge<'_>,
        detail: &MeshDetail,
        queues: &mut Queues,
        change: &mut MeshChange,
    ) {
        while let Some(least) = self.least_urgent(tree, queues) {
            if urgency_of(least) > detail.error_px && self.triangles <= detail.budget {
                break;
            }
            self.merge(tree, judge, least, queues);
            change.merges += 1;
        }
    }

    /// Splits what is urgent, most urgent first, at the cost of what is less so.
    fn split_urgent(
        &mut self,
        tree: &Bintree,
        judge: &Judge<'_>,
        detail: &MeshDetail,
        queues: &mut Queues,
        change: &mut MeshChange,
    ) {
        // What was merged for want of budget is not split again before the next frame.
        let mut floor = detail.error_px;
        while let Some(most) = self.most_urgent(tree, queues) {
            let urgency = urgency_of(most);
            change.worst_px = Judge::error_px(urgency);
            change.is_bound = urgency > detail.error_px;
            if urgency <= floor {
                return;
            }
            let point = tree.lattice.point(most as u32);
            let mut chain = self.chain(tree, point);
            while self.triangles.saturating_add_signed(added(tree, &chain)) > detail.budget {
                match self.least_urgent(tree, queues) {
                    Some(least) if urgency_of(least) < urgency => {
                        floor = floor.max(urgency_of(least));
                        self.merge(tree, judge, least, queues);
                        change.merges += 1;
                        // What was merged may be one of the chain's parents.
                        chain = self.chain(tree, point);
                    }
                    _ => return,
                }
            }
            change.splits += chain.len();
            for diamond in chain {
                self.split(tree, judge, &diamond, queues);
            }
        }
        (change.worst_px, change.is_bound) = (0.0, false);
    }

    /// The diamonds to be split so that `point` may be, that one last.
    fn chain(&self, tree: &Bintree, point: Point) -> Vec<Diamond> {
        let mut chain = Vec::new();
        self.extend_chain(tree, point, &mut chain);
        chain
    }

    fn extend_chain(&self, tree: &Bintree, point: Point, chain: &mut Vec<Diamond>) {
        let Some(diamond) = tree.diamond(point) else {
            return;
        };
        if self.is_split(tree, point) || chain.contains(&diamond) {
            return;
        }
        for parent in diamond.parents() {
            self.extend_chain(tree, parent, chain);
        }
        chain.push(diamond);
    }

    fn split(&mut self, tree: &Bintree, judge: &Judge<'_>, diamond: &Diamond, queues: &mut Queues) {
        let index = tree.lattice.index(diamond.centre);
        if self.marks[index] & LISTED == 0 {
            self.listed.push(index as u32);
        }
        self.marks[index] = SPLIT | LISTED;
        let added = added(tree, std::slice::from_ref(diamond));
        self.triangles = self.triangles.saturating_add_signed(added);
        let urgency = judge.urgency(diamond);
        queues.merge.push(Reverse(entry(urgency, index)));
        for child in diamond.children().filter_map(|p| tree.diamond(p)) {
            let urgency = judge.urgency(&child);
            if urgency > 0.0 {
                let index = tree.lattice.index(child.centre);
                queues.split.push(entry(urgency, index));
            }
        }
    }

    fn merge(&mut self, tree: &Bintree, judge: &Judge<'_>, least: u64, queues: &mut Queues) {
        let index = least as u32 as usize;
        self.marks[index] &= !SPLIT;
        let Some(diamond) = tree.diamond(tree.lattice.point(index as u32)) else {
            return;
        };
        let added = added(tree, std::slice::from_ref(&diamond));
        self.triangles = self.triangles.saturating_add_signed(-added);
        if urgency_of(least) > 0.0 {
            queues.split.push(least);
        }
        for parent in diamond
            .parents()
            .into_iter()
            .filter_map(|p| tree.diamond(p))
        {
            if self.is_leaf(tree, &parent) {
                let urgency = judge.urgency(&parent);
                let index = tree.lattice.index(parent.centre);
                queues.merge.push(Reverse(entry(urgency, index)));
            }
        }
    }

    /// First of the split queue that still holds; it is taken out only when it no longer does.
    fn most_urgent(&self, tree: &Bintree, queues: &mut Queues) -> Option<u64> {
        while let Some(&most) = queues.split.peek() {
            let point = tree.lattice.point(most as u32);
            let is_in_mesh = tree.diamond(point).is_some_and(|diamond| {
                (diamond.parents().into_iter())
                    .any(|p| tree.lattice.holds(p) && self.exists(tree, p))
            });
            if is_in_mesh && !self.is_split(tree, point) {
                return Some(most);
            }
            queues.split.pop();
        }
        None
    }

    /// First of the merge queue that still holds.
    fn least_urgent(&self, tree: &Bintree, queues: &mut Queues) -> Option<u64> {
        while let Some(&Reverse(least)) = queues.merge.peek() {
            let diamond = tree.diamond(tree.lattice.point(least as u32));
            if diamond.is_some_and(|d| self.is_leaf(tree, &d)) {
                return Some(least);
            }
            queues.merge.pop();
        }
        None
    }

    /// Whether a diamond is split and none of its quarters is.
    fn is_leaf(&self, tree: &Bintree, diamond: &Diamond) -> bool {
        self.is_split(tree, diamond.centre)
            && !(diamond.children()).any(|p| tree.lattice.holds(p) && self.is_split(tree, p))
    }

    /// Whether a point is a corner of the mesh.
    fn exists(&self, tree: &Bintree, point: Point) -> bool {
        tree.diamond(point).is_none() || self.is_split(tree, point)
    }

    pub(super) fn is_split(&self, tree: &Bintree, point: Point) -> bool {
        self.marks[tree.lattice.index(point)] & SPLIT != 0
    }
}

/// Triangles of the terrain when nothing is split.
fn root_count(tree: &Bintree) -> usize {
    let roots = tree.lattice.roots().flatten();
    roots
        .filter(|t| tree.lattice.side(t) != Side::Outside)
        .count()
}

/// Triangles that splitting adds to the mesh. Beyond a corner of the terrain it can take one away:
/// both halves of a straddling triangle may lie outside, and what they showed is another's.
fn added(tree: &Bintree, chain: &[Diamond]) -> isize {
    let is_drawn = |triangle: &Triangle| tree.lattice.side(triangle) != Side::Outside;
    let of_triangle = |triangle: Triangle, middle: Point| {
        if !is_drawn(&triangle) {
            return 0;
        }
        let halves = triangle.halves(middle);
        halves.iter().filter(|half| is_drawn(half)).count() as isize - 1
    };
    chain
        .iter()
        .flat_map(|d| d.triangles().map(|t| of_triangle(t, d.centre)))
        .sum()
}

fn pin_below(
    tree: &Bintree,
    pins: &mut HashSet<u32>,
    triangle: &Triangle,
    [first, last]: &[Point; 2],
) {
    let [low, high] = triangle.bounds();
    if (0..2).any(|i| low[i] >= last[i] || high[i] <= first[i]) {
        return;
    }
    if let Some(middle) = triangle.split_point() {
        pins.insert(tree.lattice.index(middle) as u32);
        for half in triangle.halves(middle) {
            pin_below(tree, pins, &half, &[*first, *last]);
        }
    }
}
