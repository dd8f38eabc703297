// SPDX-License-Identifier: MIT
// One joint with a harmonic drive, integrated from its equations of motion. Uses nothing of the tool.
//
// Bodies: motor (angle th, on the output side of the gear) and link (q), with a flexspline between them: a
// spring with linear and cubic stiffness and damping, wound up by th + transmission error(th) - q. A discrete
// controller (PD with integrator and feedforward of the rigid body) acts on the quantized encoder of the
// motor. Friction of motor and link is LuGre: bristles that deflect, whose tension relaxes in the grease at
// standstill (as in a Maxwell element). The torque sensor is at the flexspline's output: it shows what drives
// the link, plus the strain by which the wave generator deforms the gauges.
//
// Input: lines "key value ..." up to "reference COUNT", then COUNT rows of four float64 (angle, speed,
// acceleration in rad, and external torque on the link in Nm) at the controller's rate. Output: rows of six
// float64 at the log's rate: motor angle and speed, link angle and speed, measured torque, torque across the
// flexspline; rad, rad/s, Nm. Semi-implicit Euler (speeds before angles), bristles implicit.
#include <cmath>
#include <cstdio>
#include <deque>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double steps_per_second = 16000;
constexpr double dt = 1 / steps_per_second;
constexpr int controller_rate = 2000;

struct Wave {
    double order = 0, amplitude = 0, phase = 0;
};

struct Input {
    std::map<std::string, double> numbers;
    std::map<std::string, std::vector<Wave>> waves;
    double get(const std::string& key, double otherwise = 0) const {
        const auto found = numbers.find(key);
        return found == numbers.end() ? otherwise : found->second;
    }
    std::vector<Wave> all(const std::string& key) const {
        const auto found = waves.find(key);
        return found == waves.end() ? std::vector<Wave>{} : found->second;
    }
};

// LuGre bristles: tension = stiffness * z, z at most level / stiffness while sliding. Below the creep speed
// the tension relaxes.
struct Bristle {
    double stiffness = 0, damping = 0, creep = 0, z = 0;
    double force(double v, double level) {
        if (stiffness <= 0 || level <= 0) return 0;
        double rate = std::fabs(v);
        if (creep > 0) rate += creep / (1 + v * v / (creep * creep));
        rate *= stiffness / level;
        const double before = z;
        z = (z + v * dt) / (1 + dt * rate);
        return stiffness * z + damping * (z - before) / dt;
    }
    double load(double level) const { return level > 0 ? stiffness * z / level : 0; }
};

struct Joint {
    explicit Joint(const Input& in) : p(in) {
        te = in.all("te"), gauge = in.all("gauge"), mesh = in.all("mesh"), spline = in.all("spline");
        tone = in.all("tone");
        link_friction = {p.get("bristle"), p.get("bristle_damping"), p.get("creep"), 0};
        soft_friction = {p.get("soft_level") / p.get("soft_width", 1), 0, 0, 0};
        motor_friction = {p.get("motor_bristle"), 0, p.get("creep"), 0};
    }

    const Input& p;
    std::vector<Wave> te, gauge, mesh, spline, tone;
    Bristle link_friction, soft_friction, motor_friction;
    double th = 0, w = 0, q = 0, v = 0;  // motor and link
    double flex_x = 0, flex_v = 0;       // payload on its own spring, relative to the link
    double grip = 0;                     // flank that carries, -1 to 1
    double drive = 0;                    // torque of the motor
    double spring = 0;                   // torque across the flexspline
    double heat = 0;                     // of the friction, 0 cold to 1 warm
    double lag = 0, low1 = 0, low2 = 0, zero = 0;
    std::deque<double> line;  // torque on its way to the log

