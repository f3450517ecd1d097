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
     "sine on the DC link, also in the measured link (logged=1) or not",
     {{"amplitude", "V", KEY_REAL, AT(inverter.ripple_V), 0.03, OF_LINK, false},
      {"frequency", "Hz", KEY_REAL, AT(inverter.ripple_Hz), 300.0, ABSOLUTE, true},
      {"logged", "1", KEY_FLAG, AT(inverter.ripple_logged), 1.0, ABSOLUTE, false}}},
    {"glitch",
     "sometimes a PWM update is missed: the last duties act again",
     {{"probability", "1", KEY_REAL, AT(inverter.glitch_probability), 0.002, ABSOLUTE, false}}},
    {"loose_sensor",
     "dropouts of one current channel: it reads gain * value + step",
     {{"probability", "1", KEY_REAL, AT(sensors.loose_probability), 0.001, ABSOLUTE, false},
      {"channel", "1", KEY_WHOLE, AT(sensors.loose_channel), 0.0, ABSOLUTE, false},
      {"samples", "1", KEY_REAL, AT(sensors.loose_samples), 3.0, ABSOLUTE, false},
      {"gain", "1", KEY_REAL, AT(sensors.loose_gain), 0.0, ABSOLUTE, false},
      {"step", "A", KEY_REAL, AT(sensors.loose_step_A), 0.0, ABSOLUTE, false}}},
    {"sensor_hysteresis",
     "a current channel stands still until its current has turned by twice the width",
     {{"width", "A", KEY_REAL, AT(sensors.hysteresis_A), 0.01, OF_RATED, false}}},
    {"crosstalk",
     "channel b reads a share of channel a as well, channel c one of b",
     {{"share", "1", KEY_REAL, AT(sensors.crosstalk), 0.02, ABSOLUTE, false}}},
    {"hum",
     "a sine picked up by one current channel (1, 2, 3) or by all three alike (0)",
     {{"amplitude", "A", KEY_REAL, AT(sensors.hum_A), 0.01, OF_RATED, false},
      {"frequency", "Hz", KEY_REAL, AT(sensors.hum_Hz), 50.0, ABSOLUTE, true},
      {"channel", "1", KEY_WHOLE, AT(sensors.hum_channel), 0.0, ABSOLUTE, false}}},
    {"switching_noise",
     "a current channel reads more after a rising edge of its leg, less after a falling one, and the others "
     "a share",
     {{"amplitude", "A", KEY_REAL, AT(sensors.edge_A), 0.1, OF_RATED, false},
      {"tau", "s", KEY_REAL, AT(sensors.edge_s), 0.05, OF_CYCLE, true},
      {"coupling", "1", KEY_REAL, AT(sensors.edge_coupling), 0.0, ABSOLUTE, false}}},
    {"turn_short",
     "a share of one phase's turns short-circuited through R",
     {{"turns", "1", KEY_REAL, AT(machine.short_turns), 0.05, ABSOLUTE, true},
      {"R", "ohm", KEY_REAL, AT(machine.short_ohm), 1.0, OF_RESISTANCE, true},
      {"tau", "s", KEY_REAL, AT(machine.short_s), 0.3, OF_CYCLE, true},
      {"phase", "1", KEY_REAL, AT(machine.short_phase), 1.0, ABSOLUTE, true}}},
    {"weak_pole",
     "the magnet's flux is less by a share where one pole pair passes",
     {{"share", "1", KEY_REAL, AT(machine.weak_pole), 0.1, ABSOLUTE, false}}},
    {"eccentricity",
     "the magnet's flux varies by a share once per mechanical revolution",
     {{"share", "1", KEY_REAL, AT(machine.eccentricity), 0.03, ABSOLUTE, false}}},
};

const int effect_table_length = (int)(sizeof effect_table / sizeof effect_table[0]);
