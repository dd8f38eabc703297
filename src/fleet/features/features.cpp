// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <regex>
#include <span>
#include <string_view>

#include "core/matrices/least_squares.hpp"
#include "fleet/features/motion_facts.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

namespace {

constexpr double widest_phase_deg = 45.0;  // half of its interval

/// What the descriptors of a log are computed from.
struct FeatureSource {
    const Identification& found;
    const JointFit& joint;
    const RippleEstimate* ripple;  ///< of the order in question; nullptr for what belongs to none
    bool has_position;
};

void gear_ratio(const FeatureSource& from, Descriptor& one) {
    const GearRatioFit& fit = from.found.gear_ratio;
    one.value = fit.value;
    if (fit.value)
        one.ci95 = Interval{fit.ci95_low, fit.ci95_high};
    else
        one.reason = from.found.verdict;
}

void ripple_amplitude(const FeatureSource& from, Descriptor& one) {
    const RippleEstimate& ripple = *from.ripple;
    one.reason = ripple.insufficient;
    const double half_nm = normal_95_errors * ripple.standard_error_nm;
    if (ripple.present()) {
        one.value = ripple.amplitude_nm;
        one.ci95 = Interval{std::max(ripple.amplitude_nm - half_nm, 0.0), ripple.amplitude_nm + half_nm};
    } else if (ripple.searched()) {
        one.reason = fmt::format("no ripple above {:.2g} Nm", ripple.detectable_nm);
    }
}

void ripple_phase(const FeatureSource& from, Descriptor& one) {
    const RippleEstimate& ripple = *from.ripple;
    one.reason = ripple.insufficient;
    const double half_deg = normal_95_errors * ripple.phase_standard_error_deg;
    if (ripple.searched() && !from.has_position)
        one.reason = "the log has no position, and so no angle to count from";
    else if (ripple.searched() && !(ripple.present() && ripple.phase_deg && half_deg < widest_phase_deg))
        one.reason = ripple.present() ? "the phase is not the same along the log"
                                      : "the amplitude is too small for a phase";
    if (!one.reason.empty()) return;
    one.value = ripple.phase_deg;
    one.ci95 = Interval{*ripple.phase_deg - half_deg, *ripple.phase_deg + half_deg};
}

template <void (JointFit::*estimate)(Descriptor&) const>
void fitted(const FeatureSource& from, Descriptor& one) {
    (from.joint.*estimate)(one);
}

void noise_floor(const FeatureSource& from, Descriptor& one) {
    const double noise_nm = from.joint.noise_nm();
    if (noise_nm > 0.0)
        one.value = noise_nm;
    else
        one.reason = "the torque holds its values from sample to sample";
}

struct DescriptorKind {
    std::string_view stem;  ///< "ripple_N_amplitude": with an order in the place of N
    std::string_view unit;  ///< as it ends the name
    void (*estimate)(const FeatureSource& from, Descriptor& one);

