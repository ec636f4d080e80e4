// Light of a set of orders in a slab, from Bouthors' functions.
// @use counts slab_functions

@group(2) @binding(9) var slab_angles: texture_2d<f32>;
@group(2) @binding(10) var slab_views: texture_2d<f32>;
@group(2) @binding(11) var slab_suns: texture_2d<f32>;

fn set_radiance(orders: u32, view: SlabView) -> f32 {
    count(MAP_READS, 3u);
    return slab_functions(slab_angles, slab_views, slab_suns, linear, orders, view);
}
