// Light of a set of orders in a slab, from a table of it.
// @use counts slab_direct

@group(2) @binding(9) var slab_modes: texture_3d<f32>;
@group(2) @binding(10) var slab_phases: texture_2d<f32>;

fn set_radiance(orders: u32, view: SlabView) -> f32 {
    count(MAP_READS, 3u);
    return slab_direct(slab_modes, slab_phases, linear, orders, view);
}
