//! Orders of convergence.

/// Points of which logarithms are correlated less than this do not lie on a line.
const CORRELATION: f64 = 0.95;

/// The slope of the least-squares line through logarithms: the order in which an error falls with what is small.
/// `None` of fewer than four points, and where they do not lie on a line.
pub(super) fn order(points: &[(f64, f64)]) -> Option<f64> {
    if points.len() < 4 {
        return None;
    }
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(size, error)| (size.ln(), error.ln())).collect();
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let spread: f64 = logs.iter().map(|(_, y)| (y - mean_y).powi(2)).sum();
    (covariance > CORRELATION * (variance * spread).sqrt()).then(|| covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> = (1..6).map(|k| (0.5_f64.powi(k), 3.0 * 0.25_f64.powi(k))).collect();
        assert!((order(&points).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order(&points[..3]), None);
        assert_eq!(order(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]), None);
        assert_eq!(order(&[(1.0, 1.0), (2.0, 7.0), (3.0, 1.0), (4.0, 7.0)]), None);
    }
}
