// SPDX-License-Identifier: MIT
// ArduPilot-style harmonic notch: frequency, bandwidth, attenuation and a mask of harmonics.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {limits_key};
constexpr int most_harmonics = 16;
constexpr double deepest_db = 50.0, shallowest_db = 5.0;
constexpr int mode_fixed = 0, mode_rpm_sensor = 2;

// Bit 0 is the first harmonic, so that 11 is harmonics 1, 2 and 4.
unsigned mask_of(const std::vector<int>& harmonics) {
    unsigned mask = 0;
    for (const int harmonic : harmonics) mask |= 1U << static_cast<unsigned>(harmonic - 1);
    return mask;
}

std::vector<int> harmonics_in(unsigned mask) {
    std::vector<int> harmonics;
    for (int h = 1; h <= most_harmonics; ++h) {
        if ((mask >> static_cast<unsigned>(h - 1) & 1U) != 0) harmonics.push_back(h);
    }
    return harmonics;
}

// Centres as multiples of the lowest one; the firmware has one base frequency.
std::vector<int> multiples(const std::vector<ExportSection>& sections) {
    std::vector<int> harmonics;
    const Hertz base = std::min_element(sections.begin(), sections.end(), [](const auto& a, const auto& b) {
                           return a.center < b.center;
                       })->center;
    for (const ExportSection& section : sections) {
        const double ratio = section.center / base;
        const int whole = static_cast<int>(std::round(std::min(ratio, 1e6)));
        if (std::abs(ratio - whole) > 1e-9 * ratio || whole > most_harmonics ||
            std::find(harmonics.begin(), harmonics.end(), whole) != harmonics.end()) {
            raise<UsageError>(
                "target ardupilot has harmonics 1 to {} of one base frequency, each once; {} Hz is {:.4g} "
                "times {} Hz",
                most_harmonics, shortest(section.center.value()), ratio, shortest(base.value()));
        }
        harmonics.push_back(whole);
    }
    return harmonics;
}

double attenuation_db(const SharedShape& shape, const Settings& settings,
                      std::vector<std::string>& warnings) {
    if (shape.gain == 0.0) {
        warnings.push_back(
            fmt::format("the firmware holds no full null; its deepest, {} dB, is written", deepest_db));
        return deepest_db;
    }
    const double depth = -20.0 * portable::log10(shape.gain);
    check_range(settings, "INS_HNTCH_ATT", depth, shallowest_db, deepest_db,
                "design with a --depth in this range");
    return depth;
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const SharedShape shape = shared_shape(filters, "ardupilot");
    const auto& sections = filters.bands.front().sections;
    const bool by_speed = filters.by_speed();
    const auto harmonics =
        by_speed ? whole_orders(filters, most_harmonics, "ardupilot") : multiples(sections);
    // Below FREQ the firmware does not follow the motor, so the first band's lower edge is where it begins.
    const double base =
        by_speed ? ripple_frequency(Order(1.0), *filters.gear_ratio, filters.bands.front().from).value()
                 : sections[static_cast<std::size_t>(std::min_element(harmonics.begin(), harmonics.end()) -
                                                     harmonics.begin())]
                       .center.value();
    if (!(base > 0.0)) {
        raise<UsageError>(
            "target ardupilot needs a lowest frequency; let the first band begin above 0 deg/s");
    }
    const double bandwidth = bandwidth_from_q(base, shape.q);
    check_range(settings, "INS_HNTCH_FREQ", base, 10.0, 495.0, "let the first band begin at another speed");
    check_range(settings, "INS_HNTCH_BW", bandwidth, 5.0, 250.0, "design with another --q");
    Written written;
    const double depth = attenuation_db(shape, settings, written.warnings);
    written.bytes = comment_lines(heading, "# ");
    written.bytes += fmt::format(
        "INS_HNTCH_ENABLE,1\nINS_HNTCH_MODE,{}\nINS_HNTCH_REF,{}\nINS_HNTCH_FREQ,{:.9g}\nINS_HNTCH_BW,{:.9g}"
        "\n"
        "INS_HNTCH_ATT,{:.9g}\nINS_HNTCH_HMNCS,{}\n",
        by_speed ? mode_rpm_sensor : mode_fixed, by_speed ? 1 : 0, base, bandwidth, depth,
        mask_of(harmonics));
    if (by_speed) {
        written.warnings.emplace_back(
            "the firmware retunes its notches to the motor at every update: the bands' own centres are not "
            "used");
    }
    return written;
}

// The coefficients that the firmware computes from its parameters, in float, for its float direct form.
LoadedSection notch_in_float(double center_hz, double q, double attenuation, Hertz sample_rate) {
    const double gain = portable::pow(10.0, -attenuation / 40.0);
    const double omega = 2.0 * std::numbers::pi * center_hz / sample_rate.value();
    const double alpha = portable::sin(omega) / (2.0 * q), scale = 1.0 / (1.0 + alpha);
    Biquad f{(1.0 + alpha * gain * gain) * scale, -2.0 * portable::cos(omega) * scale,
             (1.0 - alpha * gain * gain) * scale, -2.0 * portable::cos(omega) * scale, (1.0 - alpha) * scale};
    for (double* value : {&f.b0, &f.b1, &f.b2, &f.a1, &f.a2}) *value = as_float(*value);
    return loaded(f, {Form::df1, Precision::float32});
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::hash, Precision::float32);
    const auto parameter = [&reader](std::string_view name) {
        reader.expect(name);
        return reader.number();
    };
    const double base = parameter("INS_HNTCH_FREQ,");
    const double q = q_from_bandwidth(base, parameter("INS_HNTCH_BW,"));
    const double depth = parameter("INS_HNTCH_ATT,");
    const auto harmonics = harmonics_in(static_cast<unsigned>(parameter("INS_HNTCH_HMNCS,")));
    LoadedFilters found;
    for (const ExportBand& band : filters.bands) {
        auto& sections = found.bands.emplace_back();
        const double motor = filters.by_speed()
                                 ? ripple_frequency(Order(1.0), *filters.gear_ratio, band.middle()).value()
                                 : base;
        // In the order of the design, which need not be that of the bits.
        std::vector<std::size_t> rank(band.sections.size());
        for (std::size_t i = 0; i < rank.size(); ++i) {
            rank[i] = static_cast<std::size_t>(
                std::count_if(band.sections.begin(), band.sections.end(),
                              [&](const auto& other) { return other.center < band.sections[i].center; }));
        }
        for (const std::size_t r : rank) {
            if (r >= harmonics.size())
                reader.fail(fmt::format("{} harmonics", harmonics.size()), "one for each notch");
            sections.push_back(notch_in_float(motor * harmonics[r], q, depth, filters.sample_rate));
        }
    }
    return found;
}

}  // namespace

const Target targets::ardupilot = {
    .name = "ardupilot",
    .summary = "INS_HNTCH_*: frequency, bandwidth, attenuation, harmonics, in ArduPilot's way",
    .source = "ArduPilot, libraries/Filter: NotchFilter, HarmonicNotchFilter",
    .endings = ".param .parm .txt",
    .notches_only = true,
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
