// The way of a ray through the medium, stretch by stretch and step by step.
// @use camera counts crossings gather ray_seen ray_step

override MAX_STEPS: u32 = 512u;
// Whether how far the ray sees is all that is wanted of it.
override VISIBILITY: bool = false;

// Rounds for jumps and for the last stretches, beyond the steps that a ray should take.
const SPARE_STEPS: u32 = 256u;

// Share of the extinction of a body that the model of light sees.
fn kept_of(body: u32) -> f32 {
    let species = medium_species(body);
    return light_transported(species) * (1.0 - light_ahead(species));
}

fn march(ray: LightRay, farthest: f32, offset: f32, opaque: f32) -> March {
    var m = March(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, vec3f(0.0), light_begin(ray));
    var t = 0.0;
    medium_begin(ray.region, ray.origin, ray.direction, ray.bend);
    var stretch = Stretch(0.0, false, 0.0, 0.0, 0u);
    var step = 0.0;
    var phase = offset;
    var piece = Piece(-1.0, -1.0, vec2f(0.0), 0.0, 0.0, 0.0);
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
        let smallest = step_of_boundary(cloud.first_step, stretch.boundary, blur);
        let longest = step_of_boundary(cloud.longest_step, stretch.boundary, blur);
        let left = min(stretch.end, farthest) - t;
        let wanted = max(step_spaced(step, smallest, longest, stretch.core), step_scarce(left, i, MAX_STEPS));
        var length = min(wanted * phase, left);
        phase = 1.0;
        count(STEPS, 1u);
        var matter = Matter(stretch.core, 0.0, 0.0, 0.0, stretch.body);
        if stretch.core <= 0.0 {
            matter = medium_on_ray(ray.region, light_ray_at(ray, t + 0.5 * length), ray.direction, blur);
            length = step_stretched(length, wanted, left, matter, kept_of(matter.body));
        }
        // Gather the light of this step in closed form.
        let kept = kept_of(matter.body);
        let optical_depth = matter.extinction * length;
        let through = step_through(kept, optical_depth);
        let seen = m.transmittance * (1.0 - through);
        // Light what came before, where it is enough or has ended.
        if optical_depth > 0.0 {
            if VISIBILITY {
                mark(t, length, m.transmittance, m.transmittance * through);
            } else {
                if t > piece.end || piece.seen > cloud.lit_at_once {
                    piece = next_piece(&m, ray, piece, t);
                }
                piece = piece_with(piece, t, length, kept * optical_depth, seen);
            }
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
    if !VISIBILITY {
        _ = next_piece(&m, ray, piece, piece.end);
    }
    if light_reads_nodes() && LIT {
        light_nodes(&m, ray);
    }
    return m;
}
