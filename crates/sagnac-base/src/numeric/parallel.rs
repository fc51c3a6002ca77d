//! Work side by side on all cores. What shares the work out sees only numbers of tasks, so that it is compiled once and not
//! for every task.

use std::sync::OnceLock;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// The values of `value` at 0 to `count`, in this order.
pub fn map<T: Send + Sync>(count: usize, value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let slots: Vec<OnceLock<T>> = (0..count).map(|_| OnceLock::new()).collect();
    for_each(count, &|i| {
        slots[i].get_or_init(|| value(i));
    });
    slots.into_iter().filter_map(OnceLock::into_inner).collect()
}

/// The value of each item, in their order.
pub fn map_items<S: Sync, T: Send + Sync>(items: &[S], value: impl Fn(&S) -> T + Sync) -> Vec<T> {
    map(items.len(), |i| value(&items[i]))
}

fn for_each(count: usize, task: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(task);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_the_order_of_their_tasks() {
        assert_eq!(map(1000, |i| i * i), (0..1000).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(map_items(&["a", "bc"], |s| s.len()), [1, 2]);
        assert!(map(0, |i| i).is_empty());
    }
}
