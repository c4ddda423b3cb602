//! The part of a sweep that one process does: of `n` shards, number `k` has every run whose number
//! leaves `k - 1` when divided by `n`.

use super::SweepError;

/// Shard `index` of `count`, from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    count: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Reads `3/7`.
    ///
    /// # Errors
    /// [`SweepError::Shard`].
    pub fn parse(text: &str) -> Result<Self, SweepError> {
        let numbers = text.split_once('/').and_then(|(index, count)| {
            Some((index.trim().parse().ok()?, count.trim().parse().ok()?))
        });
        let expected = "K/N with K from 1 to N, e.g. 3/7";
        let wrong = || SweepError::Shard { found: format!("the shard `{text}`"), expected };
        let (index, count) = numbers.ok_or_else(wrong)?;
        if (1..=count).contains(&index) { Ok(Self { index, count }) } else { Err(wrong()) }
    }

    /// The shard of a task of a Slurm array, whose first task has shard 1; none where the
    /// environment tells of no array.
    ///
    /// # Errors
    /// [`SweepError::Shard`] where the array's numbers are not evenly spaced.
    pub fn of_slurm(variable: &dyn Fn(&str) -> Option<String>) -> Result<Option<Self>, SweepError> {
        let number = |name: &str| variable(name)?.parse::<u64>().ok();
        let Some(task) = number("SLURM_ARRAY_TASK_ID") else { return Ok(None) };
        let first = number("SLURM_ARRAY_TASK_MIN");
        let last = number("SLURM_ARRAY_TASK_MAX");
        let wrong = || SweepError::Shard {
            found: format!("task {task} of a Slurm array"),
            expected: "an array of evenly spaced numbers, e.g. --array=1-7, or --shard K/N",
        };
        let (first, last) = first.zip(last).ok_or_else(wrong)?;
        let span = last.checked_sub(first).ok_or_else(wrong)?;
        let count = number("SLURM_ARRAY_TASK_COUNT").unwrap_or(span + 1).max(1);
        let step = if count > 1 { span / (count - 1) } else { 1 };
        let place = task.checked_sub(first).ok_or_else(wrong)?;
        let even = step > 0 && step * (count - 1) == span && place % step == 0 && place <= span;
        if even { Ok(Some(Self { index: place / step + 1, count })) } else { Err(wrong()) }
    }

    /// Whether run `run` is of this shard.
    pub fn has(self, run: u64) -> bool {
        run % self.count == self.index - 1
    }

    /// Whether it is all of the sweep.
    pub fn is_whole(self) -> bool {
        self.count == 1
    }

    /// Name of its log.
    pub fn log(self) -> String {
        format!("shard-{}-of-{}.log", self.index, self.count)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "shard {} of {}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_is_of_one_shard() {
        for count in [1, 2, 7] {
            let shards = (1..=count).map(|index| Shard { index, count });
            let shards: Vec<Shard> = shards.collect();
            for run in 0..100 {
                assert_eq!(shards.iter().filter(|shard| shard.has(run)).count(), 1);
            }
        }
    }

    #[test]
    fn only_shards_are_shards() {
        assert_eq!(Shard::parse("3/7").expect("a shard"), Shard { index: 3, count: 7 });
        for text in ["0/7", "8/7", "3", "3/", "/7", "a/b", "-1/7", "1/0"] {
            assert!(Shard::parse(text).is_err(), "{text}");
        }
    }

    /// As `man sbatch` describes the variables.
    #[test]
    fn slurm_tells_the_shard() {
        let of = |task: u64, [least, most, count]: [u64; 3]| {
            let variable = |name: &str| {
                let number = match name {
                    "SLURM_ARRAY_TASK_ID" => task,
                    "SLURM_ARRAY_TASK_MIN" => least,
                    "SLURM_ARRAY_TASK_MAX" => most,
                    "SLURM_ARRAY_TASK_COUNT" => count,
                    _ => return None,
                };
                Some(number.to_string())
            };
            Shard::of_slurm(&variable).ok().flatten().map(|shard| (shard.index, shard.count))
        };
        assert_eq!(of(1, [1, 7, 7]), Some((1, 7)));
        assert_eq!(of(7, [1, 7, 7]), Some((7, 7)));
        assert_eq!(of(0, [0, 3, 4]), Some((1, 4)));
        assert_eq!(of(5, [3, 5, 2]), Some((2, 2)), "--array=3,5");
        assert_eq!(of(9, [1, 13, 4]), Some((3, 4)), "--array=1-13:4");
        assert_eq!(of(4, [4, 4, 1]), Some((1, 1)));
        assert_eq!(of(3, [1, 7, 3]), None, "--array=1,3,7");
        assert_eq!(Shard::of_slurm(&|_| None).expect("no array"), None);
    }
}
