// Walks from a collision to the sun, through any number of collisions in the forward peak.
//
// At a wide collision stands the sum over n of the light that comes from the sun by n collisions in the peak.
// The directions of such a chain are drawn backwards from the sun, each by the peak about the
// next one, so that their densities cancel, and the walk takes them in turn. Of n collisions it must
// meet just n, for each n by itself: a walk straight to the sun, by the same random numbers, meets as many as
// most others do. That number is always tried, and one of the others by chance, which weighs the more.
// Wide collisions are taken off as what is expected of them.
// @use atmosphere path_flash path_medium path_state

override ATMOSPHERE: bool = true;
// Chances of another number of peak collisions to be tried, where the straight walk reached the sun and where
// it did not.
override OTHER: f32 = 1.0;
override OTHER_HIDDEN: f32 = 0.5;
// Walks to the sun that would bring less than this, 1/sr, are taken now and then.
override DIM: f32 = 0.03;

// Irradiance of the sun at a height above the scene's origin, m.
fn sun_at(height: f32) -> vec3f {
    if !ATMOSPHERE {
        return scene.sun_irradiance;
    }
    return scene.sun_irradiance * sun_irradiance_at(sky.atmosphere, transmittance, clamped, scene.altitude + height, scene.to_sun.y);
}

// What comes next on a path: it goes on as it does, walks to the sun, turns on a walk, goes on from
// a collision, or has left.
const ON: u32 = 0u;
const WALK: u32 = 1u;
const TURN: u32 = 2u;
const SCATTER: u32 = 3u;
const LEFT: u32 = 4u;

// A tentative collision of a walk, a `share` of which is real: the peak's are taken or not, of others the
// expected share is taken off.
fn walk(path: ptr<function, Path>, step: Step, share: f32) -> u32 {
    let species = bodies[step.matter.body].table;
    let events = select(0.0, share * peak_share(species), (*path).chained && species == (*path).species);
    let is_event = draw() < events;
    let luck = draw();
    if !is_event {
        (*path).shadow *= missed_share(share, events);
        // Roulette on what hardly counts keeps its mean.
        if (*path).shadow < 0.05 {
            (*path).shadow *= select(0.0, 2.0, luck < 0.5);
        }
        return ON;
    }
    (*path).shadow *= albedo(species);
    (*path).height = step.position.y;
    if (*path).mode == STRAIGHT {
        (*path).count += 1u;
        return ON;
    }
    (*path).shadow = select((*path).shadow, 0.0, (*path).count == 0u);
    (*path).count = max((*path).count, 1u) - 1u;
    return TURN;
}

// The end of a walk: its light, and whether there is another one. The straight walk told how many peak
// collisions there may be; another number is tried now and then.
fn end_walk(path: ptr<function, Path>) -> u32 {
    let count = (*path).count;
    let seen = (*path).shadow > 0.0;
    let straight = (*path).mode == STRAIGHT;
    random_state = (*path).kept;
    if seen && count == 0u {
        let irradiance = select(sun_at((*path).height), scene.sun_irradiance, FLASH);
        (*path).gathered += (*path).light * (*path).shadow * irradiance;
    }
    (*path).mode = CHAIN;
    if straight && (*path).chained {
        let chance = select(OTHER_HIDDEN, OTHER, seen);
        let other = neighbour_count(select(max(count, 1u), count, seen), seen, draw(), draw());
        (*path).other = select(0u, u32(clamp(other.x, 0.0, 65535.0)), draw() < chance);
        (*path).other_weight = 1.0 / (chance * other.y);
        (*path).kept = random_state;
        if seen && count > 0u {
            return WALK;
        }
    }
    (*path).count = (*path).other;
    (*path).other = 0u;
    (*path).taken_weight *= (*path).other_weight;
    if (*path).count > 0u {
        return WALK;
    }
    (*path).position = (*path).origin;
    (*path).mode = TRACK;
    return SCATTER;
}
