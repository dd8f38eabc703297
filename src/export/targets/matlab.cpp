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
    Key{.name = "name",
        .kind = KeyKind::text,
        .default_text = "ripplenotch",
        .help = "the structure it sets"},
};

std::string edges(const FilterSet& filters, DegPerSec ExportBand::*edge) {
    return joined(filters.bands, " ",
                  [edge](const ExportBand& band) { return shortest((band.*edge).value()); });
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target matlab, name");
    std::string text = comment_lines(heading, "% ");
    text +=
        "% Sections are rows [b0 b1 b2 1 a1 a2] with the sign of sosfilt and sos2tf; g is the gain of all.\n";
    text += fmt::format("{}.fs = {};\n{}.g = 1;\n", name, shortest(filters.sample_rate.value()), name);
    if (filters.by_speed()) {
        text += fmt::format(
            "% A band is in force while from < |v| <= to, joint speed in deg/s.\n"
            "{0}.from_deg_s = [{1}];\n{0}.to_deg_s = [{2}];\n",
            name, edges(filters, &ExportBand::from), edges(filters, &ExportBand::to));
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
    LoadedFilters found;
    for (const ExportBand& band : filters.bands) {
        reader.expect(".sos{");
        const auto values = reader.numbers('[', ']', 6 * band.sections.size());
        auto& sections = found.bands.emplace_back();
        for (auto v = values.begin(); v != values.end(); v += 6) {
            sections.push_back(
                loaded(Biquad{v[0], v[1], v[2], v[4], v[5]}, {Form::df2t, Precision::float64}));
        }
    }
    return found;
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
