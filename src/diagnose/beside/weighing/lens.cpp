// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/lens.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/vectors/dot.hpp"
#include "diagnose/beside/weighing/color.hpp"
#include "diagnose/beside/weighing/ringing_torque.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// What the speed and the direction make of a column.
std::vector<double> swelled(const std::vector<double>& column, const Motion& motion, double fastest_deg_s,
                            bool by_direction, bool by_speed) {
    std::vector<double> swelling = column;
    for (std::size_t k = 0; k < column.size(); ++k) {
        const double v = motion.velocity_deg_s[k];
        if (by_direction) swelling[k] *= v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
        if (by_speed) swelling[k] *= std::abs(v) / fastest_deg_s;
    }
    return swelling;
}

}  // namespace

Lens::Lens(const Case& looked_at, const Candidate& model, std::span<const GivenTerm> given,
           std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work)
    : Lens(looked_at, rules, work, model) {
    if (!given.empty() && case_.motion.known_nm.empty()) carry(given, model);
    begin(model, columns_of(model, given), effects);
    const std::vector<double> left = left_by_all();
    left_nm_ = rms(left);
    color_ = long_color(left, ground_.memory(), rules_.beside.color_floor);
    ground_.color(color_);
    sigma_ = std::max(rms(ground_.whitened(left)), 1e-12);
    whiten();
}

Lens::Lens(const Lens& like, const Candidate& model, std::span<const GivenTerm> given,
           std::span<const Effect* const> effects)
    : Lens(like.case_, like.rules_, like.work_, model) {
    begin(model, columns_of(model, given), effects);
    take_color(like);
    whiten();
}

Lens::Lens(const Lens& like, const Candidate& model, std::span<const GivenTerm> given,
           std::span<const Effect* const> effects, const DiagnosisRules& rules)
    : Lens(like.case_, model, given, effects, rules, like.work_) {}

Lens::Lens(OffsetIsOpen, const Lens& like, const Candidate& model, std::span<const Effect* const> effects)
    : Lens(like.case_, like.rules_, like.work_, model) {
    begin(model, like.columns_, effects);
    // Of what is stated it is the last (always_on.cpp).
    deviation_[columns_->always.stated - 1] = stated_deviation;
    take_color(like);
    whiten();
}

Lens::Lens(const Case& looked_at, const DiagnosisRules& rules, Work& work, const Candidate& model)
    : case_(looked_at),
      rules_(rules),
      work_(work),
      ground_(looked_at, rules.beside),
      thin_{Hertz(ground_.rate_hz()), ground_.thinned(looked_at.motion.time_s),
            ground_.thinned(looked_at.motion.position_deg), ground_.thinned(looked_at.motion.velocity_deg_s),
            ground_.thinned(looked_at.motion.acceleration_deg_s2)},
      bounds_(scale_bounds(looked_at, model.stated.gear_ratio.value(), rules.beside)) {}

std::shared_ptr<Lens::HeldColumns> Lens::columns_of(const Candidate& model,
                                                    std::span<const GivenTerm> given) const {
    auto columns = std::make_shared<HeldColumns>();
    columns->always = always_on(case_, model, given, rules_);
    columns->bridged = bridged(columns->always.torque_nm);
    return columns;
}

void Lens::begin(const Candidate& model, std::shared_ptr<HeldColumns> columns,
                 std::span<const Effect* const> effects) {
    prediction_.emplace(model.stated, case_.motion);
    columns_ = std::move(columns);
    const AlwaysOn& always = columns_->always;
    deviation_ = always.deviation;
    open_nm_ = case_.torque_nm;
    add_scaled(-1.0, prediction_->torque_nm().data(), open_nm_.data(), open_nm_.size());
    for (std::size_t i = 0; i < always.mean.size(); ++i)
        add_scaled(-always.mean[i], always.torque_nm[i].data(), open_nm_.data(), open_nm_.size());
    bridged_open_ = ground_.bridged(open_nm_);
    shapes_ = shapes_of(effects, bounds_, ground_.rate_hz());
    // What the model has is always on.
    std::erase_if(shapes_, [&](const Shape& shape) {
        return std::any_of(model.stated.terms.begin(), model.stated.terms.end(),
                           [&](const Term& term) { return same_name({term}, shape); });
    });
}