    [[nodiscard]] bool is_of_order() const { return stem.starts_with("ripple_N"); }
};

/// All descriptors, in the order of a line of features. docs/commands/features.md says what they are.
constexpr std::array descriptor_kinds = {
    DescriptorKind{"gear_ratio", "", gear_ratio},
    DescriptorKind{"ripple_N_amplitude", "nm", ripple_amplitude},
    DescriptorKind{"ripple_N_phase", "deg", ripple_phase},
    DescriptorKind{"coulomb_friction", "nm", fitted<&JointFit::coulomb_friction>},
    DescriptorKind{"viscous_friction", "nm_per_deg_s", fitted<&JointFit::viscous_friction>},
    DescriptorKind{"load_friction", "nm_per_nm", fitted<&JointFit::load_friction>},
    DescriptorKind{"lost_motion", "deg", fitted<&JointFit::lost_motion>},
    DescriptorKind{"inertia", "kgm2", fitted<&JointFit::inertia>},
    DescriptorKind{"gravity", "nm", fitted<&JointFit::gravity>},
    DescriptorKind{"sensor_zero", "nm", fitted<&JointFit::sensor_zero>},
    DescriptorKind{"noise_floor", "nm", noise_floor},
};

/// Those of an order for one order after the other.
std::vector<Descriptor> descriptors_of(FeatureSource from, std::span<const RippleEstimate> ripple) {
    std::vector<Descriptor> all;
    const auto add = [&](const DescriptorKind& kind) {
        Descriptor& one = all.emplace_back();
        one.stem = kind.stem;
        if (from.ripple != nullptr) one.stem.replace(one.stem.find('N'), 1, shortest(from.ripple->order));
        one.unit = kind.unit;
        kind.estimate(from, one);
    };
    const auto is_of_order = [](const DescriptorKind& kind) { return kind.is_of_order(); };
    const auto first = std::find_if(descriptor_kinds.begin(), descriptor_kinds.end(), is_of_order);
    const auto last = std::find_if_not(first, descriptor_kinds.end(), is_of_order);
    std::for_each(descriptor_kinds.begin(), first, add);
    for (const RippleEstimate& one : ripple) {
        from.ripple = &one;
        std::for_each(first, last, add);
    }
    from.ripple = nullptr;
    std::for_each(last, descriptor_kinds.end(), add);
    return all;
}

// "ripple_2_amplitude" or "ripple_0.5_phase" -> "ripple_N_amplitude"
std::string without_order(const std::string& stem) {
    constexpr std::string_view front = "ripple_";
    if (!stem.starts_with(front)) return stem;
    const std::size_t end = stem.find('_', front.size());
    if (end == std::string::npos || end == front.size()) return stem;
    const auto digits = stem.substr(front.size(), end - front.size());
    const bool number = std::all_of(digits.begin(), digits.end(), [](char c) {
        return c == '.' || std::isdigit(static_cast<unsigned char>(c)) != 0;
    });
    return number ? "ripple_N" + stem.substr(end) : stem;
}

}  // namespace

Descriptor descriptor_named(const std::string& name) {
    std::string near;
    for (const DescriptorKind& kind : descriptor_kinds) {
        const std::string ending = kind.unit.empty() ? "" : "_" + std::string(kind.unit);
        const bool ends = name.ends_with(ending);
        const std::string stem = ends ? name.substr(0, name.size() - ending.size()) : name;
        if (ends && without_order(stem) == kind.stem) return {stem, std::string(kind.unit), {}, {}, {}};
        if (without_order(name).starts_with(std::string(kind.stem) + "_"))
            near = name.substr(0, name.rfind('_')) + ending;
    }
    if (!near.empty()) raise<DataError>("'{}' is in another unit; this tool's lines have {}", name, near);
    raise<DataError>("'{}' is no descriptor of this tool", name);
}

namespace {

constexpr std::string_view letters = "YmdHMS";
constexpr std::string_view robot_word = "{robot}";

struct Calendar {
    std::array<int, 6> number = {1970, 1, 1, 0, 0, 0};  // in the order of `letters`
};

std::optional<double> seconds_of(const Calendar& when) {
    const auto [year, month, day, hour, minute, second] = when.number;
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (year < 1900 || year > 2200 || !date.ok() || hour > 23 || minute > 59 || second > 60)
        return std::nullopt;
    const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
    return static_cast<double>(days * 86400 + hour * 3600 + minute * 60 + second);
}

// A pattern of names as a regular expression; `groups`: of each of its groups the letter, or r of the robot.
std::regex name_form(std::string_view pattern, std::string& groups) {
    std::string text;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        const char c = pattern[i];
        if (c == '%') {
            text += pattern[++i] == 'Y' ? "([0-9]{4})" : "([0-9]{2})";
            groups += pattern[i];
        } else if (pattern.substr(i).starts_with(robot_word)) {
            text += "([^/]+?)";
            groups += 'r';
            i += robot_word.size() - 1;
        } else if (c == '*' || c == '?') {
            text += c == '*' ? ".*?" : ".";
        } else {
            if (std::string_view(R"(^$\.+()[]{}|)").find(c) != std::string_view::npos) text += '\\';
            text += c;
        }
    }
    return std::regex(text);
}

}  // namespace

std::string date_text(double seconds) {
    const std::chrono::sys_seconds time(std::chrono::seconds(static_cast<std::int64_t>(std::floor(seconds))));
    const auto midnight = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(midnight);
    const auto left = (time - midnight).count();
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), left / 3600,
                       left / 60 % 60, left % 60);
}

