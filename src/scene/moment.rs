//! A scene at one moment. The same time gives the same scene, to the last bit, in whatever
//! order moments are asked for: nothing is carried from one to the next.
//!
//! # Loops
//!
//! The noise stands still in the world and clouds drift through it, so a cloud's billows would
//! repeat only where the drift of a period is one of the noise's own periods. There is none: its
//! fine octaves repeat on a lattice that is turned against the coarse ones' by an angle that makes
//! no rational rotation, so that no shift but zero brings both back. A loop is closed by clouds
//! that end instead. One with a life is gone before it has to be where it began. One without
//! hands over to itself: while the wind carries it off, another of it comes to where it was, and is
//! whole before the first begins to dissolve. They are one cloud: what they share counts once.

use glam::DVec3;

use super::life::{self, smooth};
use super::timeline::{self, Curve, Interpolation, Key, Owner, Place, Track};
use super::validate::At;
use super::{Camera, Cloud, Ellipsoid, Evaporation, Noise, Scene, Timeline};
use crate::Result;

impl Scene {
    /// The scene as it is at `time`, s since its start: a still one, whose own time is 0. Curves,
    /// lives and wind are applied; the camera is there, and is not that of the moved clouds where
    /// the scene has none.
    ///
    /// It costs what moves in it: that other moments are good, too, [`Scene::validate`] tells.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) where the scene is not valid at this moment, or the
    /// curves together make something of it that is not: a camera that runs into its target.
    pub fn at(&self, time: f64) -> Result<Self> {
        // What is wrong with the scene at any time is told first.
        self.moment(time).or_else(|error| self.validate().and(Err(error)))
    }

    fn moment(&self, time: f64) -> Result<Self> {
        let mut moment = self.clone();
        // Clouds made by a program may say only how they grow.
        moment.clouds.iter_mut().filter(|cloud| cloud.ellipsoids.is_empty()).for_each(Cloud::grow);
        moment.follow_curves(time)?;
        moment.check_moment().map_err(|error| error.at_time(time))?;
        moment.choose_steps()?;
        moment.camera = Some(self.camera.as_ref().map_or_else(|| self.camera(), |_| moment.camera()));
        moment.let_live_and_drift();
        (moment.time, moment.timeline) = (0.0, None);
        Ok(moment)
    }

    /// Has of sequences of volumes what is there at its own time.
    fn choose_steps(&mut self) -> Result<()> {
        let (time, fps) =
            (self.time, self.timeline.as_ref().map_or(Timeline::default().fps, |timeline| timeline.fps));
        let root = At::Root;
        let list = root.field("clouds");
        for (i, cloud) in self.clouds.iter_mut().enumerate() {
            let Some(volume) = cloud.volume.take() else { continue };
            cloud.volume = volume.at(time, fps).map_err(|problem| {
                let at = list.index(i);
                let at = at.field("volume");
                at.field("file").problem(format!("{problem} (at {time} seconds)"))
            })?;
        }
        Ok(())
    }

    /// Puts its own time to `time`, s, and all numbers to what curves say then.
    fn follow_curves(&mut self, time: f64) -> Result<()> {
        self.time = time;
        let Some(timeline) = self.timeline.take() else { return Ok(()) };
        let (root, time) = (At::Root, timeline.wrapped(time));
        let at = root.field("timeline");
        timeline.check_for_moment(self, at)?;
        self.time = time;
        let problem = |problem: String| at.problem(problem);
        let numbers = timeline.numbers(self, time).collect::<std::result::Result<_, _>>().map_err(problem)?;
        timeline::write(self, numbers).map_err(problem)?;
        self.timeline = Some(timeline);
        Ok(())
    }

    /// The scene with the numbers that curves give them at `time`, s; everything else is as it
    /// was, and its time is that one. What an editor shows as values.
    pub fn posed(&self, time: f64) -> Self {
        let mut posed = Self { time, ..self.clone() };
        if let Some(timeline) = &self.timeline {
            posed.time = timeline.wrapped(time);
            // A track that leads nowhere moves nothing: validation tells of it.
            let numbers = timeline.numbers(self, posed.time).flatten().collect();
            if let Err(problem) = timeline::write(&mut posed, numbers) {
                tracing::warn!(problem, "a track could not be followed");
            }
        }
        posed
    }

    /// The same scene seen by another camera, which no curve moves.
    pub fn seen_by(&self, camera: Camera) -> Self {
        let mut scene = Self { camera: Some(camera), ..self.clone() };
        if let Some(timeline) = &mut scene.timeline {
            timeline.tracks.retain(|track| !track.path.starts_with("camera"));
        }
        scene
    }

