// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {
namespace {

// "16.0 dB off order 1 and 24.3 dB off order 2"
std::string taken_off(const JudgedMethod& method, const std::vector<RippleEstimate>& orders) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < orders.size(); ++i) {
        if (!orders[i].present() || i >= method.figures.attenuation.size()) continue;
        const OrderAttenuation& entry = method.figures.attenuation[i];
        if (entry.db) parts.push_back(fmt::format("{:.1f} dB off order {:g}", *entry.db, entry.order));
    }
    if (parts.size() < 2) return parts.empty() ? "nothing measured" : parts.front();
    const std::string last = parts.back();
    parts.pop_back();
    return fmt::format("{} and {}", fmt::join(parts, ", "), last);
}

std::string late(const JudgedMethod& method) {
    const double ms = 1e3 * method.delay.value();
    return ms < 0.05 ? "without delay" : fmt::format("{:.1f} ms late at most", ms);
}

std::string short_text(const MethodFigures& figures) {
    constexpr std::size_t longest_text = 60;  // by hand: of a line of the page
    if (figures.method.size() <= longest_text) return figures.method;
    return figures.method.substr(0, figures.method.find(',')) + ",...";
}

bool is_control(const MethodFigures& figures) { return part_of(figures) == MethodPart::control; }

std::string one_sentence(const Recommendation& found, const JudgedMethod& method) {
    return fmt::format("{}, {}, {:.3g} Nm rms of ripple left", taken_off(method, found.orders), late(method),
                       method.figures.ripple_rms_nm.value_or(0.0));
}

std::string next_to(const Recommendation& found, const JudgedMethod& taken, const JudgedMethod& other) {
    if (!other.meets() && taken.meets())
        return fmt::format(" Nothing else is within the limits; nearest, {}: {}.", short_text(other.figures),
                           fmt::join(other.shortfalls, "; "));
    const std::string figures = one_sentence(found, other);
    return fmt::format(" Next, {}: {}; its output is off by {:.3g} Nm where that of the first is by {:.3g}.",
                       short_text(other.figures), figures, other.error_nm, taken.error_nm);
}

}  // namespace

std::string recommendation_verdict(const Recommendation& found) {
    const JudgedMethod* const taken = found.taken();
    if (found.finding == RecommendationFinding::cannot_tell)
        return fmt::format("Cannot tell: {}.", found.why);
    if (found.finding == RecommendationFinding::no_ripple)
        return fmt::format("No filter recommended: {}.", found.why);
    if (taken == nullptr) return "No method was tried.";
    const JudgedMethod* const other = found.runner_up();
    if (found.finding == RecommendationFinding::out_of_reach) {
        return fmt::format("Nothing is within the limits. The nearest is {}: {} ({}).",
                           short_text(taken->figures), fmt::join(taken->shortfalls, "; "),
                           one_sentence(found, *taken));
    }
    std::string text =
        is_control(taken->figures)
            ? fmt::format(
                  "Leave the torque as it is: what a filter takes out here, its delay "
                  "costs ({:.3g} Nm rms of ripple).",
                  taken->figures.ripple_rms_nm.value_or(0.0))
            : fmt::format("Take {}: {}.", short_text(taken->figures), one_sentence(found, *taken));
    if (other != nullptr) text += next_to(found, *taken, *other);
    return text;
}

}  // namespace ripplenotch
