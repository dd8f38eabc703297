// SPDX-License-Identifier: MIT
#include "diagnose/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// A spike stands this many times the typical deviation about it from its neighbours, and alone.
constexpr double spike_deviations = 9.0;
constexpr std::size_t fewest_spikes = 3;
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

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
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
    const double step = median(distances);
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
    return 1.4826 * median(off) / std::sqrt(6.0);
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
        const std::size_t n = torque_nm_.size();
        std::size_t equal = 0, moving = 0;
        for (std::size_t k = 1; k < n; ++k) {
            if (std::abs(case_.motion.velocity_deg_s[k]) < 2.0 || case_.use[k] == 0) continue;
            ++moving;
            if (torque_nm_[k] == torque_nm_[k - 1]) ++equal;
        }
        const double often = std::clamp(
            static_cast<double>(equal) / static_cast<double>(std::max<std::size_t>(moving, 1)), 1e-3, 0.95);
        auto run = static_cast<std::size_t>(
            std::ceil(std::log(chance_run / static_cast<double>(n)) / std::log(often)));
        // On whole steps a slow torque stays on one: what is held must be long against that.
        run = std::max<std::size_t>(run, step_nm_ > 0.0 ? 30 : 4);
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
        const auto off = from_neighbours();
        const auto typical = typical_about(off);
        const std::size_t n = torque_nm_.size();
        std::vector<std::size_t> hit;
        std::vector<double> sizes;
        std::size_t far = 0;
        for (std::size_t k = 2; k + 2 < n; ++k) {
            // Beside what is held or clipped the torque jumps by nature.
            const auto spoiled = [&](std::size_t i) { return case_.use[i] == 0; };
            if (spoiled(k - 2) || spoiled(k - 1) || spoiled(k) || spoiled(k + 1) || spoiled(k + 2)) continue;
            if (!stands_out(off, typical, k)) continue;
            // Up to two together; a burst or a ringing has its neighbours out as well.
            std::size_t out = 0;
            for (std::size_t i = k >= 8 ? k - 8 : 0; i < std::min(k + 9, n); ++i)
                out += stands_out(off, typical, i) ? 1U : 0U;
            if (out > 4) continue;
            if (!returns(off, k)) continue;
            hit.push_back(k);
            sizes.push_back(std::abs(off[k]));
            far += std::abs(off[k]) > 2.0 * threshold(typical, k) ? 1U : 0U;
        }
        // Spikes stand apart from the noise; heavy tails go on from it.
        if (hit.size() < fewest_spikes || 2 * far < hit.size()) return;
        Fault fault{term_of("spikes", {{"rate_percent",
                                        100.0 * static_cast<double>(hit.size()) / static_cast<double>(n)},
                                       {"size_nm", median(sizes)}}),
                    hit.size(),
                    {},
                    {}};
        fault.words = fmt::format("{} single samples stand {} Nm off their neighbours", hit.size(),
                                  rounded(median(sizes)));
        spoil(fault, hit);
        faults.push_back(fault);
    }

  private:
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

    [[nodiscard]] double threshold(const std::vector<double>& typical, std::size_t k) const {
        return spike_deviations * std::max({typical[k], usual_nm_, 0.3 * step_nm_});
    }
    [[nodiscard]] bool stands_out(const std::vector<double>& off, const std::vector<double>& typical,
                                  std::size_t k) const {
        return std::abs(off[k]) > threshold(typical, k);
    }

    // After a spike the torque is where it was; after a step it is not. Of two samples to either side one may
    // be a spike itself.
    [[nodiscard]] bool returns(const std::vector<double>& off, std::size_t k) const {
        const double size = std::abs(off[k]);
        for (const std::size_t before : {k - 1, k - 2}) {
            for (const std::size_t after : {k + 1, k + 2}) {
                if (std::abs(torque_nm_[before] - torque_nm_[after]) < 0.4 * size &&
                    std::abs(torque_nm_[k] - torque_nm_[before]) > 0.7 * size)
                    return true;
            }
        }
        return false;
    }

    // Each sample less what its two neighbours to either side let expect: their median, or the cubic through
    // them, whichever it is nearer to. A step is near the one, a fast swing near the other.
    [[nodiscard]] std::vector<double> from_neighbours() const {
        std::vector<double> off(torque_nm_.size(), 0.0);
        for (std::size_t k = 2; k + 2 < torque_nm_.size(); ++k) {
            double four[] = {torque_nm_[k - 2], torque_nm_[k - 1], torque_nm_[k + 1], torque_nm_[k + 2]};
            const double cubic = torque_nm_[k] - (4.0 * (four[1] + four[2]) - four[0] - four[3]) / 6.0;
            std::sort(std::begin(four), std::end(four));
            const double median_off = torque_nm_[k] - 0.5 * (four[1] + four[2]);
            off[k] = std::abs(cubic) < std::abs(median_off) ? cubic : median_off;
        }
        return off;
    }

    // Typical size over a fifth of a second about each sample.
    [[nodiscard]] std::vector<double> typical_about(const std::vector<double>& off) const {
        const auto block =
            std::max<std::size_t>(20, static_cast<std::size_t>(0.1 * case_.motion.sample_rate.value()));
        std::vector<double> blocks;
        for (std::size_t first = 0; first < off.size(); first += block) {
            std::vector<double> part;
            for (std::size_t k = first; k < std::min(first + block, off.size()); ++k)
                if (case_.use[k] != 0) part.push_back(std::abs(off[k]));
            blocks.push_back(1.4826 * median(part));
        }
        std::vector<double> typical(off.size());
        for (std::size_t k = 0; k < off.size(); ++k) {
            const std::size_t b = k / block;
            typical[k] =
                std::max({blocks[b], blocks[b > 0 ? b - 1 : 0], blocks[std::min(b + 1, blocks.size() - 1)]});
        }
        return typical;
    }

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
