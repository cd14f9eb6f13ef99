//! Linear equations whose matrix is symmetric and has no negative eigenvalues, solved with Cholesky's factors.

/// The lower half of a symmetric matrix, row by row, each from an element before which all are zero up to the diagonal: what
/// Cholesky's factors need no more room than (Jennings 1966).
#[derive(Debug, Clone, Default)]
pub(super) struct Skyline {
    values: Vec<f64>,
    rows: Vec<Row>,
}

/// Where a row is.
#[derive(Debug, Clone, Copy)]
struct Row {
    /// The place of its first value.
    start: usize,
    /// The column of that.
    first: usize,
}

impl Skyline {
    /// Adds a row of zeros, from this column on, and returns it.
    pub(super) fn add_row(&mut self, first: usize) -> &mut [f64] {
        let (row, start) = (self.rows.len(), self.values.len());
        self.rows.push(Row { start, first });
        self.values.resize(start + row + 1 - first, 0.0);
        &mut self.values[start..]
    }
}

/// A symmetric matrix without negative eigenvalues as L·Lᵀ.
#[derive(Debug)]
pub(super) struct Cholesky(Skyline);

impl Cholesky {
    /// A pivot that falls to less than this part of the diagonal's element is rounding: the row is the others' sum.
    const ROUNDING: f64 = 64.0 * f64::EPSILON;

    /// Takes a matrix apart. Rows that others add up to are left out: their diagonal is infinite.
    pub(super) fn new(matrix: Skyline) -> Self {
        let Skyline { mut values, rows } = matrix;
        for (row, &Row { start, first }) in rows.iter().enumerate() {
            let (above, own) = values.split_at_mut(start);
            for column in first..row {
                let other = rows[column];
                let both = first.max(other.first);
                let theirs = &above[other.start..=other.start + column - other.first];
                let known = dot(&own[both - first..column - first], &theirs[both - other.first..]);
                own[column - first] = (own[column - first] - known) / theirs[column - other.first];
            }
            let (left, diagonal) = own[..=row - first].split_at_mut(row - first);
            let rest = diagonal[0] - dot(left, left);
            diagonal[0] = if rest > Self::ROUNDING * diagonal[0] { rest.sqrt() } else { f64::INFINITY };
        }
        Self(Skyline { values, rows })
    }

    /// What the matrix times gives this; zero for rows that were left out.
    pub(super) fn solve(&self, mut values: Vec<f64>) -> Vec<f64> {
        let Self(Skyline { values: lower, rows }) = self;
        for (row, &Row { start, first }) in rows.iter().enumerate() {
            let own = &lower[start..=start + row - first];
            values[row] = (values[row] - dot(own, &values[first..row])) / own[row - first];
        }
        for (row, &Row { start, first }) in rows.iter().enumerate().rev() {
            let own = &lower[start..=start + row - first];
            values[row] /= own[row - first];
            let value = values[row];
            values[first..row].iter_mut().zip(own).for_each(|(known, lower)| *known -= value * lower);
        }
        values
    }
}

/// So many sums are made side by side.
const LANES: usize = 8;

/// The scalar product of two rows, as far as the shorter one goes.
fn dot(one: &[f64], other: &[f64]) -> f64 {
    let length = one.len().min(other.len());
    let ((one, one_rest), (other, other_rest)) =
        (one[..length].as_chunks::<LANES>(), other[..length].as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (one, other) in one.iter().zip(other) {
        for lane in 0..LANES {
            sums[lane] += one[lane] * other[lane];
        }
    }
    let rest: f64 = one_rest.iter().zip(other_rest).map(|(one, other)| one * other).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn what_the_matrix_makes_of_the_solution_is_the_right_hand_side() {
        // The first rows of Hilbert's matrix.
        let hilbert = |row: usize, column: usize| 1.0 / (row + column + 1) as f64;
        let expected = [1.0, -2.0, 3.0, -4.0, 5.0];
        let times = |row: usize| (0..5).map(|column| hilbert(row, column) * expected[column]).sum::<f64>();
        let solution = Cholesky::new(matrix(5, |_| 0, hilbert)).solve((0..5).map(times).collect());
        for (found, expected) in solution.iter().zip(expected) {
            // Its condition number is 4.8e5.
            assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
        }
    }

    /// A matrix of so many rows with these elements, each row from the column that `first` says on.
    fn matrix(rows: usize, first: impl Fn(usize) -> usize, element: impl Fn(usize, usize) -> f64) -> Skyline {
        let mut matrix = Skyline::default();
        for row in 0..rows {
            let first = first(row);
            let values = matrix.add_row(first).iter_mut().enumerate();
            values.for_each(|(at, value)| *value = element(row, first + at));
        }
        matrix
    }

    /// The matrix of all scalar products of these.
    fn products(of: &[DVec2]) -> Skyline {
        matrix(of.len(), |_| 0, |row, column| of[row].dot(of[column]))
    }

    #[test]
    fn rows_that_begin_late_are_as_if_they_began_with_zeros() {
        // Each row with those up to three before it, or five; a few alone.
        let first = |row: usize| row - [3, 5, 0][row % 3].min(row);
        let element = |row: usize, column: usize| {
            let beside = first(row.max(column)) <= row.min(column);
            if row == column { 9.0 } else { f64::from(u8::from(beside)) / (1 + row.abs_diff(column)) as f64 }
        };
        let right: Vec<f64> = (0..40).map(|row| f64::from(row % 7) - 3.0).collect();
        let short = Cholesky::new(matrix(40, first, element)).solve(right.clone());
        let long = Cholesky::new(matrix(40, |_| 0, element)).solve(right.clone());
        for row in 0..40 {
            let times: f64 = (0..40).map(|column| element(row, column) * short[column]).sum();
            assert!((times - right[row]).abs() < 1e-13, "row {row}: {times}, not {}", right[row]);
            assert!((short[row] - long[row]).abs() < 1e-15, "row {row}: {} and {}", short[row], long[row]);
        }
    }

    #[test]
    fn rows_that_others_add_up_to_are_left_out() {
        let [one, other] = [DVec2::X, 2.0 * DVec2::Y];
        let solution = Cholesky::new(products(&[one, other, one + other])).solve(vec![3.0, 8.0, 11.0]);
        assert_eq!(solution, [3.0, 2.0, 0.0]);
    }

    #[test]
    fn rows_that_others_add_up_to_but_for_rounding_are_left_out() {
        for turn in 1..100 {
            let [one, other] = [0.7, 1.9].map(|angle| DVec2::from_angle(angle * f64::from(turn)));
            let rows = [one, other, 0.3 * one - 0.6 * other];
            let right = rows.map(|row| row.dot(one));
            let solution = Cholesky::new(products(&rows)).solve(right.to_vec());
            assert_eq!(solution[2], 0.0, "turn {turn}: {solution:?}");
            let sum = rows[0] * solution[0] + rows[1] * solution[1];
            assert!(sum.abs_diff_eq(one, 1e-9), "turn {turn}: {solution:?}");
        }
    }
}
