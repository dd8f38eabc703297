// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

const Parameter* linear_of(const Effect& effect) {
    for (const Parameter& parameter : effect.parameters) {
        if (parameter.linear) return &parameter;
    }
    return nullptr;
}

bool is_step(const Parameter& scale) { return scale.name == "width_deg_s"; }

// A tone needs hints, ringing is none of friction's kinds, and load is the model's or a given term's own.
bool is_tried(const Effect& effect) {
    const bool ringing = effect.domain == Domain::time && effect.polar;
    return effect.side == Side::joint && !effect.bears_load && effect.domain != Domain::frequency &&
           !ringing && linear_of(effect) != nullptr;
}

bool is_resolved(const Shape& shape, const ScaleBounds& bounds, double rate_hz) {
    const Effect& effect = *shape.term.effect;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        if (effect.parameters[p].left_out != LeftOut::refused) continue;
        const double cycles = *shape.term.values[p] * (effect.ripple_order ? bounds.ratio : 1.0);
        if (cycles * bounds.fastest_deg_s / 360.0 >= bounds.rules.resolved * rate_hz) return false;
    }
    return true;
}

// Where a search for what rings begins: among the frequencies that the line passes.
std::vector<Shape> ringing_shapes(const Shape& plain, const Effect& effect, const ScaleBounds& bounds) {
    constexpr double parts[] = {0.12, 0.25, 0.5, 1.0}, usual_damping = 0.3;
    std::vector<Shape> shapes;
    for (const double part : parts) {
        Term term{&effect, {}};
        for (const Parameter& parameter : effect.parameters) {
            const bool is_scale = parameter.left_out == LeftOut::fitted;
            const double scale =
                parameter.unit == "Hz" ? part * bounds.fastest_hz(order_of(plain)) : usual_damping;
            term.values.emplace_back(
                is_scale ? scale : (parameter.name == "order" ? order_of(plain) : parameter.start));
        }
        Shape shape{plain.term, std::move(term)};
        const std::vector<Scale> scales = scales_of(shape);
        if (std::all_of(scales.begin(), scales.end(), [&](const Scale& scale) {
                return value_of(shape, scale) >= bounds.low(shape, scale);
            }))
            shapes.push_back(std::move(shape));
    }
    return shapes;
}

std::vector<double> places_of(const Parameter& parameter, bool scale, const ScaleBounds& bounds) {
    std::vector<double> places(parameter.tried.begin(), parameter.tried.end());
    if (places.empty()) places.push_back(parameter.start);
    if (!scale) return places;
    const double low = bounds.low(parameter), high = bounds.high(parameter);
    // The slowest drift is a straight line, whatever its time constant.
    std::erase_if(places, [&](double place) {
        return place < low || (place > high && !(parameter.unit == "s" && place > 1e3 * high));
    });
    if (places.empty()) places.push_back(std::sqrt(low * high));
    return places;
}

bool is_alike(const Term& a, const Term& b) {
    constexpr double by_rounding = 1e-12;  // a few moves up and down; the least move is 1e-2
    return a.effect == b.effect &&
           std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                      [](const std::optional<double>& x, const std::optional<double>& y) {
                          return x.has_value() == y.has_value() &&
                                 (!x || std::abs(*x - *y) <= by_rounding * std::abs(*x));
                      });
}

// Up to this frequency a mass on a spring passes half of the power that drives it, or more.
double passed_hz(const Term& ringing) {
    double hz = 0.0, damping = 0.0;
    for (std::size_t p = 0; p < ringing.values.size(); ++p) {
        const Parameter& parameter = ringing.effect->parameters[p];
        if (parameter.left_out != LeftOut::fitted) continue;
        (parameter.unit == "Hz" ? hz : damping) = *ringing.values[p];
    }
    const double bend = 1.0 - 2.0 * damping * damping;
    return hz * std::sqrt(bend + std::sqrt(bend * bend + 1.0));
}

}  // namespace

double order_of(const Shape& shape) { return *shape.term.values[*shape.term.effect->ripple_order]; }

Kind kind_of(const Effect& effect) {
    if (effect.domain == Domain::order) return Kind::order;
    if (effect.domain == Domain::time) return Kind::time;
    if (effect.polar) return Kind::position;
    return scales_of(effect).empty() ? Kind::speed : Kind::friction;
}

bool is_against_motion(const Effect& effect) {
    const Parameter* size = linear_of(effect);
    return !effect.polar && size != nullptr && size->lower >= 0.0;
}

bool alike(const Shape& a, const Shape& b) {
    return is_alike(a.term, b.term) && a.ringing.has_value() == b.ringing.has_value() &&
           (!a.ringing || is_alike(*a.ringing, *b.ringing));
}

bool same_name(const Shape& a, const Shape& b) {
    if (a.term.effect != b.term.effect) return false;
    for (std::size_t p = 0; p < a.term.values.size(); ++p) {
        if (a.term.effect->parameters[p].left_out == LeftOut::refused && a.term.values[p] != b.term.values[p])
            return false;
    }
    return true;
}

std::string shape_name(const Shape& shape) {
    std::string name(shape.term.effect->name);
    for (std::size_t p = 0; p < shape.term.values.size(); ++p) {
        if (shape.term.effect->parameters[p].left_out == LeftOut::refused)
            name += fmt::format(" {:g}", *shape.term.values[p]);
    }
    return name;
}

std::vector<std::size_t> scales_of(const Effect& effect) {
    std::vector<std::size_t> scales;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        const bool phase = effect.polar && effect.polar->phase == p;
        if (!parameter.linear && !phase && !parameter.unit.empty()) scales.push_back(p);
    }
    return scales;
}

