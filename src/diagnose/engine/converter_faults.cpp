// SPDX-License-Identifier: MIT
#include "diagnose/engine/converter_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ripplenotch::engine {
namespace {

constexpr std::size_t few_values = 1000;  // a quantized torque has fewer distinct values
// Share of neighbours that are equal or one step apart: with a step of less than 1.7 times the noise fewer
// are.
constexpr double coarse_share = 0.9;
// Samples at an end of the range: in one stretch; or in several, beside a rare next value.
constexpr std::size_t fewest_at_limit = 20, fewest_touches = 5, fewest_stretches = 3;
constexpr std::size_t longest_repeat = 10;  // equal samples in a row that chance makes
constexpr std::size_t fewest_dropouts = 3, fewest_spikes = 4;
constexpr std::size_t spike_neighbours = 25;  // samples to each side

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool is_coarse(std::span<const double> torque_nm, double step_nm) {
    std::size_t near = 0;
    for (std::size_t k = 1; k < torque_nm.size(); ++k)
        near += std::abs(torque_nm[k] - torque_nm[k - 1]) < 1.5 * step_nm ? 1 : 0;
    return static_cast<double>(near) > coarse_share * static_cast<double>(torque_nm.size());
}

// Whether a torque is cut at `end`, beside which the next value is `inner`.
bool is_limit(std::span<const double> torque_nm, double end, double inner) {
    std::size_t count = 0, stretches = 0;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        if (torque_nm[k] != end) continue;
        ++count;
        stretches += k == 0 || torque_nm[k - 1] != end ? 1 : 0;
    }
    const auto beside = static_cast<std::size_t>(std::count(torque_nm.begin(), torque_nm.end(), inner));
    return count > fewest_at_limit ||
           (count >= fewest_touches && stretches >= fewest_stretches && count > 3 * beside);
}

}  // namespace

std::vector<ConverterFault> find_converter_faults(std::span<const double> torque_nm,
                                                  std::vector<unsigned char>& good) {
    std::vector<ConverterFault> found;
    std::vector<double> levels(torque_nm.begin(), torque_nm.end());
    std::sort(levels.begin(), levels.end());
    const auto at = [&](double level) {
        return static_cast<std::size_t>(std::count(torque_nm.begin(), torque_nm.end(), level));
    };
    const double lowest = levels.front(), highest = levels.back();
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    std::vector<double> steps;
    for (std::size_t k = 1; k < levels.size(); ++k) steps.push_back(levels[k] - levels[k - 1]);
    if (!steps.empty() && levels.size() < few_values && is_coarse(torque_nm, median(steps)))
        return {{.effect = "quantization", .rows = {}, .size = median(steps)}};
    double limit_nm = std::numeric_limits<double>::infinity();
    const bool touches = levels.size() > 2 &&
                         (at(highest) >= at(lowest) ? is_limit(torque_nm, highest, levels[levels.size() - 2])
                                                    : is_limit(torque_nm, lowest, levels[1]));
    if (touches) {
        limit_nm = std::max(std::abs(lowest), std::abs(highest));
        auto& fault = found.emplace_back();
        fault.effect = "saturation";
        fault.size = limit_nm;
        for (std::size_t row = 0; row < torque_nm.size(); ++row) {
            if (std::abs(torque_nm[row]) < limit_nm * (1.0 - 1e-9)) continue;
            good[row] = 0;
            fault.rows.push_back(row);
        }
    }
    ConverterFault dropout{.effect = "dropout", .rows = {}};
    std::size_t runs = 0;
    for (std::size_t first = 0, end = 0; first < torque_nm.size(); first = end) {
        while (end < torque_nm.size() && torque_nm[end] == torque_nm[first]) ++end;
        if (end - first <= longest_repeat || std::abs(torque_nm[first]) >= limit_nm * 0.999) continue;
        ++runs;
        for (std::size_t row = first + 1; row < end; ++row) dropout.rows.push_back(row);
    }
    if (runs >= fewest_dropouts) {
        for (const std::size_t row : dropout.rows) good[row] = 0;
        found.push_back(std::move(dropout));
    }
    return found;
}

FarSamples find_spikes(const RecordedMotion& recorded, const SaturatedFit& fit) {
    const std::vector<unsigned char>& use = recorded.usable();
    std::vector<double> r = fit.residual_nm, sizes;
    for (std::size_t k = 0; k < r.size(); ++k) {
        if (use[k] == 0)
            r[k] = 0.0;
        else
            sizes.push_back(std::abs(r[k]));
    }
    if (sizes.empty()) return {};
    const double deviation_nm = 1.4826 * median(sizes);
    FarSamples found;
    const std::vector<double>& velocity = recorded.motion().velocity_deg_s;
    // Between which samples friction changes its sign the log does not say.
    const auto is_reversal = [&](std::size_t k) { return velocity[k - 2] * velocity[k + 2] <= 0.0; };
    std::size_t alone = 0, in_motion = 0;
    for (std::size_t k = 2; k + 2 < r.size(); ++k) {
        if (std::abs(r[k]) <= 8.0 * deviation_nm) continue;
        found.slots.push_back(k);
        double squares = 0.0, count = 0.0;
        const std::size_t from = k - std::min(k, spike_neighbours);
        const std::size_t to = std::min(k + spike_neighbours, r.size());
        for (std::size_t i = from; i < to; ++i) {
            if (i + 1 >= k && i <= k + 1) continue;
            squares += r[i] * r[i];
            count += 1.0;
        }
        const bool stands_out = std::abs(r[k]) > 3.0 * std::max(std::abs(r[k - 1]), std::abs(r[k + 1])) &&
                                std::abs(r[k]) > 6.0 * std::sqrt(squares / count) &&
                                std::abs(r[k] - 0.5 * (r[k - 1] + r[k + 1])) > 7.0 * deviation_nm;
        alone += stands_out ? 1 : 0;
        in_motion += stands_out && !is_reversal(k) ? 1 : 0;
    }
    if (alone < fewest_spikes) found.slots.clear();
    found.are_spikes = in_motion >= fewest_spikes;
    return found;
}

}  // namespace ripplenotch::engine
