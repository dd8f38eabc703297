// SPDX-License-Identifier: MIT
// MATLAB and Octave: sos and g, as a script that sets them.
#include <fmt/format.h>

#include <array>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    name_key("ripplenotch", "the structure it sets"),
};

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target matlab, name");
    std::string text = comment_lines(heading, "% ");
    text +=
        "% Sections are rows [b0 b1 b2 1 a1 a2] with the sign of sosfilt and sos2tf; g is the gain of all.\n";
    text += fmt::format("{}.fs = {};\n{}.g = 1;\n", name, shortest(filters.sample_rate.value()), name);
    if (filters.by_speed()) {
        text += fmt::format(
            "% A band is active while from < |v| <= to, joint speed in deg/s.\n{0}.from_deg_s = "
            "[{1}];\n{0}.to_deg_s = [{2}];\n",
            name, joined(edges(filters, &ExportBand::from), " ", shortest),
            joined(edges(filters, &ExportBand::to), " ", shortest));
    }
    for (std::size_t b = 0; b < filters.bands.size(); ++b) {
        text += fmt::format("% {}\n{}.sos{{{}}} = [\n", describe(filters.bands[b]), name, b + 1);
        for (const ExportSection& section : filters.bands[b].sections) {
            const Biquad& f = section.section;
            text += fmt::format("    {} {} {} 1 {} {}  % {}\n", shortest(f.b0), shortest(f.b1),
                                shortest(f.b2), shortest(f.a1), shortest(f.a2), describe(section));
        }
        text += "];\n";
    }
    return {text, {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::percent, Precision::float64);
    reader.expect(".g =");
    const double gain = reader.number();
    if (gain != 1.0) reader.fail(shortest(gain), "a gain of 1");
    std::vector<double> values;
    const auto enter = [&](const ExportBand& band) {
        reader.expect(".sos{");
        values = reader.numbers('[', ']', 6 * band.sections.size());
    };
    return read_bands(filters, enter, [&](std::size_t i) { return loaded_row(values.data() + 6 * i); });
}

std::string usage(const FilterSet&, const Settings& settings, const std::string&) {
    const std::string name = settings.text("name");
    return fmt::format("y = {0}.g * sosfilt({0}.sos{{band}}, x);", name);
}

}  // namespace

const Target targets::matlab = {
    .name = "matlab",
    .summary = "sos and g as a script for MATLAB and Octave",
    .source = "MathWorks, Signal Processing Toolbox, sosfilt and sos2tf",
    .endings = ".m",
    .switches = true,
    .keys = keys,
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
