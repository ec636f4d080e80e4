// What a cloud and the lights outside have, for models of light; all else is compiled out.

// Whether sky and ground give light.
override SKY_LIGHT: bool = true;
// Whether the phase function has a forward peak.
override PEAK: bool = true;
// Whether the particles absorb.
override ABSORBING: bool = false;
// Whether the cloud repeats itself, and with it what was solved for: that is then told for all directions.
override REPEATS: bool = false;
// Whether the light comes from a ball in the cloud and not from outside.
override FLASH: bool = false;
