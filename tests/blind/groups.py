"""Groups of recordings that look like benches: what people bring, each recording with its whole truth.

    bench        everything a little off, one or two causes 3 to 10 times larger
    bench_half   the same with the rest half as strong
    steady       one constant speed, 0.3 to 2 s, 5 to 50 control cycles per turn, one cause or none
    ramp         one run from standstill to speed or back, one cause or none
    outside      an effect that no cause stands for: a short between turns, a weak pole, hum in one current channel or in all, ringing
                 after switching edges, crosstalk, an encoder's interpolation, a sensor's hysteresis

The small effects of a bench are those of any drive: a compensated dead time, current sensors of unequal gain, iron that saturates and
takes some current, an angle sensor 0.2 degrees off, a warm winding, a ripple of the link. Each is physics of the plant that simulates
the bench. The motor file deviates within its tolerance too (digits.py). The truth file says which causes dominate, which are small, all
values of the true drive ("drive"), and what a model with these values reaches, for one cycle and in open loop ("oracle").
"""

import copy
import itertools

import numpy as np

import averaged
import draw
import effects
import motors

GROUPS = ["bench", "bench_half", "steady", "ramp", "outside"]
FEW = {"bench": 2, "bench_half": 1, "steady": 1, "ramp": 1, "outside": 2}  # of every CI run
FIRST_SEED = {"bench": 600_000, "bench_half": 610_000, "steady": 620_000, "ramp": 630_000, "outside": 640_000}

# The middle size of each small effect, in the measure of effects.RANGE: a tenth of a dead time of 0.3 to 1.5 % of a cycle is left
# behind its compensation, 0.3 % of gain, 3 % of inductance at the rated current, 0.6 % of the rated current at top speed through the
# iron, 3.5 mrad, 6 % of R (15 K), 0.5 % of the link.
SMALL = {"dead_time_compensated": 0.1, "current_gain": 0.003, "saturation": 0.03, "iron_loss": 0.006, "angle_harmonic": 0.0035,
         "resistance": 0.06, "dc_link_ripple": 0.005}
# Causes that may dominate as well, with the size that they would have as small ones.
FURTHER = {"flux_linkage": 0.006, "voltage_gain": 0.006, "angle_offset": 0.0035, "angle_delay": 0.02, "current_offset": 0.003,
           "inductance": 0.015, "saliency": 0.02, "emf_harmonics": 0.003, "phase_asymmetry": 0.06}
LARGER = (3.0, 10.0)
# What a dominating cause must show at least, as its share of the one-cycle error over the noise floor times the root of the rows: one
# that a recording hides dominates nothing.
EVIDENCE = 50.0
# One cause of a steady or a ramped recording.
ALONE = effects.CAUSES + ["iron_loss", "dc_link_ripple", "phase_inductance", "dead_time_compensated"]


def small_size(rng, name, strength):
    """Half to one and a half of the middle size."""
    return float(strength * SMALL[name] * rng.uniform(0.5, 1.5))


def dominating_size(rng, name):
    base = {**SMALL, **FURTHER}[name]
    return float(base * motors.log_uniform(rng, *LARGER))


def bench_effects(rng, strength, count, has_i_c, salient):
    """Ids, sizes and directions of a bench, the dominating ones last; how many dominate is `count`."""
    choice = [n for n in list(SMALL) + list(FURTHER) if not (n == "saturation" and salient)]
    while True:
        # A small saturation may join any inductance: only dominating ones exclude one another.
        large = [str(x) for x in rng.choice(choice, count, replace=False)]
        if all(effects.compatible(a, b) for a, b in itertools.combinations(large, 2)):
            break
    small = [name for name in SMALL if name not in large]
    ids, sizes, directions = [], [], []
    for name in small + large:
        d = effects.draw_direction(rng, name, has_i_c)
        size = small_size(rng, name, strength) if name in small else dominating_size(rng, name)
        if name == "resistance":
            d["sign"] = 1.0 if name in small else d["sign"]
        if name == "saturation":
            d["file_is_unsaturated"] = name in small or d["file_is_unsaturated"]
        if name == "dead_time_compensated":
            # Small: what is left of it is a tenth at most; large: 3 to 10 times that, or all of it.
            d["left"] = float(np.clip(d["left"] / abs(d["left"]) * size, -1.0, 1.0))
            size = motors.log_uniform(rng, 0.004, 0.015)
        ids.append(name)
        sizes.append(size)
        directions.append(d)
    return ids, sizes, directions, small, large