    /// The same scene seen by a camera that is where `at` says at each time, in seconds, until `length`: tracks of
    /// the camera have a key a frame, `fps` a second. A scene without a timeline gets one as long as that.
    ///
    /// # Errors
    /// Where the camera goes where none may be.
    pub fn seen_over_time(&self, fps: f64, length: f64, at: impl Fn(f64) -> Camera) -> Result<Self> {
        let mut scene = self.seen_by(at(0.0));
        let own = Timeline { length: (length * fps).round().max(1.0) / fps, fps, ..Timeline::default() };
        let timeline = scene.timeline.get_or_insert(own);
        if f64::from(timeline.frames()) > MOST_FRAMES {
            return Err(crate::Error::Argument(format!(
                "the camera goes on for {length} seconds, which are {} frames of {fps} a second: a camera has at most \
                 {MOST_FRAMES} of them; take its late keys away, or give the scene a timeline",
                timeline.frames()
            )));
        }
        // The end of a loop is its beginning.
        let frames = i64::from(timeline.frames()) + i64::from(!timeline.looped);
        let times = (0..frames).map(|index| timeline.time_of(index)).filter(|time| *time <= timeline.length);
        let keys: Vec<_> = times.map(|time| (time, at(time))).collect();
        let mut follow = |path: String, number: &dyn Fn(&Camera) -> f64| {
            let key = |(time, camera): &(f64, Camera)| Key {
                interpolation: Interpolation::Linear,
                ..Key::new(*time, number(camera))
            };
            timeline.tracks.push(Track { path, keys: keys.iter().map(key).collect() });
        };
        for axis in 0..3 {
            follow(format!("camera.position[{axis}]"), &|camera| camera.position[axis]);
            follow(format!("camera.target[{axis}]"), &|camera| camera.target[axis]);
        }
        follow("camera.roll_deg".to_owned(), &|camera| camera.roll_deg);
        scene.validate()?;
        Ok(scene)
    }

    /// How far the wind has carried a cloud without a life at the scene's own time, m. In a loop
    /// that is no more than what the wind brings back within a period.
    pub fn drift(&self) -> DVec3 {
        match self.period() {
            Some(period) if Drift::of(self).since_start(period) != DVec3::ZERO => DVec3::ZERO,
            _ => Drift::of(self).since_start(self.time),
        }
    }

    fn shear(&self) -> Shear {
        Shear { gradient: 1e-3 * self.wind.shear, base: self.bounds().map_or(0.0, |(low, _)| low.y) }
    }

    pub(super) fn period(&self) -> Option<f64> {
        self.timeline.as_ref().and_then(Timeline::period)
    }

    /// Noises as far as their rates have brought them at the scene's own time.
    fn renew_noises(&mut self) {
        let rates = self.rates();
        let (time, period) = (self.time, self.period());
        let curve = |owner: Owner| rates.iter().find(|(of, _)| *of == owner).map(|(_, curve)| curve);
        self.noise.renew(curve(Owner::Scene), time, period);
        for (i, cloud) in self.clouds.iter_mut().enumerate() {
            if let Some(noise) = &mut cloud.noise {
                noise.renew(curve(Owner::Cloud(i)), time, period);
            }
        }
    }

    /// The curves of rates of noises, and whose those are.
    fn rates(&self) -> Vec<(Owner, Curve)> {
        let Some(timeline) = &self.timeline else { return Vec::new() };
        let of_rates = timeline.tracks.iter().filter(|track| track.path.ends_with("noise.rate"));
        let found = of_rates.filter_map(|track| {
            let owner = Place::find(&track.path, self).ok()?.owner;
            Some((owner, timeline.curve(&track.path)?))
        });
        found.collect()
    }

    /// Clouds as they have become and where the wind has brought them at the scene's own time.
    fn let_live_and_drift(&mut self) {
        self.renew_noises();
        let (time, period) = (self.time, self.period());
        let wind = Drift::of(self);
        let since_start = |time: f64| wind.since_start(time);
        let shear = self.shear();
        // Clouds that take over in a loop stand behind all others, so that those keep their places.
        let mut successors = Vec::new();
        for (number, cloud) in self.clouds.iter_mut().enumerate() {
            cloud.fix_noise();
            // What is carried off is not where it grows.
            cloud.growth = None;
            cloud.evaporate(self.wind.velocity);
            cloud.evaporation = Evaporation::default();
            match (&cloud.life.take(), period) {
                (Some(life), _) => {
                    let (age, span) = (life.age(time, period), life.span(period));
                    let drift = since_start(life.birth + age) - since_start(life.birth + 0.5 * span);
                    shear.lean(&mut cloud.ellipsoids, age - 0.5 * span);
                    life::grown(cloud, life.fullness(age, span));
                    cloud.blow(drift);
                }
                (None, Some(period))
                    if since_start(period) != DVec3::ZERO || shear.gradient != DVec3::ZERO =>
                {
                    let (gone, round) = (since_start(time), since_start(period));
                    // Two clouds, of which the denser one counts: one fades where the other is whole.
                    let mut coming = part(cloud, 2.0 * time / period, gone - round);
                    shear.lean(&mut coming.ellipsoids, time - period);
                    coming.name = cloud.label(number);
                    successors.extend(Some(coming).filter(|coming| !coming.is_empty()));
                    *cloud = part(cloud, 2.0 * (1.0 - time / period), gone);
                    shear.lean(&mut cloud.ellipsoids, time);
                }
                (None, _) => {
                    shear.lean(&mut cloud.ellipsoids, time);
                    cloud.blow(since_start(time));
                }
            }
        }
        self.clouds.append(&mut successors);
    }
}