void Lens::take_color(const Lens& like) {
    left_nm_ = like.left_nm_;
    color_ = like.color_;
    ground_.color(color_);
    sigma_ = like.sigma_;
}

void Lens::whiten() {
    plain_.emplace(columns_->bridged, deviation_, left_nm_);
    if (columns_->white.empty()) {
        for (const auto& column : columns_->bridged) columns_->white.push_back(ground_.whitened(column));
    }
    white_.emplace(columns_->white, deviation_, sigma_);
    target_ = white_->left(ground_.whitened(bridged_open_));
    bridged_open_.shrink_to_fit();
}

// The load that the given terms bring: from a fit beside Coulomb's and viscous friction, to which they would
// bend otherwise.
void Lens::carry(std::span<const GivenTerm> given, const Candidate& model) {
    const AlwaysOn columns = always_on(case_, model, given, rules_);
    std::vector<double> open_nm = case_.torque_nm;
    const std::vector<double> own_nm = predict_nm(model.stated, case_.motion);
    add_scaled(-1.0, own_nm.data(), open_nm.data(), open_nm.size());
    for (std::size_t i = 0; i < columns.mean.size(); ++i)
        add_scaled(-columns.mean[i], columns.torque_nm[i].data(), open_nm.data(), open_nm.size());
    Columns beside = bridged(columns.torque_nm);
    std::vector<double> step, deviation = columns.deviation;
    for (const double v : case_.motion.velocity_deg_s)
        step.push_back(portable::tanh(v / rules_.beside.load_step_deg_s));
    beside.push_back(ground_.bridged(step));
    beside.push_back(ground_.bridged(case_.motion.velocity_deg_s));
    deviation.insert(deviation.end(), 2, any_size);
    std::vector<double> values =
        Ridge(beside, deviation, rules_.beside.first_noise * rms(open_nm)).solve(ground_.bridged(open_nm));
    for (std::size_t i = 0; i < columns.mean.size(); ++i) values[i] += columns.mean[i];
    case_.motion.known_nm = carried_nm(columns, values);
}

std::vector<double> Lens::left_by_all() const {
    Columns all = columns_->bridged;
    std::vector<double> deviation = deviation_;
    for (const Shape& shape : shapes_) {
        // However a ripple goes with the speed: columns in proportion stand for what rings.
        if (shape.ringing) continue;
        Columns own = torque_nm(shape);
        const std::size_t plain = shape.term.effect->ripple_order ? own.size() : 0;
        for (const auto& [by_direction, by_speed] : {std::pair(true, false), {true, true}, {false, true}}) {
            for (std::size_t c = 0; c < plain; ++c)
                own.push_back(swelled(own[c], case_.motion, bounds_.fastest_deg_s, by_direction, by_speed));
        }
        for (auto& column : bridged(own)) all.push_back(std::move(column));
    }
    deviation.resize(all.size(), any_size);
    // The values need fewer rows than their residual.
    const std::size_t step = std::max<std::size_t>(1, ground_.samples() / rules_.screening.sketch_samples);
    Columns some;
    const auto thinned = [step](const std::vector<double>& column) {
        std::vector<double> thin;
        for (std::size_t k = 0; k < column.size(); k += step) thin.push_back(column[k]);
        return thin;
    };
    for (const auto& column : all) some.push_back(thinned(column));
    const std::vector<double> target = thinned(bridged_open_);
    const std::vector<double> values =
        Ridge(some, deviation, rules_.beside.first_noise * rms(target)).solve(target);
    std::vector<double> left = bridged_open_;
    for (std::size_t i = 0; i < all.size(); ++i)
        add_scaled(-values[i], all[i].data(), left.data(), left.size());
    return left;
}

Lens::Columns Lens::bridged(const Columns& columns) const {
    Columns thin;
    for (const auto& column : columns) thin.push_back(ground_.bridged(column));
    return thin;
}

