// What a path of the path tracer chooses by chance, and what its choices weigh. A `chance` is a random
// number from 0 to 1.

// Where in its table a share of the light is: at both ends the square root of what is left, so
// that angles there, which grow like that root, are linear in it.
fn share_coordinate(share: f32) -> f32 {
    let half = sqrt(0.5 * min(share, 1.0 - share));
    return select(1.0 - half, half, share < 0.5);
}

// `d` turned by an angle, in a direction about it that `azimuth` chooses.
fn turned(d: vec3f, angle: f32, azimuth: f32) -> vec3f {
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(d.x) > 0.7);
    let u = normalize(cross(d, helper));
    let v = cross(d, u);
    return normalize(cos(angle) * d + sin(angle) * (cos(azimuth) * u + sin(azimuth) * v));
}

// A direction, evenly over the whole sphere.
fn any_direction(chance: f32, azimuth: f32) -> vec3f {
    let y = 1.0 - 2.0 * chance;
    let level = 2.0 * sqrt(chance * (1.0 - chance));
    return vec3f(level * cos(azimuth), y, level * sin(azimuth));
}

// A number with the distribution of Gauss, of deviation 1 (Box and Muller 1958).
fn normal_number(chance: f32, angle: f32) -> f32 {
    return sqrt(2.0 * free_flight(chance)) * cos(angle);
}

// Angle from the middle of a disc of angular `radius` to a point of it, evenly over the disc.
fn disc_angle(radius: f32, chance: f32) -> f32 {
    return radius * sqrt(chance);
}

// Optical depth to the next collision.
fn free_flight(chance: f32) -> f32 {
    return -log(1.0 - chance);
}

// Share of tentative collisions that are real: null-collision tracking.
fn real_share(extinction: f32, majorant: f32) -> f32 {
    return extinction / max(majorant, 1e-20);
}

// Share of directions drawn around the sun after so many collisions. A direction around the path that
// happens to be the sun's has P(to the sun) times the light of one that was drawn around the
// sun, over this share: so the share grows with P, `toward`, 1/sr, up to `most`. `least` is the first
// collision's; 0 leaves all directions to the phase function.
fn share_around_sun(least: f32, most: f32, toward: f32, collisions: u32) -> f32 {
    let held = least * 8.0 / (7.0 + f32(collisions));
    return select(0.0, max(held, most * toward / (toward + 1.0)), least > 0.0);
}

// Density of a direction that is drawn around the sun by a `share` of chances: the balance heuristic's.
fn mixed_density(share: f32, around_path: vec3f, around_sun: vec3f) -> vec3f {
    return (1.0 - share) * around_path + share * around_sun;
}

// What a path carries, its three ways to be chosen weighed together.
fn spectral_weight(throughput: vec3f, choice: vec3f) -> vec3f {
    return throughput * (3.0 / max(choice.x + choice.y + choice.z, 1e-30));
}

// Densities of the three channels over their mean.
fn balanced(densities: vec3f) -> vec3f {
    return densities * (3.0 / max(densities.x + densities.y + densities.z, 1e-30));
}

// A number of collisions near `count`, or unlike it where `apart`, and the chance to be drawn: a quarter
// with each step away. Numbers below 1 mean that there is none.
fn neighbour_count(count: u32, apart: bool, side: f32, far: f32) -> vec2f {
    let beyond = floor(-0.5 * log2(1.0 - far));
    let steps = beyond + select(0.0, 1.0, apart);
    let sides = select(2.0, 1.0, steps == 0.0 || count == 0u);
    let chance = 0.75 * exp2(-2.0 * beyond) / sides;
    return vec2f(f32(count) + select(steps, -steps, side < 0.5 && count > 0u), chance);
}

// Chance of a walk to the sun to be taken that would bring this `light`, where `dim` is little.
fn walk_chance(light: f32, dim: f32) -> f32 {
    return clamp(light / max(dim, 1e-20), LEAST_WALKS, 1.0);
}
const LEAST_WALKS: f32 = 0.1;

// What is left of light where a tentative collision, a `share` of which is real, was none of the
// `events` that are told apart.
fn missed_share(share: f32, events: f32) -> f32 {
    return (1.0 - share) / max(1.0 - events, 1e-6);
}

// Chance of a path to survive Russian roulette: those that carry less than `faint` are ended, save
// where they are `spared`.
fn roulette_survival(light: vec3f, faint: f32, spared: bool) -> f32 {
    let most = max(light.x, max(light.y, light.z));
    return select(1.0, 0.25, most < faint && !spared);
}

// Welford's running mean and sum of squared differences.
struct Sum {
    mean: vec3f,
    alpha: f32,
    squares: vec3f,
    padding: f32,
}

// The sum with the `count`th sample: its light, and 1 where it met anything.
fn sum_with(before: Sum, light: vec3f, hit: f32, count: u32) -> Sum {
    var sum = before;
    let difference = light - sum.mean;
    let n = f32(count);
    sum.mean += difference / n;
    sum.squares += difference * (light - sum.mean);
    sum.alpha += (hit - sum.alpha) / n;
    return sum;
}
