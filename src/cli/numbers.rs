//! Numbers of the command line: one rule for all, so that what is no number and what is beyond all use is
//! refused wherever it is written.

/// The largest size of a number that any option takes: no scene is larger, or longer.
const MOST: f64 = 1e9;

/// A number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    read(text).ok_or_else(|| format!("give a number from -{MOST} to {MOST}"))
}

/// A number above zero.
pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    read(text).filter(|value| *value > 0.0).ok_or_else(|| format!("give a number above 0, to {MOST}"))
}

/// Zero or a number above it.
pub(super) fn at_least_zero(text: &str) -> Result<f64, String> {
    read(text).filter(|value| *value >= 0.0).ok_or_else(|| format!("give a number from 0 to {MOST}"))
}

/// A share of something, above zero and at most all of it.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let known = read(text).filter(|value| *value > 0.0 && *value <= 1.0);
    known.ok_or_else(|| "give a share above 0, to 1: 0.02 is 2 %".to_owned())
}

/// A whole number that chooses one of many, without an order.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}

/// `N` numbers between commas.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parsed: Option<Vec<f64>> = text.split(',').map(read).collect();
    let right = parsed.and_then(|parsed| parsed.try_into().ok());
    right.ok_or_else(|| format!("give {N} numbers from -{MOST} to {MOST} with commas between them"))
}

fn read(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.abs() <= MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_for_one_option_is_none_for_all() {
        let all = [number, above_zero, at_least_zero, share];
        for bad in ["", "a", "nan", "NaN", "inf", "-inf", "1e300", "1e10", "0x10", "1,5", "1 2"] {
            assert!(all.iter().all(|read| read(bad).is_err()), "{bad}");
            assert!(numbers::<2>(&format!("1,{bad}")).is_err() && numbers::<2>(&format!("{bad},1")).is_err());
        }
        let told = |text: &str| all.map(|read| read(text).is_ok());
        assert_eq!(told("0.5"), [true, true, true, true]);
        assert_eq!(told("5"), [true, true, true, false]);
        assert_eq!(told("0"), [true, false, true, false]);
        assert_eq!(told("-1e3"), [true, false, false, false]);
        assert_eq!(numbers("-1, 2.5,3e2"), Ok([-1.0, 2.5, 300.0]));
        assert_eq!((seed("7"), seed("-3").is_err(), seed("1.5").is_err()), (Ok(7), true, true));
    }
}
