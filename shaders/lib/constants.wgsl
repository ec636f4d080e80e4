// Constants of mathematics.

const PI: f32 = 3.14159265358979;
const INV_4PI: f32 = 0.0795774715459477;
