// What one control cycle ahead looks like at 6,000 rpm with four pole pairs and 5 kHz, 12.5 cycles to a turn: the current in
// the stationary frame, predicted by forward Euler and with the EMF turning with the rotor. Prints both once a second, in
// thousandths of the base. No drive needs to be connected.
#include <iqfoc.h>

static constexpr double T_S = 2e-4;  // control cycle, s
static constexpr double U_B = 400.0; // nominal DC link, V

static const iqfoc_predictor_t predictor =
    IQFOC_PREDICTOR(0.5, 3e-3, 0.09, T_S, IQFOC_I_BASE(8.0), U_B); // ohm, H, Wb; rated current, A rms

static void print_current(const char *name, iqfoc_ab_t i)
{
    Serial.print(name);
    Serial.print(i.alpha / (IQ24_ONE / 1000));
    Serial.print(" ");
    Serial.println(i.beta / (IQ24_ONE / 1000));
}

void setup()
{
    Serial.begin(115200);
}

void loop()
{
    const iq24_t theta = IQ24(0.1); // turns
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(IQFOC_SPEED(6000.0, 4, T_S));
    const iqfoc_ab_t i = {IQ24(0.3), IQ24(0.6)};
    const iqfoc_ab_t u = {IQ24(-0.2), IQ24(0.4)};
    print_current("Euler          ", iqfoc_predictor_euler(&predictor, i, u, &rotor, iq24_sincos(theta)));
    print_current("quasi-discrete ",
                  iqfoc_predictor_quasi_discrete(&predictor, i, u, &rotor, iq24_sincos(theta + rotor.speed / 2)));
    delay(1000);
}
