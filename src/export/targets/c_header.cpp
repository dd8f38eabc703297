// SPDX-License-Identifier: MIT
// One header without dependencies: tables, a step function, and a test vector to assert after pasting.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/code/method_code.hpp"
#include "export/code/switching_code.hpp"
#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 3> precisions = {"float", "double", "q31"};
constexpr std::array<std::string_view, 3> forms = {"svf", "df1", "df2t"};
constexpr std::array keys = {
    Key{.name = "precision",
        .kind = KeyKind::choice,
        .default_text = "float",
        .choices = precisions,
        .help = "type of every number: float, double, or fixed point of 32 bits"},
    Key{.name = "range",
        .dimension = Dimension::torque,
        .above = 0.0,
        .help = "of fixed point: the torque of the largest word"},
    Key{.name = "form",
        .kind = KeyKind::choice,
        .choices = forms,
        .help = "svf: state-variable; df1: direct form I; df2t: transposed direct form II (default: svf)"},
    speed_unit_key,
    speed_side_key,
    name_key("ripplenotch"),
};

// keep-state-variable keeps the memory of its own form: another would run otherwise than its preview.
Form form_of(const FilterSet& filters, const Settings& settings) {
    const std::string asked = settings.has("form") ? settings.text("form") : "";
    const Form form = asked == "df1" ? Form::df1 : asked == "df2t" ? Form::df2t : Form::svf;
    if (form != Form::svf && filters.by_speed() && !runs_all_bands(filters.switching)) {
        raise<UsageError>(
            "target c-header: form={} does not run as transition={} is previewed, whose form is svf; take "
            "--method switching,table=...,transition=parallel",
            asked, filters.switching.transition);
    }
    return form;
}

Arithmetic arithmetic_of(const FilterSet& filters, const Settings& settings) {
    const std::string precision = settings.text("precision");
    Arithmetic found{form_of(filters, settings), precision == "float"    ? Precision::float32
                                                 : precision == "double" ? Precision::float64
                                                                         : Precision::q31};
    if (!is_fixed(found.precision)) {
        if (settings.has("range")) raise<UsageError>("target c-header: range is for precision=q31");
        return found;
    }
    if (!settings.has("range"))
        raise<UsageError>(
            "target c-header: precision={} needs the torque of the largest word, for example range=200Nm",
            precision);
    if (found.form != Form::svf)
        raise<UsageError>(
            "target c-header: fixed point is written in the state-variable form alone; leave form out");
    found.full_scale_nm = settings.number("range");
    found.headroom_bits = headroom_bits(filters);
    return found;
}

CodeSpeed speed_of(const FilterSet& filters, const Settings& settings) {
    constexpr GearRatio any_ratio{2.0};  // no band is chosen by a speed
    return code_speed(settings, filters.gear_ratio.value_or(any_ratio).value());
}

/// The same filters with all speeds in the code's unit.
FilterSet in_unit(FilterSet filters, double per_deg_s) {
    for (ExportBand& band : filters.bands) {
        band.from = per_deg_s * band.from;
        band.to = per_deg_s * band.to;
    }
    filters.switching.hysteresis = per_deg_s * filters.switching.hysteresis;
    return filters;
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
    if (arithmetic.precision == Precision::float32)
        std::transform(values.begin(), values.end(), values.begin(), as_float);
    return values;
}

LoadedSection section_from(const std::vector<double>& v, Arithmetic arithmetic) {
    if (arithmetic.form == Form::svf)
        return {arithmetic,
                biquad_of({v[0], v[1], v[2], v[3], v[4], v[5]}),
                {v[0], v[1], v[2], v[3], v[4], v[5]}};
    return loaded(Biquad{v[0], v[1], v[2], v[3], v[4]}, arithmetic);
}

// Mantissa and shift of each coefficient, and the section that they are.
LoadedSection section_from_fixed(const std::vector<double>& words, Arithmetic arithmetic) {
    std::vector<double> values;
    for (std::size_t i = 0; i + 1 < words.size(); i += 2)
        values.push_back(
            FixedCoefficient{static_cast<std::int32_t>(words[i]), static_cast<int>(words[i + 1])}.value());
    values[3] += 1.0;
    return section_from(values, arithmetic);
}

/// A literal that is exact, and the number as people read it.
struct Writer {
    std::string (*exact)(double);
    std::string (*readable)(double);
};
constexpr Writer in_double = {hexadecimal, shortest};
constexpr Writer in_float = {hexadecimal_float,
                             [](double value) { return fmt::format("{:.9g}", static_cast<float>(value)); }};