def draw_bench_case(seed, group):
    """Motor, file, bench and effects of a bench recording."""
    strength = 0.5 if group == "bench_half" else 1.0
    for attempt in range(60):
        rng = np.random.default_rng([seed, 20261, attempt])
        case = draw.draw_case(seed * 64 + attempt, "clean", "usual", True)
        case.seed, case.group, case.kind = seed, group, group
        count = 1 + int(rng.random() < 0.4)
        salient = case.motor.L_d_H != case.motor.L_q_H
        case.ids, case.sizes, case.directions, case.small, case.large = bench_effects(rng, strength, count, case.bench.has_i_c, salient)
        case.motor.span_s = draw.lane_starts(seed, case.bench, 1.0 / case.motor.f_pwm_Hz)[1]
        hide_in_file(case)
        if all(e >= EVIDENCE for e in pilot_evidence(case)):
            return case
    raise RuntimeError(f"seed {seed}: no bench of 60 shows what dominates")


def hide_in_file(case):
    """The file deviates in what no effect moves: what small effects move deviates by them already."""
    case.file_errors = draw.digits.relative_errors(case.seed, case.motor, case.ids)
    case.file = draw.digits.file_of(case.motor, case.file_errors)


def pilot_evidence(case):
    """What each dominating effect shows: from a short recording, for the rows of the whole one."""
    model, _ = draw.true_model(case.motor, case.ids, case.sizes, case.directions, case.bench.has_i_c)
    columns = draw.simulate(case.motor, case.bench, model, 100, [case.seed, 1])
    shown = shares(case, model, columns)
    return [shown[case.ids.index(name)] * np.sqrt(sum(case.bench.rows)) for name in case.large]


def shares(case, model, columns):
    """Each effect's share of the one-cycle error over the noise floor: the true model without it against the true model."""
    motor, T_s, out = case.motor, 1.0 / case.motor.f_pwm_Hz, []
    model = copy.copy(model)
    model.whole, model.i_knee_A = True, 0.02 * motor.I_rated_A_rms * np.sqrt(2.0)
    _, _, predicted = averaged.predict(columns, model, motor.pole_pairs, T_s)
    for name in case.ids:
        changed = without(case, name)
        changed.i_knee_A = model.i_knee_A
        if name == "dc_link_ripple":
            # Its phases are not in the columns: a constant voltage of the same rms.
            changed.k_u = model.k_u * (1.0 + model.u_ripple / np.sqrt(2.0))
        _, _, other = averaged.predict(columns, changed, motor.pole_pairs, T_s)
        n = min(len(other), len(predicted))
        out.append(averaged.rms(other[-n:] - predicted[-n:]) / draw.noise_floor_A(case.bench))
    return out


def without(case, name):
    """The true model without one of its effects."""
    rest = [n for n, other in enumerate(case.ids) if other != name]
    model, _ = draw.true_model(case.motor, *([x[n] for n in rest] for x in (case.ids, case.sizes, case.directions)), case.bench.has_i_c)
    model.whole = True
    return model


def draw_alone_case(seed, group):
    """A steady or ramped recording: one cause or none."""
    rng = np.random.default_rng([seed, 20262])
    kind = "clean" if rng.random() < 0.3 else str(rng.choice(ALONE))
    case = draw.draw_case(seed, kind, group, True)
    case.group, case.kind = group, group
    case.sizes = draw.draw_sizes(case)
    case.small, case.large = [], case.ids
    return case


def draw_outside_case(seed):
    """An effect of effects.OUTSIDE in turn, of a size between the middle one and the largest."""
    name = effects.OUTSIDE[seed % len(effects.OUTSIDE)]
    case = draw.draw_case(seed, name, "usual", True)
    if name in ("crosstalk", "common_hum"):
        case.bench.has_i_c = True  # of two channels the first is one of gains, the second nothing at all
    rng, (low, high) = np.random.default_rng([seed, 20263]), effects.RANGE[name]
    case.sizes = [motors.log_uniform(rng, np.sqrt(low * high), high)]
    case.group, case.kind, case.small, case.large = "outside", "outside", [], case.ids
    return case


def draw_case(seed, group):
    if group == "outside":
        return draw_outside_case(seed)
    if group in ("bench", "bench_half"):
        return draw_bench_case(seed, group)
    return draw_alone_case(seed, group)