    const double ratio = p.get("ratio", 100);
    const double jm = p.get("motor_inertia"), k = p.get("stiffness"), k3 = p.get("cubic");
    const double damp = p.get("damping"), backlash = p.get("backlash") / 2;
    const double weight = p.get("weight"), weight_angle = p.get("weight_angle");
    const double inertia = p.get("link_inertia");
    const double coulomb = p.get("coulomb"), stick = p.get("stick"), stribeck = p.get("stribeck_speed", 1);
    const double viscous = p.get("viscous"), drag = p.get("drag"), drag_exponent = p.get("drag_exponent", 2);
    const double by_load = p.get("friction_by_load"), asymmetry = p.get("asymmetry");
    const double viscous_asymmetry = p.get("viscous_asymmetry");
    const double warm = p.get("warm"), warm_s = p.get("warm_s", 10);
    const double uneven = p.get("uneven"), uneven_angle = p.get("uneven_angle");
    const double motor_level = p.get("motor_coulomb"), motor_viscous = p.get("motor_viscous");
    const double soft_level = p.get("soft_level");
    const double flex_j = p.get("flex_inertia"), flex_w = 2 * pi * p.get("flex_hz"),
                 flex_d = p.get("flex_damping");
    const double added_at = p.get("added_at", 1e9), added_j = p.get("added_inertia"),
                 added_g = p.get("added_weight");
    const double bump = p.get("bump"), bump_at = p.get("bump_at"), bump_width = p.get("bump_width", 1);
    const double eccentric = p.get("eccentric"), eccentric_angle = p.get("eccentric_angle");
    const double load_gain = p.get("gauge_by_load"), load_knee = p.get("gauge_load_knee", 1);
    const double flank_gain = p.get("flank_gain"), flank_phase = p.get("flank_phase");
    const double drift = p.get("drift"), drift_s = p.get("drift_s", 10);
    const double lag_s = p.get("lag"), low_w = 2 * pi * p.get("low_pass_hz");
    const std::size_t delay_steps = static_cast<std::size_t>(std::lround(p.get("delay") * steps_per_second));

    static double sum(const std::vector<Wave>& waves, double angle) {
        double total = 0;
        for (const auto& wave : waves) total += wave.amplitude * std::cos(wave.order * angle + wave.phase);
        return total;
    }
    static double slope(const std::vector<Wave>& waves, double angle) {
        double total = 0;
        for (const auto& wave : waves)
            total -= wave.order * wave.amplitude * std::sin(wave.order * angle + wave.phase);
        return total;
    }

    double gravity(double t) const {
        return (weight != 0 ? weight * std::cos(q + weight_angle) : 0) +
               (t > added_at ? added_g * std::cos(q + weight_angle) : 0);
    }

    double friction(double t) {
        const double sliding = std::fabs(v);
        double level = coulomb;
        if (stick > 0) level += stick * std::exp(-std::pow(sliding / stribeck, 2));
        if (by_load > 0) level += by_load * std::fabs(spring);
        if (asymmetry != 0) level *= 1 + (v > 0 ? asymmetry : -asymmetry);
        if (warm != 0) level *= 1 + warm * (1 - heat);
        if (uneven != 0) level *= 1 + uneven * std::cos(q + uneven_angle);
        double total = link_friction.force(v, level) + viscous * (v + viscous_asymmetry * sliding);
        if (drag != 0) total += drag * std::copysign(std::pow(sliding, drag_exponent), v);
        if (soft_level > 0) total += soft_friction.force(v, soft_level);
        if (bump != 0) total += bump * std::exp(-std::pow((q - bump_at) / bump_width, 2));
        if (warm != 0 && t > 0) heat += dt * (1 - heat) / warm_s;
        return total;
    }

    void step(double t, double outside) {
        const double wave = ratio * th;
        double wind = th - q, wind_speed = w - v, lever = 1;
        if (!te.empty()) {
            const double error_slope = ratio * slope(te, wave);
            wind += sum(te, wave), wind_speed += error_slope * w, lever += error_slope;
        }
        if (backlash > 0) {
            const double inside = std::fmin(std::fmax(wind, -backlash), backlash);
            wind -= inside;
            if (wind == 0) wind_speed = 0;
        }
        spring = k * wind + k3 * wind * wind * wind + damp * wind_speed;
        const double meshing = mesh.empty() ? 0 : sum(mesh, wave);
        const double rubbing = motor_friction.force(w, motor_level) + motor_viscous * w;
        grip += dt * (std::tanh(motor_friction.load(motor_level) * 3) - grip) / 0.002;
        w += dt * (drive - lever * spring + meshing - rubbing) / jm;

        const double whole = inertia + (t > added_at ? added_j : 0);
        double on_link = spring - meshing - gravity(t) - friction(t) + outside;
        if (flex_j > 0) on_link += flex_j * (flex_w * flex_w * flex_x + 2 * flex_d * flex_w * flex_v);
        const double acceleration = on_link / whole;
        if (flex_j > 0) {
            flex_v += dt * (-acceleration - flex_w * flex_w * flex_x - 2 * flex_d * flex_w * flex_v);
            flex_x += dt * flex_v;
        }
        v += dt * acceleration;
        th += dt * w;
        q += dt * v;
    }

