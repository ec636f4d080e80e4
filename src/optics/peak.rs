//! The forward peak of droplets' phase functions, taken off and given back.
//!
//! Almost half of the light that droplets scatter goes straight on within a few
//! degrees. Kol \[K 3.64-3.69\] cuts this peak off, P_peak = P - P(cut) within
//! the cut angle, treats the light in it as not scattered, and adds it back in
//! closed form. Here f = int P_peak, the weight of the peak. The medium without
//! it has extinction (1 - f) k_e and phase function (P - P_peak) / (1 - f).
//! Light of optical depth tau is then in one of three places, which add up to 1:
//!
//! - e^(-tau): not scattered at all;
//! - e^(-(1-f) tau) - e^(-tau): scattered within the peak only;
//! - 1 - e^(-(1-f) tau): scattered by more.
//!
//! \[K 3.66, 3.69\] print e^(-f tau) in the second and leave out the factor 1/f
//! that belongs to it, and \[K 3.68\] gives f = 0; none of them conserves energy.
//! The angle is Bouthors' and Kol's, 8 degrees, for green. Red and blue are cut
//! where their weight is the same, because light of all channels marches along
//! one optical depth.

use std::f64::consts::PI;

use super::phase::{Phase, Tabulated};

/// Angle in degrees at which green is cut \[K 3.64\].
pub const GREEN_CUT_DEG: f64 = 8.0;

/// Angles in degrees between which the cut of red and blue is looked for.
const CUT_RANGE_DEG: [f64; 2] = [4.0, 16.0];

/// A phase function divided into its forward peak and the rest.
///
/// Henyey-Greenstein and isotropic phase functions have no peak worth taking
/// off: f is 0, and everything is in the wide part.
#[derive(Debug, Clone, PartialEq)]
pub struct Chopped {
    /// Share of the scattered light in the peak, of all channels: 0 to 1.
    pub f: f64,
    /// Angle in degrees within which the peak lies, for red, green and blue.
    pub cut_deg: [f64; 3],
    /// Mean cosine of the scattering angle without the peak, for each channel.
    pub asymmetry: [f64; 3],
    phase: Phase,
    /// What is left within the cut: the phase function at the cut angle, in 1/sr.
    level: [f64; 3],
}

impl Chopped {
    /// Takes the peak off a phase function.
    pub fn new(phase: Phase) -> Self {
        match &phase {
            Phase::Tabulated(channels) => {
                let f = removed(&channels[1], GREEN_CUT_DEG.to_radians());
                let cuts = [find_cut(&channels[0], f), GREEN_CUT_DEG.to_radians(), find_cut(&channels[2], f)];
                Self {
                    f,
                    cut_deg: cuts.map(f64::to_degrees),
                    asymmetry: std::array::from_fn(|i| wide_asymmetry(&channels[i], cuts[i], f)),
                    level: std::array::from_fn(|i| channels[i].value(cuts[i])),
                    phase,
                }
            }
            whole => Self {
                f: 0.0,
                cut_deg: [0.0; 3],
                asymmetry: std::array::from_fn(|i| whole.asymmetry(i)),
                level: [0.0; 3],
                phase,
            },
        }
    }

    /// The whole phase function.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// P - P_peak in 1/sr of a channel at `theta` in radians. It integrates to
    /// 1 - f: divide by that for the phase function of the medium without peak.
    pub fn wide(&self, channel: usize, theta: f64) -> f64 {
        if self.is_within_cut(channel, theta) {
            self.level[channel]
        } else {
            self.phase.value(channel, theta)
        }
    }

    /// P_peak in 1/sr of a channel at `theta` in radians \[K 3.65\]. It integrates to f.
    pub fn peak(&self, channel: usize, theta: f64) -> f64 {
        if self.is_within_cut(channel, theta) {
            self.phase.value(channel, theta) - self.level[channel]
        } else {
            0.0
        }
    }

    /// Light in 1/sr that has come through the optical depth `tau` (of the whole
    /// medium, 0 or more) scattered within the peak only, per unit irradiance
    /// at its start: (P_peak / f) (e^(-(1-f) tau) - e^(-tau)), the corrected
    /// \[K 3.66, 3.69\]. It takes all of it to be deflected by one P_peak, however
    /// often it was scattered. 0 where f is 0.
    pub fn recovered_peak(&self, channel: usize, theta: f64, tau: f64) -> f64 {
        if self.f == 0.0 {
            return 0.0;
        }
        self.peak(channel, theta) / self.f * self.recovered_share(tau)
    }

    /// Share of the light that has come through the optical depth `tau`
    /// scattered within the peak only: e^(-(1-f) tau) - e^(-tau).
    pub fn recovered_share(&self, tau: f64) -> f64 {
        // Not the difference as it stands, which loses its digits for thin clouds.
        -(-(1.0 - self.f) * tau).exp() * (-self.f * tau).exp_m1()
    }

    /// Whether a scattering angle lies within the cut.
    fn is_within_cut(&self, channel: usize, theta: f64) -> bool {
        theta < self.cut_deg[channel].to_radians()
    }
}

/// The weight f of the peak that a cut at an angle in radians removes:
/// 2 pi int_0^cut (P - P(cut)) sin theta dtheta.
fn removed(phase: &Tabulated, cut: f64) -> f64 {
    let cap = 4.0 * PI * (0.5 * cut).sin().powi(2);
    phase.within(cut) - phase.value(cut) * cap
}

/// The angle in radians at which a cut removes the weight f, by bisection:
/// the weight rises with the angle as long as the phase function falls.
fn find_cut(phase: &Tabulated, f: f64) -> f64 {
    let [mut low, mut high] = CUT_RANGE_DEG.map(f64::to_radians);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if removed(phase, middle) < f {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Mean cosine of the phase function (P - P_peak) / (1 - f).
fn wide_asymmetry(phase: &Tabulated, cut: f64, f: f64) -> f64 {
    let flat_cosine = phase.value(cut) * PI * cut.sin().powi(2);
    let peak_cosine = phase.cosine_within(cut) - flat_cosine;
    (phase.asymmetry() - peak_cosine) / (1.0 - f)
}
