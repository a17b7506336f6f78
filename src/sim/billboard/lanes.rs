//! Nodes of several billboards side by side: an array over billboards for each coordinate of each node.
//!
//! Loops over the lanes of an array have a fixed length and no branches, so that the compiler makes
//! vector instructions of them. One lane is a billboard by itself, with the same operations.

use crate::base::{Real, Vec3};

/// Nodes of `L` billboards.
#[derive(Clone, Debug)]
pub struct Lanes<R, const L: usize> {
    pub x: Vec<[R; L]>,
    pub y: Vec<[R; L]>,
    pub z: Vec<[R; L]>,
}

impl<R: Real, const L: usize> Lanes<R, L> {
    pub fn new(nodes: usize) -> Self {
        let zeros = || vec![[R::ZERO; L]; nodes];
        Self {
            x: zeros(),
            y: zeros(),
            z: zeros(),
        }
    }

    pub fn len(&self) -> usize {
        self.x.len()
    }

    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    pub fn get(&self, node: usize, lane: usize) -> Vec3<R> {
        Vec3::new(self.x[node][lane], self.y[node][lane], self.z[node][lane])
    }

    pub fn set(&mut self, node: usize, lane: usize, to: Vec3<R>) {
        self.x[node][lane] = to.x;
        self.y[node][lane] = to.y;
        self.z[node][lane] = to.z;
    }

    /// Takes over all lanes of all nodes.
    pub fn copy_all(&mut self, from: &Self) {
        self.x.copy_from_slice(&from.x);
        self.y.copy_from_slice(&from.y);
        self.z.copy_from_slice(&from.z);
    }

    /// Takes over one lane of all nodes.
    pub fn copy_lane(&mut self, lane: usize, from: &Self) {
        for node in 0..self.len() {
            self.set(node, lane, from.get(node, lane));
        }
    }
}
