// SPDX-License-Identifier: MIT
// One header without dependencies: tables, a step function, and a test vector to assert after pasting.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "export/code/method_code.hpp"
#include "export/run/bank.hpp"
#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> precisions = {"float", "double"};
constexpr std::array<std::string_view, 3> forms = {"svf", "df1", "df2t"};

constexpr std::array keys = {
    Key{.name = "precision",
        .kind = KeyKind::choice,
        .default_text = "float",
        .choices = precisions,
        .help = "type of every number in the header"},
    Key{.name = "form",
        .kind = KeyKind::choice,
        .default_text = "svf",
        .choices = forms,
        .help = "svf: state-variable; df1: direct form I; df2t: transposed direct form II"},
    Key{.name = "name", .kind = KeyKind::text, .default_text = "ripplenotch", .help = "prefix of all names"},
};

Arithmetic arithmetic_of(const Settings& settings) {
    const std::string form = settings.text("form");
    return {form == "svf"   ? Form::svf
            : form == "df1" ? Form::df1
                            : Form::df2t,
            settings.text("precision") == "float" ? Precision::float32 : Precision::float64};
}

double rounded(double value, Precision precision) {
    return precision == Precision::float32 ? static_cast<double>(static_cast<float>(value)) : value;
}

std::vector<double> values_of(const ExportSection& section, Hertz sample_rate, Arithmetic arithmetic) {
    std::vector<double> values;
    if (arithmetic.form == Form::svf) {
        const SvfSection s = svf_of(section, sample_rate);
        values = {s.a1, s.a2, s.a3, s.m0, s.m1, s.m2};
    } else {
        const Biquad& f = section.section;
        values = {f.b0, f.b1, f.b2, f.a1, f.a2};
    }
    for (double& value : values) value = rounded(value, arithmetic.precision);
    return values;
}

LoadedSection section_from(const std::vector<double>& v, Arithmetic arithmetic) {
    if (arithmetic.form == Form::svf)
        return loaded(SvfSection{v[0], v[1], v[2], v[3], v[4], v[5]}, arithmetic.precision);
    return loaded(Biquad{v[0], v[1], v[2], v[3], v[4]}, arithmetic);
}

struct Writer {
    Precision precision;

    [[nodiscard]] std::string exact(double value) const {
        return precision == Precision::float32 ? hexadecimal_float(value) : hexadecimal(value);
    }
    [[nodiscard]] std::string readable(double value) const {
        return precision == Precision::float32 ? fmt::format("{:.9g}", static_cast<float>(value))
                                               : shortest(value);
    }
    [[nodiscard]] std::string row(const std::vector<double>& values, std::string_view indent) const {
        return fmt::format("{0}{{{1}}},\n{0}/* {2} */\n", indent,
                           joined(values, ", ", [&](double value) { return exact(value); }),
                           joined(values, ", ", [&](double value) { return readable(value); }));
    }
};

std::string bands_text(const FilterSet& filters, const Writer& writer, Arithmetic arithmetic,
                       LoadedFilters& loaded_filters) {
    std::string text;
    for (const ExportBand& band : filters.bands) {
        text += fmt::format("    {{ /* {} */\n", describe(band));
        auto& sections = loaded_filters.bands.emplace_back();
        for (const ExportSection& section : band.sections) {
            const auto values = values_of(section, filters.sample_rate, arithmetic);
            sections.push_back(section_from(values, arithmetic));
            text += fmt::format("        /* {} */\n{}", describe(section), writer.row(values, "        "));
        }
        text += "    },\n";
    }
    return text;
}

std::string regions_text(const std::vector<BankRegion>& regions, const Writer& writer) {
    std::string text;
    for (const BankRegion& region : regions) {
        // Nothing is faster than the last region, so its edge is never used.
        const double to = std::isinf(region.to_deg_s) ? 0.0 : region.to_deg_s;
        const std::string edge = std::isinf(region.to_deg_s)
                                     ? "and faster"
                                     : fmt::format("|v| <= {} deg/s", shortest(region.to_deg_s));
        const std::string rule = region.band == region_passes  ? "the torque passes"
                                 : region.band == region_holds ? "the band in force stays"
                                                               : fmt::format("band {}", region.band + 1);
        const std::string fade = region.full_deg_s != region.none_deg_s ? ", fading" : "";
        text +=
            fmt::format("    {{{}, {}, {}, {}}}, /* {}: {}{} */\n", writer.exact(to), region.band,
                        writer.exact(region.full_deg_s), writer.exact(region.none_deg_s), edge, rule, fade);
    }
    return text;
}