    // What the sensor's amplifier shows.
    double sensed(double t) {
        const double wave = ratio * th;
        double depth = 1, shift = 0;
        if (eccentric != 0) depth *= std::pow(1 + eccentric * std::cos(q + eccentric_angle), 1.5);
        if (load_gain != 0) depth *= 1 + load_gain * (std::hypot(load_knee, spring) - load_knee);
        if (flank_gain != 0 || flank_phase != 0) depth *= 1 + flank_gain * grip, shift = flank_phase * grip;
        double total = spring;
        for (const auto& g : gauge) total += g.amplitude * depth * std::cos(g.order * wave + g.phase + shift);
        if (!spline.empty()) total += sum(spline, q);
        for (const auto& x : tone) total += x.amplitude * std::cos(2 * pi * x.order * t + x.phase);
        if (drift != 0 && t > 0) zero += dt * (drift - zero) / drift_s;
        total += zero;
        if (delay_steps > 0) {
            line.push_back(total);
            total = line.front();
            if (line.size() > delay_steps) line.pop_front();
        }
        if (lag_s > 0) {
            lag += (total - lag) * -std::expm1(-dt / lag_s);
            total = lag;
        }
        if (low_w > 0) {
            low2 += dt * low_w * (total - low1 - std::sqrt(2.0) * low2);
            low1 += dt * low_w * low2;
            total = low1;
        }
        return total;
    }
};

}  // namespace

int main() {
    Input in;
    std::string row;
    std::size_t count = 0;
    while (std::getline(std::cin, row)) {
        std::istringstream cells(row);
        std::string key;
        cells >> key;
        if (key == "reference") {
            cells >> count;
            break;
        }
        double a = 0, b = 0, c = 0;
        cells >> a;
        if (cells >> b >> c)
            in.waves[key].push_back({a, b, c});
        else
            in.numbers[key] = a;
    }
    std::vector<double> reference(4 * count);
    std::cin.read(reinterpret_cast<char*>(reference.data()),
                  static_cast<std::streamsize>(reference.size() * sizeof(double)));
    if (count == 0 || !std::cin) {
        std::cerr << "joint: no reference motion\n";
        return 1;
    }

    Joint joint(in);
    const auto substeps = static_cast<std::size_t>(steps_per_second / controller_rate);
    const auto log_every = static_cast<std::size_t>(steps_per_second / in.get("log_rate", 1000));
    const double settle_s = in.get("settle_s", 1.5), grain = in.get("encoder_step");
    const double kp = in.get("kp"), kv = in.get("kv"), ki = in.get("ki"),
                 filter = in.get("velocity_filter", 1);
    const double rigid = in.get("known_inertia"), known_weight = in.get("known_weight");
    const double angle = in.get("weight_angle");
    const auto seen = [&](double x) { return grain > 0 ? grain * std::floor(x / grain + 0.5) : x; };

    joint.q = reference[0];
    joint.th = joint.q + joint.gravity(-1) / joint.k;
    joint.drive = joint.spring = joint.gravity(-1);
    double before = seen(joint.th), speed = 0, slow = 0;
    std::vector<double> rows;
    rows.reserve(6 * (count * substeps / log_every + 1));
    const auto settle = static_cast<std::size_t>(settle_s * controller_rate);
    for (std::size_t tick = 0; tick < settle + count; ++tick) {
        const double* now = &reference[4 * (tick < settle ? 0 : tick - settle)];
        const bool begun = tick >= settle;
        const double wanted_v = begun ? now[1] : 0, wanted_a = begun ? now[2] : 0;
        const double position = seen(joint.th);
        speed += filter * ((position - before) * controller_rate - speed);
        before = position;
        const double error = now[0] - position;
        slow += ki * error / controller_rate;
        joint.drive = kp * error + kv * (wanted_v - speed) + slow + (joint.jm + rigid) * wanted_a +
                      known_weight * std::cos(now[0] + angle);
        for (std::size_t sub = 0; sub < substeps; ++sub) {
            const std::size_t index = (begun ? tick - settle : 0) * substeps + sub;
            const double t = begun ? static_cast<double>(index) * dt : -1.0;
            const double torque = joint.sensed(t);
            if (begun && index % log_every == 0)
                rows.insert(rows.end(), {joint.th, joint.w, joint.q, joint.v, torque, joint.spring});
            joint.step(t, begun ? now[3] : 0);
        }
    }
    std::fwrite(rows.data(), sizeof(double), rows.size(), stdout);
    return 0;
}