/// What the wind has more of higher up.
struct Shear {
    /// m/s each metre.
    gradient: DVec3,
    /// Above this altitude, m.
    base: f64,
}

impl Shear {
    /// Carries ellipsoids as much farther as the wind did in `time`, s, that goes over their middles.
    fn lean(&self, ellipsoids: &mut [Ellipsoid], time: f64) {
        for ellipsoid in ellipsoids.iter_mut().filter(|_| self.gradient != DVec3::ZERO) {
            ellipsoid.center += time * (ellipsoid.center.y - self.base) * self.gradient;
        }
    }
}

impl Noise {
    /// Brings it as far as its rate, or the `curve` of that, has brought it at `time`, s. Loops of `period` seconds
    /// have a whole number of renewals.
    fn renew(&mut self, curve: Option<&Curve>, time: f64, period: Option<f64>) {
        let until = |time: f64| curve.map_or(self.rate * time, |curve| curve.integral(time)) / 60.0;
        let mut times = until(time);
        let all = period.map_or(0.0, until);
        if all.abs() > NO_RENEWAL {
            let whole = all.round().abs().max(1.0);
            times *= whole / all.abs();
            self.renewed.round = whole as u32;
        }
        self.renewed.times += times;
        self.rate = 0.0;
    }
}

/// Most frames that a camera is followed over.
const MOST_FRAMES: f64 = 1e6;

/// Renewals of a loop that are none: what rounding leaves of rates that go there and back.
const NO_RENEWAL: f64 = 1e-9;

/// How far the wind carries what drifts with it.
struct Drift {
    /// By axis: m/s over time, where they have a track.
    curves: [Option<Curve>; 3],
    /// Where they have none, m/s.
    velocity: DVec3,
}

impl Drift {
    fn of(scene: &Scene) -> Self {
        let curve = |axis: usize| scene.timeline.as_ref()?.curve(&format!("wind.velocity[{axis}]"));
        Self { curves: [0, 1, 2].map(curve), velocity: scene.wind.velocity }
    }

    /// Integral of the wind from 0 to `time`, s: m.
    fn since_start(&self, time: f64) -> DVec3 {
        let along = |axis: usize| {
            let curve = self.curves[axis].as_ref();
            curve.map_or(self.velocity[axis] * time, |curve| curve.integral(time))
        };
        DVec3::new(along(0), along(1), along(2))
    }
}

/// A cloud of which as much is there as a smooth ramp to 1 has come to, carried by `drift`, m.
fn part(cloud: &Cloud, ramp: f64, drift: DVec3) -> Cloud {
    let there = smooth(ramp.clamp(0.0, 1.0));
    let mut part = cloud.clone();
    part.ellipsoids.retain(|_| there > 0.0);
    part.ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.density *= there);
    part.layer.iter_mut().for_each(|layer| layer.density *= there);
    part.layer = part.layer.filter(|_| there > 0.0);
    part.mesh.iter_mut().for_each(|mesh| mesh.density *= there);
    part.mesh = part.mesh.filter(|_| there > 0.0);
    part.volume.iter_mut().for_each(|volume| volume.extinction *= there);
    part.volume = part.volume.filter(|_| there > 0.0);
    part.blow(drift);
    part
}

impl Cloud {
    /// Tells its own noise the size of its billows, which wind must not change.
    fn fix_noise(&mut self) {
        if self.noise.is_some()
            && let (Some(bounds), Some(noise)) = (self.bounds(), &mut self.noise)
        {
            noise.scale = Some(noise.scale_in(bounds));
        }
    }

    /// Carries it by `drift`, m, and its own noise with it.
    fn blow(&mut self, drift: DVec3) {
        blow(&mut self.ellipsoids, drift);
        self.layer.iter_mut().for_each(|layer| layer.shift(drift));
        self.mesh.iter_mut().for_each(|mesh| mesh.place += drift);
        self.volume.iter_mut().for_each(|volume| volume.place += drift);
        self.level = self.level.map(|level| level + drift.y);
        if let Some(noise) = &mut self.noise {
            noise.offset += drift;
        }
    }
}

fn blow(ellipsoids: &mut [Ellipsoid], drift: DVec3) {
    ellipsoids.iter_mut().for_each(|ellipsoid| ellipsoid.center += drift);
}
