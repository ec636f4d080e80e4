// What Kol's and Bouthors' models share: the light of slabs at one point of a ray, for all that is
// behind. Their slabs have no sides to lose light by.
// @use slab_maps slab_lookup

// Where the ray has gathered this much of its opacity.
const SURFACE: f32 = 0.0625;

struct LightSum {
    slab: SlabSum,
    surface: Node,
    gathered: f32,
}

fn light_begin(ray: LightRay) -> LightSum {
    return LightSum();
}

fn light_reads_nodes() -> bool {
    return SKY_LIGHT;
}

fn light_piece(sum: LightSum, piece: LitPiece) -> LightSum {
    var next = sum;
    if piece.gathered <= SURFACE {
        next.surface = Node(piece.t, 0.5 * (piece.before + piece.after), 1.0);
    }
    next.slab.sun = sun_piece(sum.slab.sun, piece);
    next.gathered = piece.gathered + piece.seen;
    return next;
}

fn light_node(sum: LightSum, ray: LightRay, node: Node) -> LightSum {
    var next = sum;
    next.slab.diffuse = diffuse_node(sum.slab.diffuse, ray, node);
    return next;
}

fn light_ray(sum: LightSum, ray: LightRay, seen: RaySeen, lights: Lights) -> RayLight {
    let source = slab_radiance(light_ray_at(ray, sum.surface.t), ray);
    let multiple = vec3f(slab_surface_light(sum.gathered, sum.surface.depth.y, source));
    return slab_ray(SlabSum(sum.slab.sun, multiple, sum.slab.diffuse), ray, seen, lights);
}
