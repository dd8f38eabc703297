// SPDX-License-Identifier: MIT
#include "export/target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

namespace {

// Where the poles resonate, on the prewarped scale of the bilinear transform: tan^2(pi f / fs) is the ratio
// of the denominator at 0 Hz to that at half the sample rate.
Hertz natural_frequency(const Biquad& f, Hertz sample_rate) {
    const double g = std::sqrt((1.0 + f.a1 + f.a2) / (1.0 - f.a1 + f.a2));
    return sample_rate * (portable::atan(g) / std::numbers::pi);
}

}  // namespace

FilterSet filter_set(const CandidateTable& table, const SwitchingDesign& switching) {
    const TableSpec& spec = table.spec();
    FilterSet set{spec.sample_rate, spec.gear_ratio, {}, switching};
    for (const Band& band : table.bands()) {
        ExportBand out{band.number, band.from, band.to, {}};
        for (const CandidateNotch& notch : band.notches) {
            out.sections.push_back(
                {notch.order, notch.notch, notch.notch.center, notch.section, spec.gear_ratio});
        }
        set.bands.push_back(std::move(out));
    }
    return set;
}

FilterSet filter_set(const CandidateTable& table) {
    const TableSpec& spec = table.spec();
    return filter_set(table, {.below = spec.below, .above = spec.above, .hysteresis = spec.hysteresis});
}

FilterSet only_band(const FilterSet& table, int number) {
    for (const ExportBand& band : table.bands) {
        if (table.by_speed() && band.number == number) return {table.sample_rate, {}, {band}};
    }
    raise<UsageError>("there is no band {}; {}", number,
                      table.by_speed() ? fmt::format("the table has bands 1 to {}", table.bands.size())
                                       : std::string("only a table has bands"));
}

FilterSet filter_set(std::span<const NotchSpec> notches, Hertz sample_rate) {
    if (notches.empty()) raise<UsageError>("there is no notch to export; name at least one centre");
    FilterSet set{sample_rate, {}, {{}}};
    for (const NotchSpec& notch : notches) {
        set.bands.front().sections.push_back(
            {std::nullopt, notch, notch.center, design_notch(notch, sample_rate)});
    }
    return set;
}

FilterSet filter_set(const LowPassSpec& low_pass, Hertz sample_rate) {
    FilterSet set{sample_rate, {}, {{}}};
    for (const Biquad& section : design_low_pass(low_pass, sample_rate)) {
        set.bands.front().sections.push_back(
            {std::nullopt, std::nullopt, natural_frequency(section, sample_rate), section});
    }
    return set;
}

namespace {

constexpr const Target* every_target[] = {
#define TARGET(name) &targets::name,
#include "export/targets/targets.def"
#undef TARGET
};

}  // namespace

std::span<const Target* const> export_targets() { return every_target; }

std::vector<std::string_view> targets_that(bool Target::*trait, bool value) {
    std::vector<std::string_view> names;
    for (const Target* target : export_targets()) {
        if (target->*trait == value) names.push_back(target->name);
    }
    return names;
}

const Target& find_target(std::string_view name) {
    return find_entry(export_targets(), "export target", "targets", name);
}

}  // namespace ripplenotch
