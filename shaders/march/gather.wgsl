// What is seen along a ray, gathered in pieces that are lit at once and at nodes, where light is that
// changes slowly.
// @use crossings lighting ray_seen shade

// Whether light is gathered, and facing.
override LIT: bool = true;
override NORMALS: bool = false;
// Points of a ray at which diffuse light is found, at most 8.
override LIGHT_NODES: u32 = 6u;

// What is seen along a ray.
struct March {
    transmittance: f32,
    // Full optical depth, peak included.
    optical_depth: f32,
    // Sum of all that is seen so far, and of that past other clouds.
    gathered: f32,
    visible: f32,
    // Distance, height and facing, weighted by what is seen.
    distance: f32,
    height: f32,
    normal: vec3f,
    light: LightSum,
}

const MOST_NODES: u32 = 8u;
var<private> nodes: array<Node, MOST_NODES>;

// Lights a piece; `after` is the optical depth to the sun where it ends.
fn add_light(m: ptr<function, March>, ray: LightRay, piece: Piece, after: vec2f) {
    let t = piece.distance / piece.seen;
    let p = light_ray_at(ray, t);
    let through = crossing_share(piece);
    let seen = through * piece.seen;
    (*m).distance += through * piece.distance;
    (*m).height += seen * p.y;
    if light_reads_nodes() {
        add_node(t, 0.5 * (piece.sun + after), (*m).gathered, piece.seen, seen);
    }
    (*m).light = light_piece((*m).light, LitPiece(t, piece.sun, after, piece.optical_depth, seen, (*m).visible));
    (*m).gathered += piece.seen;
    (*m).visible += seen;
    if NORMALS {
        (*m).normal += seen * medium_facing(ray.region, p);
    }
}

// Nodes share the opacity of the ray evenly; each lies where half of its share is gathered.
fn add_node(t: f32, depth: vec2f, gathered: f32, share: f32, seen: f32) {
    let node = node_of(gathered, share, LIGHT_NODES);
    if nodes[node].seen == 0.0 || node_begins(gathered, node, LIGHT_NODES) {
        nodes[node].t = t;
        nodes[node].depth = depth;
    }
    nodes[node].seen += seen;
}

// Lights a piece, where there is one, and begins the next at `t`, which may be farther on.
fn next_piece(m: ptr<function, March>, ray: LightRay, piece: Piece, t: f32) -> Piece {
    var sun = vec2f(0.0);
    if piece.seen > 0.0 {
        sun = sun_depth(light_ray_at(ray, piece.end));
        add_light(m, ray, piece, sun);
    }
    if t > piece.end {
        sun = sun_depth(light_ray_at(ray, t));
    }
    return Piece(t, t, sun, 0.0, 0.0, 0.0);
}

// Diffuse light changes slowly: it is found at the nodes alone, after the march.
fn light_nodes(m: ptr<function, March>, ray: LightRay) {
    for (var i = 0u; i < LIGHT_NODES; i++) {
        if nodes[i].seen > 0.0 {
            (*m).light = light_node((*m).light, ray, nodes[i]);
        }
    }
}
