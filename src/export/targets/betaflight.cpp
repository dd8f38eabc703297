// SPDX-License-Identifier: MIT
// Betaflight-style parameters. A table becomes the rpm filter, which follows the motor by itself; a filter
// for all speeds becomes static notches.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {limits_key};
constexpr int most_harmonics = 3;
constexpr std::size_t most_static_notches = 2;

// output = x - weight * (1 - the notch): the firmware's state-variable form in float.
LoadedSection notch_in_float(double center_hz, double q, double weight, Hertz sample_rate) {
    const ExportSection section{std::nullopt, NotchSpec{Hertz(center_hz), q}, Hertz(center_hz), {}};
    SvfSection svf = svf_of(section, sample_rate);
    svf.m1 *= weight;
    for (double* value : {&svf.a1, &svf.a2, &svf.a3, &svf.m1}) *value = as_float(*value);
    return loaded(svf, Precision::float32);
}

Written write_rpm_filter(const FilterSet& filters, const Settings& settings) {
    const SharedShape shape = shared_shape(filters, "betaflight");
    const std::vector<int> orders = whole_orders(filters, most_harmonics, "betaflight");
    const int highest = *std::max_element(orders.begin(), orders.end());
    const int weight = static_cast<int>(std::round(100.0 * (1.0 - shape.gain)));
    std::vector<int> weights(most_harmonics, 0);
    for (const int order : orders) weights[static_cast<std::size_t>(order - 1)] = weight;
    const double q = std::round(100.0 * shape.q);
    const Hertz first =
        ripple_frequency(Order(orders.front()), *filters.gear_ratio, filters.bands.front().from);
    const bool fades = filters.switching.below == OutsideRule::fade;
    const double lowest = std::floor(fades ? first.value() / 2.0 : first.value());
    const double fade = fades ? std::floor(first.value() - lowest) : 0.0;
    check_range(settings, "rpm_filter_q", q, 250.0, 3000.0, "design with a --q from 2.5 to 30");
    check_range(settings, "rpm_filter_min_hz", lowest, 30.0, 200.0,
                "let the first band begin at another speed");
    check_range(settings, "rpm_filter_fade_range_hz", fade, 0.0, 1000.0, "design without --below fade");
    Written written;
    written.bytes = fmt::format(
        "set rpm_filter_harmonics = {}\nset rpm_filter_weights = {}\nset rpm_filter_q = {}\n"
        "set rpm_filter_min_hz = {}\nset rpm_filter_fade_range_hz = {}\n",
        highest, fmt::join(weights, ","), shortest(q), shortest(lowest), shortest(fade));
    if (std::abs(weight / 100.0 - (1.0 - shape.gain)) > 1e-12) {
        written.warnings.push_back(
            fmt::format("a depth of {:.3g} dB is weight {} %", -20.0 * portable::log10(shape.gain), weight));
    }
    written.warnings.emplace_back(
        "the firmware retunes its notches to the motor at every update: the bands' own centres are not used");
    return written;
}

Written write_static(const FilterSet& filters, const Settings& settings) {
    const SharedShape shape = shared_shape(filters, "betaflight");
    const auto& sections = filters.bands.front().sections;
    if (shape.gain != 0.0) {
        raise<UsageError>("target betaflight has static notches of full depth only; design without --depth");
    }
    if (sections.size() > most_static_notches) {
        raise<UsageError>("target betaflight has {} static notches, and this filter has {}",
                          most_static_notches, sections.size());
    }
    Written written;
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const double center = sections[i].center.value(), whole = std::max(1.0, std::round(center));
        const double cutoff =
            std::clamp(std::round(cutoff_from_q(whole, shape.q)), 1.0, std::max(1.0, whole - 1.0));
        check_range(settings, fmt::format("gyro_notch{}_hz", i + 1), whole, 2.0, 1000.0,
                    "choose another centre");
        if (!(cutoff < whole)) {
            raise<UsageError>(
                "target betaflight holds whole hertz, and a notch at {} Hz cannot have a cut-off below it",
                shortest(center));
        }
        written.bytes += fmt::format("set gyro_notch{0}_hz = {1}\nset gyro_notch{0}_cutoff = {2}\n", i + 1,
                                     shortest(whole), shortest(cutoff));
        const double q = q_from_cutoff(whole, cutoff);
        if (whole != center || std::abs(q / shape.q - 1.0) > 0.005) {
            written.warnings.push_back(fmt::format("{} Hz, Q {} is {} Hz, Q {:.4g} in whole hertz",
                                                   shortest(center), shortest(shape.q), shortest(whole), q));
        }
    }
    return written;
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    Written written =
        filters.by_speed() ? write_rpm_filter(filters, settings) : write_static(filters, settings);
    written.bytes = comment_lines(heading, "# ") + written.bytes;
    return written;
}

LoadedFilters read_rpm_filter(TextReader& reader, const FilterSet& filters) {
    reader.expect("rpm_filter_harmonics");
    const double harmonics = reader.number();
    reader.expect("rpm_filter_weights");
    std::vector<double> weights;
    while (weights.size() < most_harmonics) weights.push_back(reader.number());
    reader.expect("rpm_filter_q");
    const double q = reader.number() / 100.0;
    reader.expect("rpm_filter_min_hz");
    const double lowest = reader.number();
    reader.expect("rpm_filter_fade_range_hz");
    const double fade = reader.number();
    LoadedFilters found;
    for (const ExportBand& band : filters.bands) {
        auto& sections = found.bands.emplace_back();
        for (const ExportSection& section : band.sections) {
            const double order = section.order->value();
            const double wanted =
                ripple_frequency(*section.order, *filters.gear_ratio, band.middle()).value();
            const double center = std::clamp(wanted, lowest, 0.48 * filters.sample_rate.value());
            const double share = fade > 0.0 ? std::clamp((wanted - lowest) / fade, 0.0, 1.0) : 1.0;
            const double weight =
                order > harmonics ? 0.0 : weights[static_cast<std::size_t>(order) - 1] / 100.0 * share;
            sections.push_back(notch_in_float(center, q, weight, filters.sample_rate));
        }
    }
    return found;
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::hash, Precision::float64);
    if (filters.by_speed()) return read_rpm_filter(reader, filters);
    return read_bands(
        filters, [](const ExportBand&) {},
        [&](std::size_t i) {
            reader.expect(fmt::format("gyro_notch{}_hz", i + 1));
            const double center = reader.number();
            reader.expect(fmt::format("gyro_notch{}_cutoff", i + 1));
            return notch_in_float(center, q_from_cutoff(center, reader.number()), 1.0, filters.sample_rate);
        });
}

}  // namespace

const Target targets::betaflight = {
    .name = "betaflight",
    .summary = "rpm_filter_* for a table, gyro_notch* for one filter, in Betaflight's way",
    .source = "Betaflight, rpm_filter.c and filterGetNotchQ",
    .endings = ".txt",
    .notches_only = true,
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