std::string bands_text(const FilterSet& filters, const Writer& writer, Arithmetic arithmetic,
                       LoadedFilters& loaded_filters) {
    std::string text;
    for (const ExportBand& band : filters.bands) {
        text += fmt::format("    {{ /* {} */\n", describe(band));
        auto& sections = loaded_filters.bands.emplace_back();
        for (const ExportSection& section : band.sections) {
            const auto values = values_of(section, filters.sample_rate, arithmetic);
            std::string literals = joined(values, ", ", writer.exact);
            sections.push_back(section_from(values, arithmetic));
            if (is_fixed(arithmetic.precision)) {
                std::vector<double> words;
                literals.clear();
                for (const FixedCoefficient& c : fixed_coefficients(sections.back().svf)) {
                    literals +=
                        fmt::format("{}{{{}, {}}}", literals.empty() ? "" : ", ", c.mantissa, c.shift);
                    words.insert(words.end(),
                                 {static_cast<double>(c.mantissa), static_cast<double>(c.shift)});
                }
                sections.back() = section_from_fixed(words, arithmetic);
            }
            text += fmt::format("        /* {} */\n        {{{}}},\n        /* {} */\n", describe(section),
                                literals, joined(values, ", ", writer.readable));
        }
        text += "    },\n";
    }
    return text;
}

std::string fixed_speed(double speed) { return std::to_string(std::llround(speed * fixed_speed_steps)); }

std::string regions_text(const std::vector<SwitchingRegion>& regions, const CodeSpeed& unit,
                         std::string (*literal)(double)) {
    std::string text;
    for (const SwitchingRegion& region : regions) {
        // Nothing is faster than the last region, so its edge is never used.
        const double to = std::isinf(region.to_deg_s) ? 0.0 : region.to_deg_s;
        const std::string edge = std::isinf(region.to_deg_s)
                                     ? "and faster"
                                     : fmt::format("|v| <= {} {}", shortest(region.to_deg_s), unit.unit);
        const std::string rule = region.band == region_passes  ? "the torque passes"
                                 : region.band == region_holds ? "the active band stays"
                                                               : fmt::format("band {}", region.band + 1);
        const std::string fade = region.full_deg_s != region.none_deg_s ? ", fading" : "";
        text += fmt::format("    {{{}, {}, {}, {}}}, /* {}: {}{} */\n", literal(to), region.band,
                            literal(region.full_deg_s), literal(region.none_deg_s), edge, rule, fade);
    }
    return text;
}

std::string golden_text(const GoldenVector& golden, const Writer& writer, const Arithmetic& arithmetic) {
    std::string text;
    for (std::size_t k = 0; k < golden.torque_nm.size(); ++k) {
        const std::array row = {golden.torque_nm[k], golden.speed_deg_s[k], golden.expected_nm[k]};
        const std::string literals = is_fixed(arithmetic.precision)
                                         ? fmt::format("{}, {}, {}", fixed_word(row[0], arithmetic),
                                                       fixed_speed(row[1]), fixed_word(row[2], arithmetic))
                                         : joined(row, ", ", writer.exact);
        text += fmt::format("    {{{}}}, /* {} */\n", literals, joined(row, ", ", writer.readable));
    }
    return text;
}

// What the header is, for whoever reads it first.
std::string about(const FilterSet& filters, const Arithmetic& arithmetic, const GoldenVector& golden) {
    std::string text =
        fmt::format(" * Harmonic-drive ripple filter, {}: {} of {} for {} Hz.\n", arithmetic_name(arithmetic),
                    how_many(filters.bands.size(), "band"), how_many(filters.sections_per_band(), "section"),
                    shortest(filters.sample_rate.value()));
    if (filters.by_speed()) {
        const SwitchingDesign& design = filters.switching;
        text += fmt::format(
            " * transition={}, hysteresis={}deg/s, dwell={}: the same as ripplenotch filter --method "
            "switching with these keys.\n",
            design.transition, shortest(design.hysteresis.value()), how_many(design.dwell_samples, "sample"));
    }
    if (!is_fixed(arithmetic.precision))
        return text + " * Literals are exact; the comment below each row has them in decimal.\n */\n";
    return text + fmt::format(
                      " * {} Nm at full scale, a word's last place is {:.3g} Nm; {} bits of headroom; on the "
                      "test vector rounding\n * makes {:.2g} Nm rms.\n */\n",
                      shortest(arithmetic.full_scale_nm), fixed_torque_nm(1, arithmetic),
                      arithmetic.headroom_bits, golden.rounding_rms_nm);
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const CodeStyle style = style_of(settings);
    const Arithmetic arithmetic = arithmetic_of(filters, settings);
    const bool fixed = is_fixed(arithmetic.precision);
    const CodeSpeed speed = speed_of(filters, settings);
    const FilterSet scaled = in_unit(filters, speed.per_deg_s);
    const Writer& writer = style.is_float ? in_float : in_double;
    const auto regions = switching_regions(scaled);
    LoadedFilters held;
    const std::string bands = bands_text(filters, writer, arithmetic, held);
    const GoldenVector golden = golden_vector(scaled, held);
    const SwitchingCode code(arithmetic, filters);

    std::string text = about(filters, arithmetic, golden) + code.declarations();
    text +=
        "static const @name@_section @name@_bands[@NAME@_BANDS][@NAME@_SECTIONS] = {\n" + bands + "};\n\n";
    if (filters.by_speed())
        text +=
            code.regions_open() + regions_text(regions, speed, fixed ? fixed_speed : writer.exact) + "};\n\n";
    text += code.section_functions() + code.step_function() + code.self_test_open() +
            golden_text(golden, writer, arithmetic) + "};\n\n" + code.self_test_function() + "#endif\n";
    const double hysteresis = scaled.switching.hysteresis.value();
    text = filled(text, {{"@rate@", style.number(filters.sample_rate.value())},
                         {"@bands@", std::to_string(filters.bands.size())},
                         {"@sections@", std::to_string(filters.sections_per_band())},
                         {"@regions@", std::to_string(regions.size())},
                         {"@golden@", std::to_string(golden.torque_nm.size())},
                         {"@hysteresis@", fixed ? fixed_speed(hysteresis) : style.number(hysteresis)},
                         {"@dwell@", std::to_string(filters.switching.dwell_samples)},
                         {"@crossfade@", std::to_string(filters.switching.crossfade_samples)},
                         {"@full-scale@", shortest(arithmetic.full_scale_nm)},
                         {"@headroom@", std::to_string(arithmetic.headroom_bits)},
                         {"@unused@", std::to_string(unused_bits)},
                         {"@golden-type@", fixed            ? "int64_t"
                                           : style.is_float ? "float"
                                                            : "double"},
                         {"@speed@", fixed ? "int32_t" : "@name@_real"},
                         {"@speed-unit@", speed.unit},
                         {"@speed-words@", fixed ? "thousandths of " + speed.unit : speed.unit},
                         {"@speed-name@", fixed ? "milli_" + speed.name : speed.name},
                         {"@shaft@", speed.side},
                         {"@tolerance@", fixed            ? "0"
                                         : style.is_float ? "1e-4f"
                                                          : "1e-9"}});
    return {"/*\n" + comment_lines(heading, " * ") + style.filled(text), {}};
}

