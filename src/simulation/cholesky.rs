//! Linear equations whose matrix is symmetric and has no negative eigenvalues, solved with Cholesky's factors.

/// A symmetric matrix without negative eigenvalues as L·Lᵀ, row by row up to the diagonal.
#[derive(Debug)]
pub(super) struct Cholesky(Vec<f64>);

impl Cholesky {
    /// A pivot that falls to less than this part of the diagonal's element is rounding: the row is the others' sum.
    const ROUNDING: f64 = 64.0 * f64::EPSILON;

    /// Takes a matrix of this many rows apart. Rows that others add up to are left out: their diagonal is infinite.
    pub(super) fn new(matrix: Vec<f64>, rows: usize) -> Self {
        let mut lower = matrix;
        for row in 0..rows {
            let own = start(row);
            for column in 0..=row {
                let other = start(column);
                let known: f64 = (0..column).map(|k| lower[own + k] * lower[other + k]).sum();
                let rest = lower[own + column] - known;
                lower[own + column] = if column < row {
                    rest / lower[other + column]
                } else if rest > Self::ROUNDING * lower[own + column] {
                    rest.sqrt()
                } else {
                    f64::INFINITY
                };
            }
        }
        Self(lower)
    }

    /// What the matrix times gives this; zero for rows that were left out.
    pub(super) fn solve(&self, mut values: Vec<f64>) -> Vec<f64> {
        let Self(lower) = self;
        for row in 0..values.len() {
            let known: f64 = (0..row).map(|k| lower[start(row) + k] * values[k]).sum();
            values[row] = (values[row] - known) / lower[start(row) + row];
        }
        for row in (0..values.len()).rev() {
            let known: f64 = (row + 1..values.len()).map(|k| lower[start(k) + row] * values[k]).sum();
            values[row] = (values[row] - known) / lower[start(row) + row];
        }
        values
    }
}

/// Where a row of a lower triangle begins.
fn start(row: usize) -> usize {
    row * (row + 1) / 2
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn what_the_matrix_makes_of_the_solution_is_the_right_hand_side() {
        // The first rows of Hilbert's matrix, each row up to the diagonal.
        let hilbert = |row: usize, column: usize| 1.0 / (row + column + 1) as f64;
        let matrix: Vec<f64> =
            (0..5).flat_map(|row| (0..=row).map(move |column| hilbert(row, column))).collect();
        let expected = [1.0, -2.0, 3.0, -4.0, 5.0];
        let times = |row: usize| (0..5).map(|column| hilbert(row, column) * expected[column]).sum::<f64>();
        let solution = Cholesky::new(matrix, 5).solve((0..5).map(times).collect());
        for (found, expected) in solution.iter().zip(expected) {
            // Its condition number is 4.8e5.
            assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
        }
    }

    /// The matrix of all scalar products of these, row by row up to the diagonal.
    fn products(of: &[DVec2]) -> Vec<f64> {
        of.iter().enumerate().flat_map(|(row, one)| of[..=row].iter().map(|other| one.dot(*other))).collect()
    }

    #[test]
    fn rows_that_others_add_up_to_are_left_out() {
        let [one, other] = [DVec2::X, 2.0 * DVec2::Y];
        let solution = Cholesky::new(products(&[one, other, one + other]), 3).solve(vec![3.0, 8.0, 11.0]);
        assert_eq!(solution, [3.0, 2.0, 0.0]);
    }

    #[test]
    fn rows_that_others_add_up_to_but_for_rounding_are_left_out() {
        for turn in 1..100 {
            let [one, other] = [0.7, 1.9].map(|angle| DVec2::from_angle(angle * f64::from(turn)));
            let rows = [one, other, 0.3 * one - 0.6 * other];
            let right = rows.map(|row| row.dot(one));
            let solution = Cholesky::new(products(&rows), 3).solve(right.to_vec());
            assert_eq!(solution[2], 0.0, "turn {turn}: {solution:?}");
            let sum = rows[0] * solution[0] + rows[1] * solution[1];
            assert!(sum.abs_diff_eq(one, 1e-9), "turn {turn}: {solution:?}");
        }
    }
}
