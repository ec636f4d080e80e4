// The cells of a field as the eye sees them.
// @use field harmonics

// From a cell to the eye.
struct CellView {
    // Unit vector of the light that the eye gets.
    direction: vec3f,
    // From 0, where the eye is so near that light of all directions goes to it, to 1.
    far: f32,
}

// Distances of the eye, in cells, between which it comes to be far.
const NEAR: f32 = 1.0;
const FAR: f32 = 3.0;

// `eye` is its place in the cloud's frame, m, and 1, or, if all lines of sight are parallel, the direction of
// the light that it gets, and 0.
fn field_view(field: Field, eye: vec4f, cell: u32) -> CellView {
    if eye.w == 0.0 {
        return CellView(eye.xyz, 1.0);
    }
    let middle = field.low + (vec3f(field_place(field, cell)) + 0.5) * field.cell;
    let away = eye.xyz - middle;
    let edge = max(field.cell.x, max(field.cell.y, field.cell.z));
    return CellView(normalize(away + vec3f(0.0, 1e-6 * edge, 0.0)), smoothstep(NEAR, FAR, length(away) / edge));
}

// Light towards the eye; near it, the mean over all directions.
fn view_light(moments: array<vec4f, 4>, view: CellView) -> f32 {
    return mix(moments[0].x * harmonics_low(view.direction).x, harmonics_sum(moments, view.direction), view.far);
}

// The same to first order in the direction d of the light: the first number plus the dot product of d and
// the rest.
fn view_expansion(moments: array<vec4f, 4>, view: CellView) -> vec4f {
    let slope = harmonics_gradient(moments, view.direction);
    let across = slope - dot(slope, view.direction) * view.direction;
    let linear = harmonics_low(vec3f(1.0)) * moments[0];
    return mix(linear, vec4f(harmonics_sum(moments, view.direction), across), view.far);
}

// The light towards a direction near to the eye's from its expansion; none is below 0.
fn expanded(expansion: vec4f, d: vec3f) -> f32 {
    return max(expansion.x + dot(expansion.yzw, d), 0.0);
}
