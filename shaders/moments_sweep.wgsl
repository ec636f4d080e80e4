// Light along each direction of the quadrature through the field, from the source that the
// last round of scattering left: short characteristics (`lib/characteristic`). One workgroup a direction and light; it goes from plane to
// plane across the axis along which its direction crosses cells the fastest. A field that repeats itself is gone through from
// top to bottom, and what is outside of it beside comes from the opposite face.
// @use characteristic field flash

// Whether a ball shines in the field: then no light enters, and `entering` is the share of the ball's that counts.
override FLASH: bool = false;

@group(0) @binding(0) var<uniform> field: Field;
@group(0) @binding(1) var<storage, read> cells: array<f32>;
// Unit vectors of propagation, and their weights, which add up to 4 pi.
@group(0) @binding(2) var<storage, read> directions: array<vec4f>;
// Radiance that enters the box, by light and direction.
@group(0) @binding(3) var<storage, read> entering: array<f32>;
// Source per unit of extinction, and radiance: by light, direction and cell.
@group(0) @binding(4) var<storage, read> source: array<f32>;
@group(0) @binding(5) var<storage, read_write> radiance: array<f32>;

const THREADS: u32 = 128u;

// What a cell of the ball gives off along `length` metres on the way to its middle.
fn flash_through(cell: u32, length: f32, extinction: f32) -> f32 {
    let low = field.low + vec3f(field_place(field, cell)) * field.cell;
    let share = flash_share(field.flash, low, low + field.cell);
    let volume = field.cell.x * field.cell.y * field.cell.z;
    return flash_emission(field.flash.w, share, volume) * length * mean_through(length * extinction);
}

@compute @workgroup_size(THREADS)
fn main(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3u) {
    // Find the axis and what a step from plane to plane is.
    let way = directions[group.x].xyz;
    let rates = way / field.cell;
    let a = select(sweep_axis(rates), 1u, field.repeats == 1u);
    let u = (a + 1u) % 3u;
    let v = (a + 2u) % 3u;
    let step = 1.0 / abs(rates[a]);
    let shift = vec2f(rates[u], rates[v]) * step;
    let strides = vec3u(1u, field.size.x, field.size.x * field.size.y);
    let planes = field.size[a];
    let size = vec2u(field.size[u], field.size[v]);
    let first = (group.y * field.directions + group.x) * field_cells(field);
    let given = entering[group.y * field.directions + group.x];
    let outside = select(given, 0.0, FLASH);
    for (var s = 0u; s < planes; s++) {
        let plane = select(planes - 1u - s, s, rates[a] > 0.0) * strides[a];
        let before = select(plane + strides[a], plane - strides[a], rates[a] > 0.0);
        for (var c = thread; c < size.x * size.y; c += THREADS) {
            let at = vec2u(c % size.x, c / size.x);
            let cell = plane + at.x * strides[u] + at.y * strides[v];
            let here = cells[cell];
            let source_here = source[first + cell];
            // Interpolate what comes from the plane before.
            var up = vec3f(outside, 0.0, source_here);
            if s > 0u {
                let from_place = vec2f(at) - shift;
                let low = floor(from_place);
                let part = from_place - low;
                up = vec3f(0.0);
                for (var i = 0u; i < 4u; i++) {
                    let side = vec2f(vec2u(i & 1u, i >> 1u));
                    let place = vec2i(low + side);
                    let like = ((place % vec2i(size)) + vec2i(size)) % vec2i(size);
                    let inside = field.repeats == 1u || all(place == like);
                    let held = vec2u(select(clamp(place, vec2i(0), vec2i(size) - 1), like, field.repeats == 1u));
                    let other = before + held.x * strides[u] + held.y * strides[v];
                    let value = vec3f(radiance[first + other], cells[other], source[first + other]);
                    up += bilinear_weight(part, i) * select(vec3f(outside, 0.0, source_here), value, inside);
                }
            }
            var light = short_characteristic(Upwind(up.x, up.y, up.z), here, source_here, step);
            if FLASH {
                light += given * flash_through(cell, step, 0.5 * (here + up.y));
            }
            radiance[first + cell] = light;
        }
        storageBarrier();
        workgroupBarrier();
    }
}
