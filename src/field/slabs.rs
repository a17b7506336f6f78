//! The pool of state slabs: a tile has one while it is active and gives it back after recovery.

/// Hands out the smallest free slab numbers. Which slab a tile got changes no result.
#[derive(Clone, Debug, Default)]
pub struct SlabPool {
    /// Returned slabs, kept as a heap so that the smallest number goes out first.
    free: std::collections::BinaryHeap<std::cmp::Reverse<u32>>,
    /// Slabs ever handed out.
    high_water: u32,
    limit: u32,
    /// Requests refused because the pool was full.
    pub refused: u64,
}

impl SlabPool {
    pub fn new(limit: u32) -> Self {
        Self {
            limit,
            ..Self::default()
        }
    }

    /// A slab, or `None` with the refusal counted when all are in use.
    pub fn take(&mut self) -> Option<u32> {
        if let Some(std::cmp::Reverse(slab)) = self.free.pop() {
            return Some(slab);
        }
        if self.high_water == self.limit {
            self.refused += 1;
            return None;
        }
        self.high_water += 1;
        Some(self.high_water - 1)
    }

    pub fn give_back(&mut self, slab: u32) {
        self.free.push(std::cmp::Reverse(slab));
    }

    /// Slabs in use.
    pub fn in_use(&self) -> u32 {
        self.high_water - self.free.len() as u32
    }

    /// One more than the largest slab number ever handed out.
    pub fn high_water(&self) -> u32 {
        self.high_water
    }

    /// Lowers the limit to what an engine can hold; slabs already in use stay.
    pub fn lower_limit(&mut self, limit: u32) {
        self.limit = self.limit.min(limit).max(self.high_water);
    }

    pub fn limit(&self) -> u32 {
        self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_come_back_and_the_limit_is_counted() {
        let mut pool = SlabPool::new(2);
        assert_eq!(
            (pool.take(), pool.take(), pool.take()),
            (Some(0), Some(1), None)
        );
        assert_eq!(pool.refused, 1);
        pool.give_back(0);
        assert_eq!(pool.in_use(), 1);
        assert_eq!(pool.take(), Some(0));
        assert_eq!(pool.high_water(), 2);
    }
}
