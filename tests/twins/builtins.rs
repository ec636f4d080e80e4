//! What the driver's own functions are off by, over what the library gives them.

use std::f64::consts::PI;

use crate::harness::Twin;
use crate::pack::{one, scalars};

pub fn twins() -> Vec<Twin> {
    vec![
        Twin::new("exp", "constants", "return vec4f(exp(-x[0].x));", |x| one((-x[0][0]).exp()))
            .over("built-in", |random| scalars([random.log(1e-6, 60.0)])),
        Twin::new("log", "constants", "return vec4f(log(x[0].x));", |x| one(x[0][0].ln()))
            .over("built-in", |random| scalars([random.log(1e-6, 1e6)])),
        Twin::new("log of 1 to 2", "constants", "return vec4f(log(x[0].x));", |x| one(x[0][0].ln()))
            .over("built-in", |random| scalars([1.0 + random.log(1e-6, 1.0)])),
        Twin::new("pow", "constants", "return vec4f(pow(x[0].x, x[0].y));", |x| one(x[0][0].powf(x[0][1])))
            .over("built-in", |random| scalars([random.log(1e-6, 1.0), random.between(0.4, 0.7)])),
        Twin::new("sqrt", "constants", "return vec4f(sqrt(x[0].x));", |x| one(x[0][0].sqrt()))
            .over("built-in", |random| scalars([random.log(1e-20, 1e20)])),
        Twin::new("inverseSqrt", "constants", "return vec4f(inverseSqrt(x[0].x));", |x| {
            one(x[0][0].sqrt().recip())
        })
        .over("built-in", |random| scalars([random.log(1e-20, 1e20)])),
        Twin::new("division", "constants", "return vec4f(x[0].x / x[0].y);", |x| one(x[0][0] / x[0][1]))
            .over("built-in", |random| scalars([random.log(1e-6, 1e6), random.log(1e-6, 1e6)])),
        // WGSL asks of sin and cos to be within 2^-11 up to pi: 16 last places of 256.
        Twin::new("sin", "constants", "return vec4f(sin(x[0].x));", |x| one(x[0][0].sin()))
            .over("built-in", |random| scalars([random.between(-PI, PI)]))
            .beside(256.0),
        Twin::new("cos", "constants", "return vec4f(cos(x[0].x));", |x| one(x[0][0].cos()))
            .over("built-in", |random| scalars([random.between(-PI, PI)]))
            .beside(256.0),
    ]
}