def truth_of(case, model, parameters, columns, plant, open_loop=True):
    """The truth file: dominating and small effects, the whole drive, and what a model that knows it reaches."""
    truth = draw.truth_of(case, case.sizes, model, parameters, columns, plant)
    truth["group"] = case.group
    for effect, name, shown in zip(truth["effects"], case.ids, shares(case, model, columns)):
        effect["dominates"] = name in case.large
        if name not in effects.NOT_AVERAGED or name == "dc_link_ripple":
            effect["share_of_floor"] = round(float(shown), 3)
            effect["evidence"] = round(float(shown * np.sqrt(sum(case.bench.rows))), 1)
        for p in effect["parameters"]:
            if p["name"] == "L_0":
                p["value"] = 0.5 * (model.L_d_H + model.L_q_H)  # of a salient machine the mean of the two
            if p["name"] == "L" and np.isfinite(model.I_sat_A):
                # With a mild saturation any value between those at no and at the rated current is a true one.
                I_pk = case.motor.I_rated_A_rms * np.sqrt(2.0)
                p["low"] = p["value"] / (1.0 + (I_pk / model.I_sat_A) ** 2)
    truth["drive"] = drive_of(model, case.motor)
    truth["oracle"].update(oracle_of(case, model, columns, open_loop))
    return truth


def drive_of(model, motor):
    """All values of the true drive."""
    out = {"pole_pairs": motor.pole_pairs, "f_pwm_Hz": motor.f_pwm_Hz, "u_dc_V": motor.u_dc_V}
    for name, value in vars(model).items():
        if name in ("flux_map", "whole", "ripple_rad"):
            continue
        value = value.tolist() if isinstance(value, np.ndarray) else value
        out[name] = None if isinstance(value, float) and not np.isfinite(value) else value
    return out


def oracle_of(case, model, columns, open_loop=True):
    """Errors in percent of the current: one cycle and, which takes seconds, open loop, with the file's values and with the true ones."""
    motor, T_s = case.motor, 1.0 / case.motor.f_pwm_Hz
    rows = [min(n, columns["theta_e_rad"].shape[0]) for n in case.bench.rows]
    true = copy.copy(model)
    true.whole, true.ripple_rad = True, None
    if true.compensation_V or true.v_dead_V:
        # The link that the edges have; the compensation is a share of it (truth_of has done so for what is left).
        measured_V = float(columns["u_dc_V"].mean()) if "u_dc_V" in columns else motor.u_dc_V
        more = model.k_u * measured_V / motor.u_dc_V
        true.compensation_V, true.v_dead_V = more * model.compensation_V, more * model.v_dead_V
    if true.u_ripple:
        true.ripple_rad = averaged.ripple_phases(columns, true, motor.pole_pairs, T_s)
    if true.v_dead_V or true.compensation_V:
        _, _, _, true.i_knee_A = draw.oracle(columns, true, motor)
    nominal = effects.nominal_model(case.file, averaged.no_effect())
    out = {}
    for name, tried in (("nominal", nominal), ("true", true)):
        error, measured, _ = averaged.predict(columns, tried, motor.pole_pairs, T_s)
        out[f"{name}_percent"] = 100.0 * averaged.rms(error) / averaged.rms(measured)
        if open_loop:
            error, measured = averaged.open_loop(columns, tried, motor.pole_pairs, T_s, rows)
            out[f"open_loop_{name}_percent"] = 100.0 * averaged.rms(error) / averaged.rms(measured)
    out["gain"] = out["nominal_percent"] / out["true_percent"]
    return out


# ---- What can stand in for a cause at one operating point ----

