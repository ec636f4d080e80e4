// The shadow of another cloud on one, from what the volumes of both tell of each alone. One thread marches a column
// of the one: to its optical depth comes that of the other before it, and where both are in one place, the denser
// one counts.
// @use light_box

@group(0) @binding(0) var<uniform> box: LightBox;
// Of the other, in the same frame.
@group(0) @binding(1) var<uniform> other_box: LightBox;
@group(0) @binding(2) var before: texture_3d<f32>;
@group(0) @binding(3) var other: texture_3d<f32>;
@group(0) @binding(4) var linear: sampler;
@group(0) @binding(5) var volume: texture_storage_3d<rgba16float, write>;

// Whether this is the first other cloud: what was known of shadows before is left out.
override FIRST: bool = true;

// What is known of a voxel: optical depth to the sun, the part of it in shadow, that of the cloud alone.
fn known_at(voxel: vec3u) -> vec3f {
    let known = textureLoad(before, voxel, 0).rgb;
    return select(known, vec3f(known.b, 0.0, known.b), FIRST);
}

// Optical depth of the other cloud between the sun and a point.
fn other_depth(p: vec3f) -> f32 {
    let at = light_box_coordinate(other_box, p);
    let depth = textureSampleLevel(other, linear, at, 0.0).b;
    return depth * light_box_entered(at, textureDimensions(other).z);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(volume);
    if any(id.xy >= size.xy) {
        return;
    }
    let uv = (vec2f(id.xy) + 0.5) / vec2f(size.xy);
    let above = other_depth(light_box_point(box, vec3f(uv, 0.0)));
    let shadow = known_at(vec3u(id.xy, 0u)).g;
    var depth = shadow + above;
    var passed = vec2f(shadow, above);
    for (var z = 0u; z < size.z; z++) {
        let known = known_at(vec3u(id.xy, z));
        let w = (f32(z) + 0.5) / f32(size.z);
        let now = vec2f(known.r, other_depth(light_box_point(box, vec3f(uv, w))));
        let thickness = max(now - passed, vec2f(0.0));
        depth += max(thickness.x, thickness.y);
        passed = now;
        let told = min(vec3f(depth, shadow + above, known.b), vec3f(LIGHT_BOX_MOST));
        textureStore(volume, vec3u(id.xy, z), vec4f(told, 0.0));
    }
}
