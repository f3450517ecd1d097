/* All effects with their keys (plant_effect_table.h). */
#include "plant_effect_table.h"
#include "plant_config.h"

#define AT(field) offsetof(plant_config, field)

const effect effect_table[] = {
/* clang-format off */
/* The causes of interfaces.md that the plant has physics for. */
#define CAUSE(ID, id, firmware, words, law, noun) {id, law, {
#define EFFECT_KEY(name, unit, kind, member, typical, of, needed) \
    {name, unit, KEY_##kind, AT(member), typical, of, needed},
#define CAUSE_END }},
#include "../data/causes.def"
    /* clang-format on */

    /* Disturbances, and properties of sensors. */
    {"current_noise",
     "standard deviation of each sample",
     {{"sigma", "A", KEY_REAL, AT(sensors.current_noise_A), 0.002, OF_RATED, false}}},
    {"current_quantisation",
     "converter over -full_scale .. +full_scale",
     {{"bits", "1", KEY_WHOLE, AT(sensors.current_bits), 12.0, ABSOLUTE, false},
      {"full_scale", "A", KEY_REAL, AT(sensors.current_full_scale_A), 2.0, OF_RATED, true}}},
    {"current_bandwidth",
     "first-order low-pass",
     {{"f", "Hz", KEY_REAL, AT(sensors.current_bandwidth_Hz), 50e3, ABSOLUTE, false}}},
    {"angle_noise",
     "standard deviation, electrical",
     {{"sigma", "rad", KEY_REAL, AT(sensors.angle_noise_rad), 0.001, ABSOLUTE, false}}},
    {"u_dc_ripple",
     "sine on the DC link, in the measured link too (logged=1) or not",
     {{"amplitude", "V", KEY_REAL, AT(inverter.ripple_V), 0.03, OF_LINK, false},
      {"frequency", "Hz", KEY_REAL, AT(inverter.ripple_Hz), 300.0, ABSOLUTE, true},
      {"logged", "1", KEY_FLAG, AT(inverter.ripple_logged), 1.0, ABSOLUTE, false}}},
    {"glitch",
     "a PWM update missed now and then: the last duties stay",
     {{"probability", "1", KEY_REAL, AT(inverter.glitch_probability), 0.002, ABSOLUTE, false}}},
    {"loose_sensor",
     "dropouts of one current channel: it reads gain * value + step",
     {{"probability", "1", KEY_REAL, AT(sensors.loose_probability), 0.001, ABSOLUTE, false},
      {"channel", "1", KEY_WHOLE, AT(sensors.loose_channel), 0.0, ABSOLUTE, false},
      {"samples", "1", KEY_REAL, AT(sensors.loose_samples), 3.0, ABSOLUTE, false},
      {"gain", "1", KEY_REAL, AT(sensors.loose_gain), 0.0, ABSOLUTE, false},
      {"step", "A", KEY_REAL, AT(sensors.loose_step_A), 0.0, ABSOLUTE, false}}},
};

const int effect_table_length = (int)(sizeof effect_table / sizeof effect_table[0]);
