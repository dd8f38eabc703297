// SPDX-License-Identifier: MIT
#include "diagnose/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnose/spikes.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_clipped = 8;
constexpr double chance_run = 1e-4;  ///< of a run of equal values in the whole log

Term term_of(std::string_view name, std::initializer_list<std::pair<std::string_view, double>> values) {
    Term term{&find_effect(name), {}};
    for (const Parameter& parameter : term.effect->parameters) term.values.emplace_back(parameter.start);
    for (const auto& [parameter, value] : values) {
        const auto place = find_parameter(*term.effect, parameter);
        const Parameter& described = term.effect->parameters[place.value()];
        term.values[*place] = std::clamp(value, described.lower, described.upper);
    }
    return term;
}

// Step of a log that holds few distinct values at equal distances; 0 when it is as good as continuous.
double step_of(const std::vector<double>& torque_nm) {
    std::vector<double> values = torque_nm;
    std::sort(values.begin(), values.end());
    std::vector<double> distances;
    const double range = values.back() - values.front();
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double distance = values[k] - values[k - 1];
        if (distance > 1e-9 * range) distances.push_back(distance);
    }
    if (distances.empty() || distances.size() > values.size() / 4) return 0.0;
    // The smallest that is common: rarer levels leave multiples of it, rounding leaves crumbs.
    const double step = median_of(distances);
    std::size_t fitting = 0;
    for (const double distance : distances) {
        const double steps = distance / step;
        if (std::abs(steps - std::round(steps)) < 0.02 * std::max(steps, 1.0) && steps > 0.5) ++fitting;
    }
    return fitting >= distances.size() * 9 / 10 ? step : 0.0;
}

double noise_of(const std::vector<double>& torque_nm) {
    // Second differences take motion and slow torque away; 6 is the sum of the squares of 1, -2, 1.
    std::vector<double> off;
    for (std::size_t k = 1; k + 1 < torque_nm.size(); ++k)
        off.push_back(std::abs(torque_nm[k - 1] - 2.0 * torque_nm[k] + torque_nm[k + 1]));
    return 1.4826 * median_of(off) / std::sqrt(6.0);
}

class Detector {
  public:
    explicit Detector(Case& looked_at) : case_(looked_at), torque_nm_(looked_at.torque_nm) {
        step_nm_ = step_of(torque_nm_);
        usual_nm_ = noise_of(torque_nm_);
    }

    void quantization(std::vector<Fault>& faults) const {
        if (step_nm_ == 0.0 || step_nm_ < 1.5 * noise_of(torque_nm_)) return;
        case_.step_nm = step_nm_;
        Fault fault{term_of("quantization", {{"step_nm", step_nm_}}), 0, {}, {}};
        std::map<double, int> levels;
        for (const double torque : torque_nm_) ++levels[torque];
        fault.words =
            fmt::format("the log holds {} distinct values, {} Nm apart", levels.size(), rounded(step_nm_));
        faults.push_back(fault);
    }

    void saturation(std::vector<Fault>& faults) {
        const auto [low, high] = std::minmax_element(torque_nm_.begin(), torque_nm_.end());
        const double rails[] = {*low, *high};
        std::size_t hits = 0, sides = 0;
        double limit_nm = 0.0;
        std::vector<std::size_t> clipped;
        for (const double rail : rails) {
            std::vector<std::size_t> at;
            std::size_t next = 0;  // samples on the level before the last
            for (std::size_t k = 0; k < torque_nm_.size(); ++k) {
                const double off = std::abs(torque_nm_[k] - rail);
                if (off <= 1e-9 * std::abs(rail))
                    at.push_back(k);
                else if (step_nm_ > 0.0 && off < 1.5 * step_nm_)
                    ++next;
            }
            // On whole steps the extreme is held by chance, but by fewer samples than the level below it.
            if (at.size() < fewest_clipped || (step_nm_ > 0.0 && at.size() < 2 * next)) continue;
            ++sides;
            hits += at.size();
            limit_nm = std::max(limit_nm, std::abs(rail));
            clipped.insert(clipped.end(), at.begin(), at.end());
        }
        if (sides == 0) return;
        std::sort(clipped.begin(), clipped.end());
        Fault fault{term_of("saturation", {{"limit_nm", limit_nm}}), hits, {}, {}};
        fault.words = fmt::format("{} samples stand at exactly {} Nm, the end of the log's range", hits,
                                  rounded(limit_nm));
        spoil(fault, clipped);
        faults.push_back(fault);
    }