std::string golden_text(const GoldenVector& golden, const Writer& writer) {
    std::string text;
    for (std::size_t k = 0; k < golden.torque_nm.size(); ++k) {
        text += fmt::format("    {{{}, {}, {}}}, /* {}, {}, {} */\n", writer.exact(golden.torque_nm[k]),
                            writer.exact(golden.speed_deg_s[k]), writer.exact(golden.expected_nm[k]),
                            writer.readable(golden.torque_nm[k]), writer.readable(golden.speed_deg_s[k]),
                            writer.readable(golden.expected_nm[k]));
    }
    return text;
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target c-header, name");
    const Arithmetic arithmetic = arithmetic_of(settings);
    const bool single = arithmetic.precision == Precision::float32;
    const Writer writer{arithmetic.precision};
    const auto regions = bank_regions(filters);
    LoadedFilters held;
    const std::string bands = bands_text(filters, writer, arithmetic, held);
    const GoldenVector golden = golden_vector(regions, held, arithmetic);

    std::string text = "/*\n" + comment_lines(heading, " * ");
    text += fmt::format(
        " * Harmonic-drive ripple filter, {}: {} bands of {} sections for {} Hz.\n"
        " * Literals are exact; the comment below each row has them in decimal.\n */\n",
        arithmetic_name(arithmetic), filters.bands.size(), filters.sections_per_band(),
        shortest(filters.sample_rate.value()));
    text += c_code::declarations(arithmetic.form);
    text +=
        "static const @name@_section @name@_bands[@NAME@_BANDS][@NAME@_SECTIONS] = {\n" + bands + "};\n\n";
    if (filters.by_speed()) text += c_code::regions_open() + regions_text(regions, writer) + "};\n\n";
    text += c_code::section_functions(arithmetic.form) + c_code::step_function(filters.by_speed());
    text += c_code::self_test_open() + golden_text(golden, writer) + "};\n\n" +
            c_code::self_test_function(filters.by_speed()) + "#endif\n";
    const std::array<std::pair<std::string_view, std::string>, 9> fields = {{
        {"@name@", name},
        {"@NAME@", upper_case(name)},
        {"@real@", single ? "float" : "double"},
        {"@rate@",
         single ? decimal_float(filters.sample_rate.value()) : decimal(filters.sample_rate.value())},
        {"@bands@", std::to_string(filters.bands.size())},
        {"@sections@", std::to_string(filters.sections_per_band())},
        {"@regions@", std::to_string(regions.size())},
        {"@golden@", std::to_string(golden.torque_nm.size())},
        {"@tolerance@", single ? "1e-4f" : "1e-9"},
    }};
    return {c_code::filled(text, fields), {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    // The file itself states in which type and form it computes.
    const bool single = bytes.find("typedef float ") != std::string_view::npos;
    TextReader reader(bytes, source, Comments::c, single ? Precision::float32 : Precision::float64);
    const auto has = [&](std::string_view declaration) {
        return bytes.find(declaration) != std::string_view::npos;
    };
    const Arithmetic arithmetic{has(c_code::svf_fields)   ? Form::svf
                                : has(c_code::df1_memory) ? Form::df1
                                                          : Form::df2t,
                                single ? Precision::float32 : Precision::float64};
    reader.expect("_BANDS ");
    const double band_count = reader.number();
    reader.expect("_SECTIONS ");
    const double section_count = reader.number();
    if (band_count != static_cast<double>(filters.bands.size()) ||
        section_count != static_cast<double>(filters.sections_per_band())) {
        reader.fail(fmt::format("{} bands of {} sections", band_count, section_count),
                    fmt::format("{} of {}", filters.bands.size(), filters.sections_per_band()));
    }
    LoadedFilters found;
    reader.expect("_bands[");
    reader.expect("= {");
    for (std::size_t b = 0; b < filters.bands.size(); ++b) {
        reader.expect("{");
        auto& sections = found.bands.emplace_back();
        for (std::size_t i = 0; i < filters.sections_per_band(); ++i) {
            sections.push_back(
                section_from(reader.numbers('{', '}', arithmetic.form == Form::svf ? 6 : 5), arithmetic));
        }
    }
    return found;
}

std::string usage(const FilterSet& filters, const Settings& settings, const std::string& path) {
    const std::string name = settings.text("name");
    return fmt::format("#include \"{1}\"   {0}_state s; {0}_init(&s); filtered = {0}_step(&s, torque_nm{2});",
                       name, path, filters.by_speed() ? ", speed_deg_s" : "");
}

}  // namespace

const Target targets::c_header = {
    .name = "c-header",
    .summary = "one C99 header: table, step function, test vector; float or double",
    .source = "A. Simper, Linear Trapezoidal Integrated State Variable Filter, 2013; C99, 6.4.4.2",
    .endings = ".h .hpp",
    .switches = true,
    .keys = keys,
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
