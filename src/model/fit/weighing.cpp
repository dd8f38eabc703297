// SPDX-License-Identifier: MIT
#include "model/fit/weighing.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double unbounded = 1e300;  // beyond any value

FittedValue told(std::size_t term, std::size_t parameter, double value, double variance, double per_unit) {
    FittedValue fitted;
    fitted.term = term;
    fitted.parameter = parameter;
    fitted.value = value;
    if (!(variance >= 0.0) || !std::isfinite(variance)) return fitted;
    const double error = std::sqrt(variance) * per_unit;
    fitted.standard_error = error;
    fitted.ci95 = Interval{value - normal_95_errors * error, value + normal_95_errors * error};
    return fitted;
}

}  // namespace

Coordinates::Coordinates(const Model& model, const Model* first_guess)
    : model_(model), first_guess_(first_guess) {
    for (const Term& term : model.terms) {
        if (!term.effect->chance && !term.effect->linear_in_torque) sum_is_linear_ = false;
    }
    for (std::size_t i = 0; i < model_.terms.size(); ++i) {
        if (model_.terms[i].effect->chance) {
            // They act on no prediction, but a prediction needs their values.
            for (std::size_t p = 0; p < model_.terms[i].values.size(); ++p) {
                auto& value = model_.terms[i].values[p];
                value = value.value_or(model_.terms[i].effect->parameters[p].start);
            }
            continue;
        }
        add_term(i);
    }
}

double Coordinates::guess(std::size_t term, std::size_t parameter) const {
    const Parameter& described = model_.terms[term].effect->parameters[parameter];
    if (first_guess_ == nullptr) return described.start;
    return first_guess_->terms.at(term).values.at(parameter).value_or(described.start);
}

void Coordinates::add_term(std::size_t i) {
    const Term& term = model_.terms[i];
    const Effect& effect = *term.effect;
    const auto missing = [&](std::size_t p) { return !term.values[p]; };
    // Load enters some effects as a product or a power, so that the torque is not linear in the terms that
    // bear it.
    const bool load_is_used = std::any_of(model_.terms.begin(), model_.terms.end(),
                                          [](const Term& other) { return other.effect->uses_load; });
    const bool linear_term = effect.side == Side::joint && sum_is_linear_ &&
                             !(effect.bears_load && load_is_used) && !effect.uses_load;
    const bool pair = effect.polar && missing(effect.polar->size) && missing(effect.polar->phase);
    if (pair) {
        const auto [size, phase] = *effect.polar;
        const double amount = guess(i, size), angle_deg = guess(i, phase);
        const double step = linear_term ? 1.0 : 1e-6 * std::max(amount, effect.parameters[size].start);
        list_.push_back({CoordinateKind::cosine_part, i, size, phase,
                         amount * portable::cos_degrees(angle_deg), -unbounded, unbounded, step,
                         linear_term});
        list_.push_back({CoordinateKind::sine_part, i, size, phase, amount * portable::sin_degrees(angle_deg),
                         -unbounded, unbounded, step, linear_term});
    }
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        if (!missing(p) || parameter.left_out == LeftOut::assumed) continue;
        if (parameter.left_out == LeftOut::refused) {
            raise<UsageError>("the model does not state effects[{}].{} of {}; a fit does not search for it",
                              i, parameter.name, effect.name);
        }
        if (pair && (p == effect.polar->size || p == effect.polar->phase)) continue;
        const double start = guess(i, p);
        if (parameter.logarithmic) {
            list_.push_back({CoordinateKind::logarithm, i, p, 0, portable::log(start),
                             portable::log(parameter.lower), portable::log(most_in(model_, effect, p)), 1e-5,
                             false});
            continue;
        }
        const bool linear = linear_term && parameter.linear;
        const double scale = std::max({std::abs(start), std::abs(parameter.start), 1e-3});
        list_.push_back({CoordinateKind::plain, i, p, 0, start, least_in(model_, effect, p),
                         most_in(model_, effect, p), linear ? scale : 1e-5 * scale, linear});
    }
}

Model Coordinates::at(const std::vector<double>& point) const {
    Model model = model_;
    for (std::size_t c = 0; c < list_.size(); ++c) {
        const Coordinate& coordinate = list_[c];
        auto& values = model.terms[coordinate.term].values;
        if (coordinate.kind == CoordinateKind::plain) {
            values[coordinate.parameter] = point[c];
        } else if (coordinate.kind == CoordinateKind::logarithm) {
            values[coordinate.parameter] = portable::exp(point[c]);
        } else if (coordinate.kind == CoordinateKind::cosine_part) {
            values[coordinate.parameter] = portable::hypot(point[c], point[c + 1]);
            values[coordinate.phase] = portable::atan2(point[c + 1], point[c]) * degrees_per_radian;
        }
    }
    return model;
}