def directions_of(model, motor):
    """Changed models, each by the most that a bench plausibly shows of one cause: id and model."""
    I_pk, T_s = motor.I_rated_A_rms * np.sqrt(2.0), 1.0 / motor.f_pwm_Hz

    def changed(**values):
        other = copy.deepcopy(model)
        for name, value in values.items():
            setattr(other, name, value)
        return other
    unit = np.eye(3)
    out = [("resistance", changed(R_ohm=1.8 * model.R_ohm)), ("inductance", changed(L_d_H=1.35 * model.L_d_H, L_q_H=1.35 * model.L_q_H)),
           ("saliency", changed(L_d_H=1.3 * model.L_d_H)), ("flux_linkage", changed(psi_f_Wb=1.2 * model.psi_f_Wb)),
           ("voltage_gain", changed(k_u=1.15 * model.k_u)), ("angle_offset", changed(theta_0_rad=model.theta_0_rad + 0.2)),
           ("angle_delay", changed(t_delay_s=model.t_delay_s + 0.8 * T_s)),
           ("dead_time", changed(v_dead_V=model.v_dead_V + 0.03 * motor.u_dc_V, i_knee_A=0.02 * I_pk)),
           ("emf_harmonics", changed(psi_5_Wb=model.psi_5_Wb + 0.08 * motor.psi_f_Wb)),
           ("emf_harmonics", changed(psi_7_Wb=model.psi_7_Wb + 0.08 * motor.psi_f_Wb))]
    # Without a common part: three equal resistances are a resistance, and so on.
    for apart in [unit[x] - 1.0 / 3.0 for x in range(2)]:
        out += [("current_offset", changed(o_A=model.o_A + 0.08 * I_pk * apart)), ("current_gain", changed(g=model.g + 0.1 * apart)),
                ("phase_asymmetry", changed(dR_ohm=model.dR_ohm + 1.2 * motor.R_ohm * apart)),
                ("phase_inductance", changed(dL_H=model.dL_H + 0.35 * motor.L_d_H * apart))]
    for order in (1, 2):
        if model.amplitude_rad == 0.0:
            out += [("angle_harmonic", changed(order=order, amplitude_rad=0.1, phase_rad=p)) for p in (0.0, 0.5 * np.pi)]
    return out


def separation(case, columns):
    """How many standard deviations of the noise lie between the one hidden cause and the best explanation by one or two others.

    A size costs as much: one standard deviation where it is as large as a bench plausibly shows. None: no cause, or one whose
    one-cycle error has no such law.
    """
    if len(case.ids) != 1 or effects.cause_of(case.ids[0]) in ("dc_link_ripple", "voltage_delay"):
        return None
    motor, T_s = case.motor, 1.0 / case.motor.f_pwm_Hz
    true, _ = draw.true_model(motor, case.ids, case.sizes, case.directions, case.bench.has_i_c)
    true.whole, nothing = True, without(case, case.ids[0])
    if true.v_dead_V:
        _, _, _, true.i_knee_A = draw.oracle(columns, true, motor)

    def predicted(model):
        found = averaged.predict(columns, model, motor.pole_pairs, T_s)[2].ravel()
        return np.concatenate([found.real, found.imag])
    base, noise = predicted(nothing), draw.noise_floor_A(case.bench) / np.sqrt(2.0)
    own = effects.cause_of(case.ids[0])
    hidden = (predicted(true) - base) / noise
    names, columns_of = zip(*[(cause, (predicted(other) - base) / noise) for cause, other in directions_of(nothing, motor) if cause != own])
    a = np.stack(columns_of, axis=1)
    gram, along, total = a.T @ a, a.T @ hidden, float(hidden @ hidden)
    best = total
    for pair in itertools.combinations(sorted(set(names)), 2):
        k = [n for n, name in enumerate(names) if name in pair]
        best = min(best, total - float(along[k] @ np.linalg.solve(gram[np.ix_(k, k)] + np.eye(len(k)), along[k])))
    return float(np.sqrt(max(best, 0.0)))


# ---- Making them ----

def make(seed, group, plant, folder, iqfoc, open_loop=True):
    """Writes rec.csv, motor.toml and truth.json of one recording of a group, with or without the oracle's open-loop error."""
    import generate  # which imports the plants
    case = draw_case(seed, group)
    if plant == "main":
        import main_plant
        model, parameters, columns = main_plant.simulate(case, case.sizes, folder, iqfoc)
    else:
        model, parameters = draw.true_model(case.motor, case.ids, case.sizes, case.directions, case.bench.has_i_c)
        columns = draw.simulate(case.motor, case.bench, model, max(case.bench.rows), [seed, 2])
    truth = truth_of(case, model, parameters, columns, plant, open_loop)
    if group in motors.ONE_RUN:
        truth["separation"] = separation(case, columns)
    if plant == "main":
        generate.write_truth(truth, folder)
    else:
        drawn = draw.SimpleNamespace(motor=case.motor, file=case.file, bench=case.bench, columns=columns, truth=truth)
        generate.write(drawn, folder)


def plants_of(group, seed):
    """The plants that a recording of a group can come from."""
    return ("second", "main")


def cases(group, count, first=None):
    """(seed, group, plant) of so many recordings: the plants take turns."""
    first = FIRST_SEED[group] if first is None else first
    out = []
    for n in range(count):
        plants = plants_of(group, first + n)
        # Shifted each time the effects outside have been through, so that each meets both plants.
        turn = n + n // len(effects.OUTSIDE) if group == "outside" else n
        out.append((first + n, group, plants[turn % len(plants)]))
    return out