    void dropout(std::vector<Fault>& faults) {
        const std::size_t n = torque_nm_.size(), run = unlikely_run();
        std::vector<std::size_t> held;
        std::vector<double> lengths;
        const double usual_deg = step_nm_ > 0.0 ? usual_turn_deg() : 0.0;
        for (std::size_t k = 1; k < n;) {
            const std::size_t end = end_of_run(k);
            const bool slow = step_nm_ > 0.0 && turn_deg(k - 1, end) < usual_deg;
            if (end - k >= run && !slow) {
                lengths.push_back(static_cast<double>(end - k));
                for (std::size_t i = k; i < end; ++i) held.push_back(i);
            }
            k = std::max(end, k + 1);
        }
        if (lengths.empty()) return;
        const double rate = case_.motion.sample_rate.value();
        double mean = 0.0;
        for (const double length : lengths) mean += length / static_cast<double>(lengths.size());
        const double duration_s = static_cast<double>(n) / rate;
        Fault fault{term_of("dropout", {{"rate_hz", static_cast<double>(lengths.size()) / duration_s},
                                        {"duration_s", mean / rate}}),
                    held.size(),
                    {},
                    {}};
        fault.words = fmt::format("{} stretches of {} ms on average repeat one value", lengths.size(),
                                  rounded(1e3 * mean / rate));
        spoil(fault, held);
        faults.push_back(fault);
    }

    void spikes(std::vector<Fault>& faults) {
        const std::vector<Spike> found = find_spikes(case_, std::max(usual_nm_, 0.3 * step_nm_));
        if (found.empty()) return;
        std::vector<std::size_t> hit;
        std::vector<double> sizes;
        for (const Spike& spike : found) {
            hit.push_back(spike.sample);
            sizes.push_back(spike.size_nm);
        }
        const double per_sample = static_cast<double>(hit.size()) / static_cast<double>(torque_nm_.size());
        Fault fault{term_of("spikes", {{"rate_percent", 100.0 * per_sample}, {"size_nm", median_of(sizes)}}),
                    hit.size(),
                    {},
                    {}};
        fault.words = fmt::format("{} single samples stand {} Nm off their neighbours", hit.size(),
                                  rounded(median_of(sizes)));
        spoil(fault, hit);
        faults.push_back(fault);
    }

  private:
    // Repeats in a row that chance hardly makes while the joint moves.
    [[nodiscard]] std::size_t unlikely_run() const {
        const std::size_t n = torque_nm_.size();
        std::size_t equal = 0, moving = 0;
        for (std::size_t k = 1; k < n; ++k) {
            if (std::abs(case_.motion.velocity_deg_s[k]) < 2.0 || case_.use[k] == 0) continue;
            ++moving;
            if (torque_nm_[k] == torque_nm_[k - 1]) ++equal;
        }
        const double often = std::clamp(
            static_cast<double>(equal) / static_cast<double>(std::max<std::size_t>(moving, 1)), 1e-3, 0.95);
        const auto run = static_cast<std::size_t>(
            std::ceil(portable::log(chance_run / static_cast<double>(n)) / portable::log(often)));
        // On whole steps a slow torque stays on one: what is held must be long against that.
        return std::max<std::size_t>(run, step_nm_ > 0.0 ? 30 : 4);
    }

    // First sample from k on that differs from the one before it.
    [[nodiscard]] std::size_t end_of_run(std::size_t k) const {
        while (k < torque_nm_.size() && torque_nm_[k] == torque_nm_[k - 1] && case_.use[k] != 0) ++k;
        return k;
    }

    [[nodiscard]] double turn_deg(std::size_t first, std::size_t end) const {
        return std::abs(case_.motion.position_deg[end - 1] - case_.motion.position_deg[first]);
    }

    // On whole steps the torque stays on one until the joint has turned far enough: a held stretch goes
    // through several times the angle of the longest that come by nature.
    [[nodiscard]] double usual_turn_deg() const {
        std::vector<double> turns;
        for (std::size_t k = 1; k < torque_nm_.size();) {
            const std::size_t end = end_of_run(k);
            if (end > k) turns.push_back(turn_deg(k - 1, end));
            k = std::max(end, k + 1);
        }
        if (turns.size() < 10) return 1e300;
        const auto high = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() * 98 / 100);
        std::nth_element(turns.begin(), high, turns.end());
        return 4.0 * *high;
    }

    static std::string rounded(double value) { return fmt::format("{:.3g}", value); }

    void spoil(Fault& fault, const std::vector<std::size_t>& samples) {
        const auto& time_s = case_.motion.time_s;
        const double gap_s = 1.5 / case_.motion.sample_rate.value();
        for (const std::size_t k : samples) {
            case_.use[k] = 0;
            if (!fault.time_s.empty() && time_s[k] - fault.time_s.back().to <= gap_s) {
                fault.time_s.back().to = time_s[k];
            } else {
                fault.time_s.push_back({time_s[k], time_s[k]});
            }
        }
    }

    Case& case_;
    const std::vector<double>& torque_nm_;
    double step_nm_ = 0.0, usual_nm_ = 0.0;
};

}  // namespace

std::vector<Fault> find_faults(Case& looked_at) {
    Detector detector(looked_at);
    std::vector<Fault> faults;
    detector.saturation(faults);
    detector.quantization(faults);
    detector.dropout(faults);
    detector.spikes(faults);
    return faults;
}

}  // namespace ripplenotch
