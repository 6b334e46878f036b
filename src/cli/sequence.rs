//! The arguments of commands that can write every frame of a config in place of the last one.

use clap::Args;

#[derive(Debug, Clone, Copy, PartialEq, Args)]
pub struct SequenceArgs {
    /// Write every frame, to DIR/frames: 0000.exr, 0000.png and so on
    #[arg(long)]
    pub sequence: bool,
    /// Take only part I of N of a sequence, every N-th frame, as in 2/4: many machines may fill the same folder, or folders of
    /// their own that are copied together afterwards
    #[arg(long, value_name = "I/N", value_parser = shard, requires = "sequence")]
    pub shard: Option<Shard>,
}

impl SequenceArgs {
    /// The frames of `0..count` that belong to this shard.
    pub fn frames(&self, count: u32) -> impl Iterator<Item = u32> + use<> {
        let Shard { part, of } = self.shard.unwrap_or(Shard { part: 1, of: 1 });
        (part - 1..count).step_by(of as usize)
    }

    /// Name of a file of the run, with the shard in it, so that the parts of a sequence go into one folder: `run.json`, or
    /// `run.2-of-4.json`.
    pub fn file_name(&self, stem: &str, ending: &str) -> String {
        match self.shard {
            Some(Shard { part, of }) => format!("{stem}.{part}-of-{of}.{ending}"),
            None => format!("{stem}.{ending}"),
        }
    }
}

/// Part `part` of `of` equal parts of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `of`.
    pub part: u32,
    pub of: u32,
}

impl Shard {
    /// Whether entry `number` of a list, counted from 0, belongs to this part.
    pub fn has(self, number: u32) -> bool {
        number % self.of == self.part - 1
    }
}

pub fn shard(text: &str) -> Result<Shard, String> {
    let parse = |(part, of): (&str, &str)| Some(Shard { part: part.trim().parse().ok()?, of: of.trim().parse().ok()? });
    text.split_once('/')
        .and_then(parse)
        .filter(|shard| (1..=shard.of).contains(&shard.part))
        .ok_or_else(|| "expects I/N with I from 1 to N, as in 2/4".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_a_sequence_are_all_of_it_and_each_frame_once() {
        for (count, of) in [(8, 3), (2, 5), (1, 1), (60, 7)] {
            let parts = (1..=of).flat_map(|part| SequenceArgs { sequence: true, shard: Some(Shard { part, of }) }.frames(count));
            let mut frames: Vec<u32> = parts.collect();
            frames.sort_unstable();
            assert_eq!(frames, (0..count).collect::<Vec<_>>());
        }
        let second = SequenceArgs { sequence: true, shard: Some(shard("2/4").unwrap()) };
        assert_eq!(second.frames(11).collect::<Vec<_>>(), [1, 5, 9]);
        assert_eq!(second.file_name("run", "json"), "run.2-of-4.json");
        assert_eq!(SequenceArgs { sequence: true, shard: None }.file_name("run", "json"), "run.json");
    }

    #[test]
    fn a_part_is_counted_from_1() {
        assert_eq!(shard("1/1"), Ok(Shard { part: 1, of: 1 }));
        for text in ["0/4", "5/4", "1", "a/b", "1/0", "-1/4", "1/4/2", ""] {
            assert!(shard(text).is_err(), "{text}");
        }
    }
}
