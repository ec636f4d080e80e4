// STUB
struct Atmosphere { a: vec4f }
fn sun_irradiance_at(air: Atmosphere, lut: texture_2d<f32>, s: sampler, altitude: f32, mu: f32) -> vec3f { return textureSampleLevel(lut, s, vec2f(0.5), 0.0).rgb * air.a.rgb; }
fn aerial_perspective(v: texture_3d<f32>, s: sampler, uv: vec2f, distance: f32, range: f32) -> vec4f { return textureSampleLevel(v, s, vec3f(uv, distance / range), 0.0); }