// The file itself states in which type and form it computes.
Arithmetic arithmetic_in(std::string_view bytes, TextReader& reader) {
    const auto has = [&](std::string_view declaration) {
        return bytes.find(declaration) != std::string_view::npos;
    };
    Arithmetic found{has(svf_fields)   ? Form::svf
                     : has(df1_memory) ? Form::df1
                                       : Form::df2t,
                     has("typedef float ")    ? Precision::float32
                     : has("typedef double ") ? Precision::float64
                                              : Precision::q31};
    if (!is_fixed(found.precision)) return found;
    reader.expect("_FULL_SCALE_NM ");
    found.full_scale_nm = reader.number();
    reader.expect("_HEADROOM ");
    found.headroom_bits = static_cast<int>(reader.number());
    return found;
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    const bool single = bytes.find("typedef float ") != std::string_view::npos;
    TextReader reader(bytes, source, Comments::c, single ? Precision::float32 : Precision::float64);
    reader.expect("_BANDS ");
    const double band_count = reader.number();
    reader.expect("_SECTIONS ");
    const double section_count = reader.number();
    if (band_count != static_cast<double>(filters.bands.size()) ||
        section_count != static_cast<double>(filters.sections_per_band())) {
        reader.fail(fmt::format("{} bands of {} sections", band_count, section_count),
                    fmt::format("{} of {}", filters.bands.size(), filters.sections_per_band()));
    }
    const Arithmetic arithmetic = arithmetic_in(bytes, reader);
    reader.expect("_bands[");
    reader.expect("= {");
    const auto enter = [&](const ExportBand&) { reader.expect("{"); };
    return read_bands(filters, enter, [&](std::size_t) {
        if (!is_fixed(arithmetic.precision))
            return section_from(reader.numbers('{', '}', arithmetic.form == Form::svf ? 6 : 5), arithmetic);
        std::vector<double> words;
        reader.expect("{");
        for (int i = 0; i < 6; ++i) {
            const auto pair = reader.numbers('{', '}', 2);
            words.insert(words.end(), pair.begin(), pair.end());
        }
        reader.expect("}");
        return section_from_fixed(words, arithmetic);
    });
}

std::string usage(const FilterSet& filters, const Settings& settings, const std::string& path) {
    const std::string name = settings.text("name");
    return fmt::format("#include \"{1}\"   {0}_state s; {0}_init(&s); filtered = {0}_step(&s, torque{2});",
                       name, path, filters.by_speed() ? ", " + speed_of(filters, settings).name : "");
}

}  // namespace

const Target targets::c_header = {
    .name = "c-header",
    .summary = "one C99 header: table, step function, test vector; float, double or fixed point",
    .source = "A. Simper, Linear Trapezoidal Integrated State Variable Filter, 2013; C99, 6.4.4.2",
    .endings = ".h .hpp",
    .switches = true,
    .runs_supervisor = true,
    .keys = keys,
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