std::vector<FittedValue> Coordinates::values(const std::vector<double>& point,
                                             const std::vector<double>& covariance) const {
    const std::size_t n = list_.size();
    const auto variance = [&](std::size_t a, std::size_t b) { return covariance[a * n + b]; };
    std::vector<FittedValue> found;
    for (std::size_t c = 0; c < n; ++c) {
        const Coordinate& place = list_[c];
        if (place.kind == CoordinateKind::plain) {
            found.push_back(told(place.term, place.parameter, point[c], variance(c, c), 1.0));
            found.back().at_bound = point[c] <= place.lower || point[c] >= place.upper;
        } else if (place.kind == CoordinateKind::logarithm) {
            const double value = portable::exp(point[c]);
            found.push_back(told(place.term, place.parameter, value, variance(c, c), value));
            if (auto& ci95 = found.back().ci95) {
                const double half = normal_95_errors * std::sqrt(variance(c, c));
                ci95 = Interval{value * portable::exp(-half), value * portable::exp(half)};
            }
            found.back().at_bound = point[c] <= place.lower || point[c] >= place.upper;
        } else if (place.kind == CoordinateKind::cosine_part) {
            const double x = point[c], y = point[c + 1], size = portable::hypot(x, y);
            const double cosine = size > 0.0 ? x / size : 1.0, sine = size > 0.0 ? y / size : 0.0;
            const double xx = variance(c, c), xy = variance(c, c + 1), yy = variance(c + 1, c + 1);
            const double along = xx * cosine * cosine + 2.0 * xy * cosine * sine + yy * sine * sine;
            const double across = xx * sine * sine - 2.0 * xy * cosine * sine + yy * cosine * cosine;
            const bool known = xx >= 0.0 && yy >= 0.0;
            found.push_back(told(place.term, place.parameter, size, known ? along : -1.0, 1.0));
            found.push_back(told(place.term, place.phase, portable::atan2(y, x) * degrees_per_radian,
                                 known && size > 0.0 ? across : -1.0,
                                 degrees_per_radian / std::max(size, 1e-300)));
        }
    }
    std::sort(found.begin(), found.end(), [](const FittedValue& a, const FittedValue& b) {
        return std::pair(a.term, a.parameter) < std::pair(b.term, b.parameter);
    });
    return found;
}

namespace {

// A nuisance of which less than this part lies outside the others brings rounding noise alone.
constexpr double not_new = 1e-9;

double length_of(const std::vector<double>& column) {
    return std::sqrt(dot(column.data(), column.data(), column.size()));
}

}  // namespace

Weighing::Weighing(std::size_t samples, std::span<const unsigned char> use, std::span<const double> color,
                   std::span<const unsigned char> valid)
    : color_(color.begin(), color.end()) {
    if (valid.empty()) valid = use;
    for (std::size_t k = 0; k < samples; ++k) {
        if (!valid.empty() && valid[k] == 0) {
            if (gaps_.empty() || gaps_.back().first + gaps_.back().count != k) gaps_.push_back({k, 0});
            ++gaps_.back().count;
        }
        if (k < color_.size() || (!use.empty() && use[k] == 0)) continue;
        if (rows_.empty() || rows_.back() + 1 != k) runs_.push_back({k, 0});
        ++runs_.back().count;
        rows_.push_back(k);
    }
}

std::vector<double> Weighing::bridged(std::span<const double> torque_nm) const {
    std::vector<double> whole(torque_nm.begin(), torque_nm.end());
    for (const Run& gap : gaps_) {
        const std::size_t end = gap.first + gap.count;
        const bool before = gap.first > 0, after = end < whole.size();
        const double left = before ? whole[gap.first - 1] : (after ? whole[end] : 0.0);
        const double right = after ? whole[end] : left;
        for (std::size_t k = gap.first; k < end; ++k) {
            const double part = static_cast<double>(k - gap.first + 1) / static_cast<double>(gap.count + 1);
            whole[k] = left + part * (right - left);
        }
    }
    return whole;
}

void Weighing::whiten(std::span<const double> torque_nm, double* white) const {
    std::vector<double> whole;
    if (!gaps_.empty() && !color_.empty()) torque_nm = whole = bridged(torque_nm);
    for (const Run& run : runs_) {
        prediction_errors(torque_nm.data() + run.first, run.count, color_.data(), color_.size(), white);
        white += run.count;
    }
    std::fill_n(white, bounded_, 0.0);
}

std::vector<double> Weighing::whitened(std::span<const double> torque_nm) const {
    std::vector<double> white(size());
    whiten(torque_nm, white.data());
    return white;
}

void Weighing::weigh(std::span<const double> torque_nm, double* weighed) const {
    whiten(torque_nm, weighed);
    for (std::size_t first = 0; first < basis_.size(); first += size()) {
        const double* const nuisance = basis_.data() + first;
        add_scaled(-dot(nuisance, weighed, size()), nuisance, weighed, size());
    }
}

std::vector<double> Weighing::operator()(std::span<const double> torque_nm) const {
    std::vector<double> weighed(size());
    weigh(torque_nm, weighed.data());
    return weighed;
}

void Weighing::set_nuisance(const std::vector<Nuisance>& nuisance, double noise_nm) {
    basis_.clear();
    bounded_ = static_cast<std::size_t>(std::count_if(
        nuisance.begin(), nuisance.end(), [](const Nuisance& entry) { return entry.usual_size > 0.0; }));
    const std::size_t n = size();
    std::size_t bound = rows_.size();
    for (const Nuisance& entry : nuisance) {
        std::vector<double> column = whitened(entry.torque_nm);
        if (entry.usual_size > 0.0) column[bound++] = noise_nm / entry.usual_size;
        const double length = length_of(column);
        for (int pass = 0; pass < 2; ++pass) {  // twice is enough (Kahan, Parlett)
            for (std::size_t first = 0; first < basis_.size(); first += n) {
                const double* const other = basis_.data() + first;
                add_scaled(-dot(other, column.data(), n), other, column.data(), n);
            }
        }
        const double left = length_of(column);
        if (!(left > not_new * length)) continue;
        for (double& value : column) value /= left;
        basis_.insert(basis_.end(), column.begin(), column.end());
    }
}

}  // namespace ripplenotch
