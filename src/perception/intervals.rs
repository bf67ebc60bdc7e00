//! Contiguous intervals of a sequence of times: it is cut where successive ones are farther apart than usual.

/// Times whose distance is at most this much above the usual one are not cut: rounding, and clocks of sensors.
const TOLERANCE: f64 = 1.05;

/// First and last time of each interval, s, of ascending times. The usual distance is the median; `longest` replaces it.
pub fn intervals(times: &[f64], longest: Option<f64>) -> Vec<(f64, f64)> {
    let mut distances: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    distances.sort_by(f64::total_cmp);
    let usual = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    let longest = longest.unwrap_or(usual) * TOLERANCE;
    times.chunk_by(|a, b| b - a <= longest).map(|part| (part[0], part[part.len() - 1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_distance_parts_them() {
        assert_eq!(intervals(&[0.0, 0.4, 0.8, 2.0, 2.4], None), [(0.0, 0.8), (2.0, 2.4)]);
        assert_eq!(intervals(&[0.0, 0.4, 0.8, 2.0, 2.4], Some(1.2)), [(0.0, 2.4)]);
        assert_eq!(intervals(&[3.0], None), [(3.0, 3.0)]);
        assert!(intervals(&[], None).is_empty());
    }
}