std::optional<double> date_seconds(std::string_view text) {
    static const std::regex form(
        "([0-9]{4})-([0-9]{2})-([0-9]{2})(?:[T ]([0-9]{2}):([0-9]{2})(?::([0-9]{2}))?)?Z?");
    std::cmatch found;
    if (!std::regex_match(text.data(), text.data() + text.size(), found, form)) return std::nullopt;
    Calendar when;
    for (std::size_t field = 0; field < letters.size(); ++field)
        if (found[field + 1].matched) when.number[field] = std::stoi(found[field + 1]);
    return seconds_of(when);
}

NamePattern::NamePattern(std::string pattern) : pattern_(std::move(pattern)) {
    std::array<int, letters.size()> seen{};
    for (std::size_t i = 0; i < pattern_.size(); ++i) {
        if (pattern_[i] != '%') continue;
        const std::size_t field = i + 1 < pattern_.size() ? letters.find(pattern_[i + 1]) : std::string::npos;
        if (field == std::string::npos)
            raise<UsageError>("--date-from-name '{}': behind % stands one of Y m d H M S", pattern_);
        if (++seen[field] > 1)
            raise<UsageError>("--date-from-name '{}': %{} stands twice", pattern_, letters[field]);
    }
    for (std::size_t field = 0; field < 3; ++field)
        if (seen[field] == 0)
            raise<UsageError>("--date-from-name '{}': a date needs %Y, %m and %d, and there is no %{}",
                              pattern_, letters[field]);
}

std::optional<NamePattern::Found> NamePattern::match(const std::string& name) const {
    std::string groups;
    const std::regex form = name_form(pattern_, groups);
    for (std::size_t at = 0; at != std::string::npos;) {
        std::cmatch found;
        if (std::regex_match(name.data() + at, name.data() + name.size(), found, form)) {
            Calendar when;
            std::string robot;
            for (std::size_t g = 0; g < groups.size(); ++g) {
                if (groups[g] == 'r')
                    robot = found[g + 1];
                else
                    when.number[letters.find(groups[g])] = std::stoi(found[g + 1]);
            }
            const auto seconds = seconds_of(when);
            return seconds ? std::optional(Found{date_text(*seconds), robot}) : std::nullopt;
        }
        at = name.find('/', at);
        if (at != std::string::npos) ++at;
    }
    return std::nullopt;
}

namespace {

// Chosen, not derived: bounds the time of a log.
constexpr std::size_t max_feature_samples = std::size_t{1} << 14U;
constexpr std::size_t most_orders = 6;  // chosen, not derived: bounds the time of a log

// The gear of the ripple: the stated one, else the one that was found.
std::optional<GearAccount> gear_of_ripple(const Identification& found,
                                          const std::optional<GearAccount>& stated) {
    std::optional<GearAccount> gear = stated ? stated : found_gear(found);
    if (gear && gear->orders.size() > most_orders) gear->orders.resize(most_orders);
    return gear;
}

}  // namespace

Features features_of(const TraceView& log, const Identification& found,
                     const std::optional<GearAccount>& stated) {
    const Motion whole = motion_along(log);
    const std::vector<unsigned char> known = rows_of_known_motion(log, whole);
    const FittedSamples samples = thinned(whole, log.torque_nm, known, max_feature_samples);
    MotionFacts facts = motion_facts(samples.motion, samples.torque_nm, log.has_position());
    facts.accelerations = accelerations_of(log, whole, known);
    std::optional<GearAccount> gear = gear_of_ripple(found, stated);
    std::vector<RippleEstimate> ripple;
    if (gear) {
        ripple = estimate_ripple({&log, 1}, gear->ratio, gear->orders);
        gear->orders.clear();
        for (const RippleEstimate& one : ripple)
            if (one.searched()) gear->orders.emplace_back(one.order);
    }
    const JointFit joint(samples, facts, std::move(gear));
    Features features{facts.mix, {}};
    features.mix.load_rms_nm = joint.load_rms_nm();
    features.descriptors = descriptors_of({found, joint, nullptr, log.has_position()}, ripple);
    return features;
}

}  // namespace ripplenotch
