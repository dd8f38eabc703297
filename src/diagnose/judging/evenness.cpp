// SPDX-License-Identifier: MIT
#include "diagnose/judging/evenness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);
using EvennessRules = DiagnosisRules::EvennessRules;

struct PlaceSums {
    double samples = 0.0, left = 0.0, torque = 0.0, both = 0.0, square = 0.0;
};

// The finding's torque and what is left over, a number per row that counts, in units of the white noise.
struct Torques {
    static constexpr double variance_nm2 = 1.0;
    std::vector<double> finding_nm, left_nm;
    double telling_nm2 =
        0.0;               ///< sum of squares from which a torque tells its size: rules.telling_deviations
    bool changes = false;  ///< in the log, be it in rows that do not count
    bool by_its_torque = false;  ///< a place has the say of the finding's torque there
};

// Both whitened, so that noise of whatever colour counts alike in every sum.
Torques torques_of(const ModelBench& bench, const Model& stated, std::size_t term) {
    const auto added = bench.torque_of(stated, term);
    Torques torques;
    torques.left_nm = bench.residual(stated);
    torques.finding_nm = bench.whitened(added);
    torques.by_its_torque = stated.terms[term].effect->side != side_of(stated.terms[term]);
    const auto [low, high] = std::minmax_element(added.begin(), added.end());
    torques.changes = *high - *low > 1e-6 * std::max(std::abs(*low), std::abs(*high));
    const double deviations = bench.rules().evenness.telling_deviations;
    torques.telling_nm2 = deviations * deviations;
    return torques;
}

// `place`: of each row; none for those that do not count.
std::vector<PlaceSums> sums_of(const Torques& torques, const std::vector<std::size_t>& place,
                               std::size_t count) {
    std::vector<PlaceSums> sums(count);
    for (std::size_t r = 0; r < place.size(); ++r) {
        if (place[r] == none) continue;
        PlaceSums& sum = sums[place[r]];
        sum.samples += 1.0;
        sum.left += torques.left_nm[r];
        sum.torque += torques.finding_nm[r];
        sum.both += torques.left_nm[r] * torques.finding_nm[r];
        sum.square += torques.finding_nm[r] * torques.finding_nm[r];
    }
    return sums;
}

// Each place that tells a size has the same say; of a spring that all torque passes, the say of its torque:
// that goes with the motion's frequency, and where it is hardly driven, what else rings in it counts as much.
double between(const Torques& torques, double least_sigma, const std::vector<std::size_t>& place,
               std::size_t count) {
    double off = 0.0, places = 0.0, told = 0.0;
    for (const PlaceSums& sum : sums_of(torques, place, count)) {
        const double variance = torques.variance_nm2;
        if (sum.square < torques.telling_nm2 ||
            sum.square < least_sigma * least_sigma * variance * sum.samples)
            continue;
        const double part = sum.both / sum.square;
        const double say = torques.by_its_torque ? sum.square : 1.0;
        off += say * std::max(part * part - variance / sum.square, 0.0);
        told += say;
        places += 1.0;
    }
    return places > 1.0 ? std::sqrt(off / told) : 0.0;
}

// A torque that changes only where rows do not count is a constant in those that do, which may be anything.
bool only_constant(const Torques& torques) {
    if (!torques.changes) return false;
    const PlaceSums sum = sums_of(torques, std::vector<std::size_t>(torques.finding_nm.size(), 0), 1)[0];
    return sum.square - sum.torque * sum.torque / sum.samples < torques.telling_nm2;
}

// Of the change within places alone; each has the say of how much the torque changes in it.
double share_within(const Torques& torques, double telling_deviations, const std::vector<std::size_t>& place,
                    std::size_t count) {
    double off = 0.0, all = 0.0, chance = 0.0;
    for (const PlaceSums& sum : sums_of(torques, place, count)) {
        if (sum.samples < 2.0) continue;
        const double square = sum.square - sum.torque * sum.torque / sum.samples;
        const double both = sum.both - sum.torque * sum.left / sum.samples;
        if (!(square > 0.0)) continue;
        off += both * both / square;
        all += square;
        chance += torques.variance_nm2;
    }
    if (!(all > telling_deviations * chance)) return 0.0;
    return std::sqrt(std::max(off - chance, 0.0) / all);
}

std::vector<std::size_t> by_time(const ModelBench& bench, std::size_t count) {
    const auto& time_s = bench.looked_at().motion.time_s;
    const double start_s = time_s.front(), length_s = (time_s.back() - start_s) / static_cast<double>(count);
    std::vector<std::size_t> place;
    for (const std::size_t k : bench.rows())
        place.push_back(std::min(static_cast<std::size_t>((time_s[k] - start_s) / length_s), count - 1));
    return place;
}

// Speeds in equal parts of the samples that move, each direction by itself.
std::vector<std::size_t> by_speed(const ModelBench& bench, std::size_t count) {
    const auto& velocity = bench.looked_at().motion.velocity_deg_s;
    std::vector<double> speeds;
    for (const std::size_t k : bench.rows()) {
        if (std::abs(velocity[k]) > bench.looked_at().moving_deg_s) speeds.push_back(std::abs(velocity[k]));
    }
    std::vector<double> ends;
    for (std::size_t b = 1; b < count && !speeds.empty(); ++b) {
        const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * b / count);
        std::nth_element(speeds.begin(), middle, speeds.end());
        ends.push_back(*middle);
    }
    std::vector<std::size_t> place;
    for (const std::size_t k : bench.rows()) {
        const double speed = std::abs(velocity[k]);
        const auto b =
            static_cast<std::size_t>(std::lower_bound(ends.begin(), ends.end(), speed) - ends.begin());
        const bool counts = speed > bench.looked_at().moving_deg_s && bench.looked_at().edge[k] == 0;
        place.push_back(counts ? b + (velocity[k] > 0.0 ? count : 0) : none);
    }
    return place;
}

}  // namespace

Unevenness unevenness(const ModelBench& bench, const Model& stated, std::size_t term) {
    const Torques torques = torques_of(bench, stated, term);
    if (only_constant(torques)) return {1.0, "where it changes and where it does not"};
    Unevenness worst;
    const auto compare = [&](double part, std::string_view where) {
        if (part > worst.part) worst = {part, where};
    };
    const EvennessRules& rules = bench.rules().evenness;
    compare(between(torques, rules.least_sigma, by_time(bench, rules.times), rules.times),
            "early and late in the log");
    compare(between(torques, rules.least_sigma, by_speed(bench, rules.speeds), 2 * rules.speeds),
            "slow and fast, forth and back");
    for (const std::size_t stretches : {rules.short_stretches, rules.long_stretches})
        compare(share_within(torques, rules.telling_deviations, by_time(bench, stretches), stretches),
                "within short stretches of the log");
    return worst;
}

}  // namespace ripplenotch
