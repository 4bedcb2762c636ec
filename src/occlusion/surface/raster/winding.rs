//! Winding numbers of the pixels in a row, from the places where edges pass the middle of the row.

/// A place where the winding number changes, for all pixels from a column on.
#[derive(Debug, Default, Clone, Copy)]
struct Step {
    column: i16,
    by: i16,
}

/// Steps of a row that are kept in place.
const STEPS: usize = 7;

/// The steps of a row. Those beyond the first [`STEPS`] spill into a list of all rows.
#[derive(Debug, Default, Clone, Copy)]
struct Row {
    steps: [Step; STEPS],
    count: u32,
}

/// The steps of all rows of an area.
#[derive(Debug, Clone, Default)]
pub(super) struct Steps {
    rows: Vec<Row>,
    /// Steps that their rows had no room for.
    spilled: Vec<(i32, Step)>,
    sorted: Vec<Step>,
}

impl Steps {
    pub(super) fn clear(&mut self, height: i32) {
        let rows = height as usize;
        if self.rows.len() < rows {
            self.rows.resize(rows, Row::default());
        }
        self.rows[..rows].iter_mut().for_each(|r| r.count = 0);
        self.spilled.clear();
    }

    /// Changes the winding number in a row from a column on, which is inside the area.
    #[inline]
    pub(super) fn push(&mut self, row: i32, column: i32, by: i16) {
        let step = Step { column: column as i16, by };
        let own = &mut self.rows[row as usize];
        match own.steps.get_mut(own.count as usize) {
            Some(free) => *free = step,
            None => self.spilled.push((row, step)),
        }
        own.count += 1;
    }

    /// Calls `span` with runs of pixels of equal winding number: row, first column, end, number. Runs may be
    /// empty, and some with number zero are left out.
    #[inline]
    pub(super) fn for_spans(&mut self, height: i32, width: i32, mut span: impl FnMut(i32, i32, i32, i32)) {
        self.spilled.sort_by_key(|s| s.0);
        for row in 0..height {
            let own = self.rows[row as usize];
            let count = own.count as usize;
            if count == 0 {
                continue;
            }
            if count == 2 {
                let [a, b, ..] = own.steps;
                let (a, b) = if a.column <= b.column { (a, b) } else { (b, a) };
                span(row, a.column.into(), b.column.into(), a.by.into());
                span(row, b.column.into(), width, i32::from(a.by) + i32::from(b.by));
                continue;
            }
            self.sort(row, &own);
            let (mut winding, mut from) = (0i32, 0i32);
            for step in &self.sorted {
                let column = i32::from(step.column);
                span(row, from, column, winding);
                (winding, from) = (winding + i32::from(step.by), column);
            }
            span(row, from, width, winding);
        }
    }

    /// Puts the steps of a row in order of columns.
    #[inline(always)]
    fn sort(&mut self, row: i32, own: &Row) {
        let count = own.count as usize;
        self.sorted.clear();
        self.sorted.extend(&own.steps[..count.min(STEPS)]);
        if count > STEPS {
            let first = self.spilled.partition_point(|s| s.0 < row);
            self.sorted.extend(self.spilled[first..].iter().take_while(|s| s.0 == row).map(|s| s.1));
        }
        self.sorted.sort_unstable_by_key(|s| s.column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_sum_the_steps_before_them() {
        let mut state = 3u32;
        let mut next = |n: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % n
        };
        let mut steps = Steps::default();
        for _ in 0..200 {
            steps.clear(3);
            let mut expected = [[0i32; 24]; 3];
            for _ in 0..next(40) {
                let (row, column, by) = (next(3), next(24), if next(2) == 0 { 1 } else { -1 });
                steps.push(row as i32, column as i32, by);
                for winding in &mut expected[row as usize][column as usize..] {
                    *winding += i32::from(by);
                }
            }
            let mut found = [[0i32; 24]; 3];
            steps.for_spans(3, 24, |row, from, to, winding| {
                for column in from..to {
                    found[row as usize][column as usize] = winding;
                }
            });
            assert_eq!(found, expected);
        }
    }
}
