//! The functions of shaders with bindings. What they compute stands in `shaders/lib`, where a twin can
//! call it; they themselves do what these kinds tell.

/// Words of formulas: no shader with bindings has any.
pub const FORMULAS: &[&str] = &[
    "exp",
    "exp2",
    "log",
    "log2",
    "pow",
    "sqrt",
    "inverseSqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "PI",
    "INV_4PI",
];

/// A kind, and its functions by module or role. Functions of the same name in modules that fill one role
/// are told once.
pub const KINDS: &[(&str, &[(&str, &str)])] = &[
    (
        "entry points: a thread's place, what it reads, calls and stores",
        &[
            ("aerial", "main"),
            ("compose", "vertex fragment"),
            ("depth_bake", "main"),
            ("ground_light", "main"),
            ("march", "quad beauty layers normals cost"),
            ("mips", "main"),
            ("moments_entering", "main"),
            ("moments_keep", "main"),
            ("moments_medium", "main"),
            ("moments_prolong", "main"),
            ("moments_restrict", "main"),
            ("moments_scatter", "main"),
            ("moments_sweep", "main"),
            ("moments_view", "main"),
            ("multiple_scattering", "main"),
            ("path", "main"),
            ("resolve", "vertex fragment"),
            ("sky", "vertex fragment"),
            ("sky_light", "main"),
            ("sky_view", "main"),
            ("sky_volume", "main"),
            ("sun_maps", "main"),
            ("sun_normals", "main"),
            ("transmittance", "main"),
            ("voxels", "main"),
        ],
    ),
    (
        "read a texture or buffer, for functions of the library to take",
        &[
            ("march", "sun_at drawn_distance"),
            ("moments_entering", "radiance_from"),
            ("moments_medium", "extinction_at"),
            ("moments_view", "moments_at"),
            ("path", "table_at phase sun_at sky_from"),
            ("resolve", "mean_of_rays heat"),
            ("sky", "air_and_ground sun_disc transmittance_from"),
            ("sky_light", "radiance_from"),
            ("sky_volume", "extinction_at"),
            ("sun_maps", "transported_others extinction_at"),
            ("sun_normals", "surface_at"),
            ("voxels", "extinction_at"),
            ("openness", "conductances_at"),
            ("slab_maps", "fitted_slab lit_facing"),
            ("sunlight", "sun_phase light_sun_depth light_glare"),
            ("steps", "kept_of"),
            ("medium", "medium_species depth_place depth_texel baked_depth"),
            ("slab_lookup", "set_radiance"),
        ],
    ),
    (
        "sums over samples, cells, rays, orders or ellipsoids, each of which the library weighs",
        &[
            ("moments_prolong", "interpolated"),
            ("moments_restrict", "averaged"),
            ("moments_scatter", "gathered"),
            ("multiple_scattering", "orders_along"),
            ("sky_volume", "optical_depth_along"),
            ("sun_maps", "shadow_of_others others_with others_all"),
            ("medium", "medium_at medium_mean_at medium_on_ray medium_facing clouds_at cloud_at"),
            ("light", "slab_sets slab_radiance"),
        ],
    ),
    (
        "bookkeeping: what comes next, what is counted, what is compiled out",
        &[
            ("counts", "count"),
            ("march", "store_counts shade"),
            ("steps", "march"),
            ("gather", "add_light add_node next_piece light_nodes"),
            ("sun_maps", "collect_hits"),
            ("medium", "medium_begin medium_ahead find_near farthest_near listed"),
            ("slab_maps", "absorbed_source"),
            (
                "path",
                "draw sample_of scattered track start finish start_or_done carried collide share_to_sun
                 choose_direction roulette near_sun scatter advance",
            ),
        ],
    ),
    (
        "a model of light: which functions of the library it takes for a piece, a node and a ray",
        &[
            ("openness", "diffuse_weights diffuse_node diffuse_light light_ahead"),
            ("slab_maps", "slab_ray"),
            ("slab_nodes", "light_begin light_reads_nodes light_piece light_node light_ray"),
            ("slab_surface", "light_begin light_reads_nodes light_piece light_node light_ray"),
            ("sunlight", "sun_single light_transported"),
            (
                "light",
                "light_begin light_glare light_transported light_ahead light_reads_nodes light_sun_depth light_piece
                 light_node light_ray multiple_source source_of_sun",
            ),
        ],
    ),
];
