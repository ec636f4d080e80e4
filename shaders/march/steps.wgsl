// The way of a ray through the medium, stretch by stretch and step by step.
// @use camera counts gather

override MAX_STEPS: u32 = 512u;

// Shortest step, in widths of a pixel.
const SHORTEST_STEP: f32 = 0.5;
// Share of the distance to a change of density that is stepped over, for noise steepens it, the
// largest optical depth that is, and how many times as long a step may become by it: noise has
// more in store than one point of it tells, and shorter steps must find it.
const STEADY: f32 = 0.6;
const THICKEST_STEP: f32 = 1.0;
const MOST_STRETCHED: f32 = 4.0;
// Optical depth of the first step in a homogeneous core.
const CORE_STEP: f32 = 0.15;
// Steps kept for stretches to come when a ray has used up its own.
const RESERVE: u32 = 8u;
// Rounds for jumps and for the last stretches, beyond the steps that a ray should take.
const SPARE_STEPS: u32 = 256u;

// Share of the extinction of a species that the model of light sees.
fn kept_of(index: u32) -> f32 {
    return select(1.0, transported(medium_species(index)), light_truncates());
}

fn march(ray: LightRay, farthest: f32, offset: f32, opaque: f32) -> March {
    var m = March(1.0, 0.0, 0.0, 0.0, 0.0, vec3f(0.0), light_begin(ray));
    var t = 0.0;
    medium_begin(ray.region, ray.origin, ray.direction);
    var stretch = Stretch(0.0, false, 0.0, 0.0, 0u);
    var step = 0.0;
    var phase = offset;
    var piece = Piece(-1.0, vec2f(0.0), 0.0, 0.0, 0.0);
    for (var i = 0u; i < MAX_STEPS + SPARE_STEPS; i++) {
        // Find the next stretch; jump over clear air.
        if t >= stretch.end {
            stretch = medium_ahead(ray.region, ray.origin, ray.direction, t);
            if !stretch.inside {
                if stretch.end >= farthest {
                    break;
                }
                t = stretch.end;
                step = 0.0;
                phase = offset;
                continue;
            }
        }
        // Take one step, no farther than the stretch.
        let blur = pixel_footprint(camera, t);
        let smallest = max(cloud.first_step * stretch.boundary, SHORTEST_STEP * blur);
        let longest = max(cloud.longest_step * stretch.boundary, SHORTEST_STEP * blur);
        let homogeneous = stretch.core > 0.0;
        let spaced = select(clamp(step, smallest, longest), max(step, CORE_STEP / stretch.core), homogeneous);
        // Where steps run short, what is left of the stretch shares those that are left.
        let left = min(stretch.end, farthest) - t;
        let scarce = left / f32(max(MAX_STEPS, i + RESERVE) - i);
        let wanted = max(spaced, select(0.0, scarce, 2u * i > MAX_STEPS));
        var length = min(wanted * phase, left);
        phase = 1.0;
        count(STEPS, 1u);
        var matter = Matter(stretch.core, 0.0, 0.0, 0.0, stretch.species);
        if !homogeneous {
            matter = medium_on_ray(ray.region, light_ray_at(ray, t + 0.5 * length), ray.direction, blur);
            // The step is as long as what it found, within reason.
            let thickest = THICKEST_STEP / max(kept_of(matter.species) * matter.extinction, 1e-6);
            let most = min(thickest, MOST_STRETCHED * wanted);
            let steady = min(0.5 * length + STEADY * matter.steady, most);
            length = min(max(length, max(steady, 0.5 * length + matter.clear)), left);
        }
        // Gather the light of this step in closed form.
        let kept = kept_of(matter.species);
        let optical_depth = matter.extinction * length;
        let through = exp(-kept * optical_depth);
        let seen = m.transmittance * (1.0 - through);
        // Light what came before, where it is enough or has ended.
        if optical_depth > 0.0 {
            if t > piece.end || piece.seen > cloud.lit_at_once {
                piece = next_piece(&m, ray, piece, t);
            }
            piece.end = t + length;
            piece.optical_depth += kept * optical_depth;
            piece.seen += seen;
            piece.distance += seen * (t + 0.5 * length);
        }
        m.transmittance *= through;
        m.optical_depth += optical_depth;
        if m.transmittance < opaque {
            break;
        }
        // Inside, steps grow.
        t = select(t + length, stretch.end, t + length >= stretch.end);
        step = select(wanted * cloud.growth, smallest, matter.depth < 0.0);
        if t >= farthest {
            break;
        }
    }
    _ = next_piece(&m, ray, piece, piece.end);
    if light_reads_nodes() && !NORMALS {
        light_nodes(&m, ray);
    }
    return m;
}