std::vector<std::vector<double>> Lens::torque_nm(const Shape& shape) const {
    const std::size_t before = prediction_->applied();
    Columns columns{prediction_->added(shape.term)};
    if (const auto& polar = shape.term.effect->polar) {
        Term across = shape.term;
        across.values[polar->phase] = *across.values[polar->phase] + 90.0;
        columns.push_back(prediction_->added(across));
    }
    work_.add(prediction_->applied() - before, case_.size());
    if (shape.ringing) {
        for (auto& column : ringing_nm(shape, case_.motion, Columns(columns)))
            columns.push_back(std::move(column));
    }
    return columns;
}

// Of a pair, a cosine and what is a quarter of a cycle ahead of it: as the gain changes both.
Lens::Columns Lens::ringing_nm(const Shape& shape, const Motion& motion, const Columns& plain_nm) const {
    const auto gain = ringing_gain(shape, motion, prediction_->model().gear_ratio);
    Columns ringing = plain_nm;
    for (std::size_t k = 0; k < gain.size(); ++k) {
        const double cosine = plain_nm[0][k], ahead = plain_nm[1][k];
        ringing[0][k] = gain[k].real() * cosine + gain[k].imag() * ahead;
        ringing[1][k] = gain[k].real() * ahead - gain[k].imag() * cosine;
    }
    return ringing;
}

std::vector<double> Lens::target_earlier(std::ptrdiff_t samples) const {
    std::vector<double> earlier = open_nm_;
    for (std::size_t s = 0; s < case_.from.size(); ++s) {
        const auto first = static_cast<std::ptrdiff_t>(case_.from[s]);
        const auto end =
            static_cast<std::ptrdiff_t>(s + 1 < case_.from.size() ? case_.from[s + 1] : case_.size());
        for (std::ptrdiff_t k = first; k < end; ++k) {
            const auto at = static_cast<std::size_t>(std::clamp(k + samples, first, end - 1));
            earlier[static_cast<std::size_t>(k)] +=
                case_.torque_nm[at] - case_.torque_nm[static_cast<std::size_t>(k)];
        }
    }
    return weighed(earlier);
}

std::vector<double> Lens::weighed(std::span<const double> torque_nm) const {
    return white_->left(ground_.whitened(ground_.bridged(torque_nm)));
}

Lens::Weighed Lens::weighed(const Shape& shape) const { return weighed(bridged(torque_nm(shape))); }

std::vector<std::vector<double>> Lens::thinned_nm(const Shape& shape) const {
    Columns thin;
    for (const auto& column : torque_nm(shape)) thin.push_back(ground_.thinned(column));
    return thin;
}

Lens::Weighed Lens::weighed_ringing(const Shape& shape, const Columns& plain_nm) const {
    Columns ringing = ringing_nm(shape, thin_, plain_nm);
    for (auto& column : ringing) ground_.bridge(column);
    return weighed(ringing);
}

Lens::Weighed Lens::weighed(const Columns& bridged_nm) const {
    Columns white;
    for (const auto& column : bridged_nm) white.push_back(ground_.whitened(column));
    Weighed weighed{white_->left(white)};
    for (std::size_t c = 0; c < white.size(); ++c) {
        const double all = rms(white[c]);
        if (all > 0.0) weighed.part = std::max(weighed.part, rms(weighed.columns[c]) / all);
    }
    return weighed;
}

std::vector<double> Lens::plain_values(std::span<const double> explained_nm) const {
    std::vector<double> left = open_nm_;
    add_scaled(-1.0, explained_nm.data(), left.data(), left.size());
    std::vector<double> values = plain_->solve(ground_.bridged(left));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += columns_->always.mean[i];
    return values;
}

double Lens::plain_left_nm(std::span<const double> explained_nm) const {
    std::vector<double> left = open_nm_;
    add_scaled(-1.0, explained_nm.data(), left.data(), left.size());
    return rms(plain_->left(ground_.bridged(left)));
}

std::vector<double> Lens::plain_sizes(std::span<const Shape> shapes) const {
    // What the always-on columns leave of the shapes and of the torque.
    Columns outside;
    for (const Shape& shape : shapes) {
        for (const auto& column : bridged(torque_nm(shape))) outside.push_back(plain_->left(column));
    }
    const std::vector<double> free(outside.size(), any_size);
    return Ridge(outside, free, 0.0).solve(plain_->left(ground_.bridged(open_nm_)));
}

}  // namespace ripplenotch