std::size_t columns_of(const Shape& shape) {
    return (shape.term.effect->polar ? 2 : 1) * (shape.ringing ? 2 : 1);
}

std::vector<Scale> scales_of(const Shape& shape) {
    std::vector<Scale> scales;
    for (const std::size_t p : scales_of(*shape.term.effect)) scales.push_back({false, p});
    if (!shape.ringing) return scales;
    const auto& parameters = shape.ringing->effect->parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        if (parameters[p].left_out == LeftOut::fitted) scales.push_back({true, p});
    }
    return scales;
}

const Parameter& parameter_of(const Shape& shape, const Scale& scale) {
    return (scale.of_ringing ? *shape.ringing : shape.term).effect->parameters[scale.parameter];
}

double value_of(const Shape& shape, const Scale& scale) {
    return *(scale.of_ringing ? *shape.ringing : shape.term).values[scale.parameter];
}

Shape moved(Shape shape, const Scale& scale, double value) {
    (scale.of_ringing ? *shape.ringing : shape.term).values[scale.parameter] = value;
    return shape;
}

double ScaleBounds::low(const Shape& shape, const Scale& scale) const {
    const Parameter& parameter = parameter_of(shape, scale);
    if (!scale.of_ringing) return low(parameter);
    if (parameter.unit != "Hz") return rules.least_damping;
    return std::max(rules.slowest_ringing * fastest_hz(order_of(shape)), rules.least_ringing_hz);
}

double ScaleBounds::high(const Shape& shape, const Scale& scale) const {
    const Parameter& parameter = parameter_of(shape, scale);
    if (!scale.of_ringing) return high(parameter);
    if (parameter.unit != "Hz") return rules.most_damping;
    return rules.fastest_ringing * fastest_hz(order_of(shape));
}

double ScaleBounds::low(const Parameter& scale) const {
    if (is_step(scale)) return rules.narrowest_step_deg_s;
    if (scale.unit == "deg/s") return rules.slowest_stribeck_deg_s;
    if (scale.unit == "deg") return rules.narrowest_loop_deg;
    return rules.shortest_drift_s;
}

double ScaleBounds::high(const Parameter& scale) const {
    if (is_step(scale)) return rules.widest_step_deg_s;
    if (scale.unit == "deg/s") return std::max(rules.fastest_stribeck * fastest_deg_s, 2.0 * low(scale));
    if (scale.unit == "deg") return rules.widest_loop_deg;
    return 4.0 * duration_s;
}

bool ScaleBounds::is_bent(const Shape& shape) const {
    for (const std::size_t p : scales_of(*shape.term.effect)) {
        const Parameter& scale = shape.term.effect->parameters[p];
        // Drift may be a straight line; a friction that outlasts the log is one that does not change.
        const bool line = scale.unit == "s" && shape.term.effect->domain == Domain::time;
        if (is_step(scale) || line) continue;
        const double value = *shape.term.values[p];
        if (value < rules.near_low * low(scale) || value > high(scale) / rules.near_high) return true;
    }
    return false;
}

bool ScaleBounds::is_ringing_bent(const Shape& shape) const {
    const std::vector<Scale> scales = scales_of(shape);
    if (passed_hz(*shape.ringing) < rules.near_low * rules.least_ringing_hz) return true;
    return std::any_of(scales.begin(), scales.end(), [&](const Scale& scale) {
        if (!scale.of_ringing) return false;
        const double value = value_of(shape, scale);
        return value < rules.near_low * low(shape, scale) || value > high(shape, scale) / rules.near_high;
    });
}

ScaleBounds scale_bounds(const Case& looked_at, double ratio, const BesideRules& rules) {
    ScaleBounds bounds{0.0, looked_at.motion.time_s.back() - looked_at.motion.time_s.front(), ratio, rules};
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
        if (looked_at.use[k] != 0)
            bounds.fastest_deg_s =
                std::max(bounds.fastest_deg_s, std::abs(looked_at.motion.velocity_deg_s[k]));
    }
    return bounds;
}

std::vector<Shape> shapes_of(std::span<const Effect* const> effects, const ScaleBounds& bounds,
                             double rate_hz) {
    std::vector<Shape> found;
    const auto rings = std::find_if(effects.begin(), effects.end(), [](const Effect* effect) {
        return effect->side == Side::ripple && effect->domain == Domain::frequency;
    });
    for (const Effect* effect : effects) {
        if (!is_tried(*effect)) continue;
        const std::vector<std::size_t> scales = scales_of(*effect);
        std::vector<Shape> shapes{{{effect, {}}}};
        for (std::size_t p = 0; p < effect->parameters.size(); ++p) {
            const Parameter& parameter = effect->parameters[p];
            const bool scale = std::find(scales.begin(), scales.end(), p) != scales.end();
            std::vector<double> places{parameter.linear ? 1.0 : 0.0};
            if (!parameter.linear && !(effect->polar && effect->polar->phase == p))
                places = places_of(parameter, scale, bounds);
            std::vector<Shape> more;
            for (const Shape& shape : shapes) {
                for (const double place : places) {
                    more.push_back(shape);
                    more.back().term.values.emplace_back(place);
                }
            }
            shapes = std::move(more);
        }
        std::erase_if(shapes, [&](const Shape& shape) { return !is_resolved(shape, bounds, rate_hz); });
        found.insert(found.end(), shapes.begin(), shapes.end());
        if (!effect->ripple_order || rings == effects.end()) continue;
        for (const Shape& shape : shapes) {
            for (Shape& ringing : ringing_shapes(shape, **rings, bounds)) found.push_back(std::move(ringing));
        }
    }
    return found;
}

}  // namespace ripplenotch
