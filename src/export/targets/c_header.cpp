// SPDX-License-Identifier: MIT
// One header without dependencies: tables, a step function, and a test vector to assert after pasting.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "design/switching_run.hpp"
#include "export/code/method_code.hpp"
#include "export/code/switching_code.hpp"
#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    Key{.name = "precision",
        .default_text = "float",
        .choices = "float double q31",
        .help = "type of every number: float, double, or fixed point of 32 bits"},
    Key{.name = "range",
        .dimension = Dimension::torque,
        .above = 0.0,
        .help = "of fixed point: the torque of the largest word"},
    Key{.name = "form",
        .choices = "svf df1 df2t",
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

std::string bands_text(const FilterSet& filters, const CodeStyle& style, Arithmetic arithmetic,
                       LoadedFilters& loaded_filters) {
    std::string text;
    for (const ExportBand& band : filters.bands) {
        text += fmt::format("    {{ /* {} */\n", describe(band));
        auto& sections = loaded_filters.bands.emplace_back();
        for (const ExportSection& section : band.sections) {
            const auto values = values_of(section, filters.sample_rate, arithmetic);
            std::string literals = joined(values, ", ", style.literal()), decimals;
            sections.push_back(section_from(values, arithmetic));
            if (is_fixed(arithmetic.precision)) {
                std::vector<double> words;
                literals.clear();
                decimals = fmt::format("        /* {} */\n", joined(values, ", ", shortest));
                for (const FixedCoefficient& c : fixed_coefficients(sections.back().svf)) {
                    literals +=
                        fmt::format("{}{{{}, {}}}", literals.empty() ? "" : ", ", c.mantissa, c.shift);
                    words.insert(words.end(),
                                 {static_cast<double>(c.mantissa), static_cast<double>(c.shift)});
                }
                sections.back() = section_from_fixed(words, arithmetic);
            }
            text +=
                fmt::format("        /* {} */\n        {{{}}},\n{}", describe(section), literals, decimals);
        }
        text += "    },\n";
    }
    return text;
}

std::string fixed_speed(double speed) { return std::to_string(std::llround(speed * fixed_speed_steps)); }

std::string regions_text(const std::vector<SpeedRegion>& regions, const CodeSpeed& unit,
                         std::string (*literal)(double)) {
    std::string text;
    for (const SpeedRegion& region : regions) {
        // Nothing is faster than the last region, so its edge is never used.
        const double to = std::isinf(region.to_deg_s) ? 0.0 : region.to_deg_s;
        const std::string edge = std::isinf(region.to_deg_s)
                                     ? "and faster"
                                     : fmt::format("|v| <= {} {}", shortest(region.to_deg_s), unit.unit);
        const std::string rule = region.holds ? "the active band stays"
                                 : region.candidate == no_candidate
                                     ? "the torque passes"
                                     : fmt::format("band {}", region.candidate + 1);
        const std::string fade = region.fades() ? ", fading" : "";
        text += fmt::format("    {{{}, {}, {}, {}}}, /* {}: {}{} */\n", literal(to), region.code(),
                            literal(region.full_deg_s), literal(region.none_deg_s), edge, rule, fade);
    }
    return text;
}

std::string golden_text(const GoldenVector& golden, const CodeStyle& style, const Arithmetic& arithmetic) {
    std::string text;
    for (std::size_t k = 0; k < golden.torque_nm.size(); ++k) {
        const std::array row = {golden.torque_nm[k], golden.speed_deg_s[k], golden.expected_nm[k]};
        if (is_fixed(arithmetic.precision))
            text +=
                fmt::format("    {{{}, {}, {}}}, /* {} */\n", fixed_word(row[0], arithmetic),
                            fixed_speed(row[1]), fixed_word(row[2], arithmetic), joined(row, ", ", shortest));
        else
            text += fmt::format("    {{{}}},\n", joined(row, ", ", style.literal()));
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
        return text + " * Literals have the digits that give back every bit.\n */\n";
    return text + fmt::format(
                      " * {} Nm at full scale, a word's last place is {:.3g} Nm; {} bits of headroom; on the "
                      "test vector rounding\n * makes {:.2g} Nm rms.\n */\n",
                      shortest(arithmetic.full_scale_nm), fixed_torque_nm(1, arithmetic),
                      arithmetic.headroom_bits, golden.rounding_rms_nm);
}

// The sizes and rules that the runtime counts by.
std::string definitions(const FilterSet& filters, const std::string& speed_words, std::size_t regions,
                        const std::string& hysteresis) {
    std::string text = fmt::format("#define RN_BANDS {}\n#define RN_SECTIONS {}\n", filters.bands.size(),
                                   filters.sections_per_band());
    if (!filters.by_speed()) return text;
    const SwitchingDesign& design = filters.switching;
    const bool parallel = runs_all_bands(design);
    return text +
           fmt::format(
               "#define RN_REGIONS {}\n"
               "#define RN_HYSTERESIS {} /* {}: a region is left only so far outside it */\n"
               "#define RN_DWELL {} /* samples that a filter stays active at least */\n"
               "#define RN_CROSSFADE {} /* samples over which outputs are blended */\n"
               "#define RN_PARALLEL {} /* 1: all bands run side by side; 0: one cascade changes its band */\n"
               "#define RN_CASCADES {}\n#define RN_OUTPUTS {}\n",
               regions, hysteresis, speed_words, design.dwell_samples, crossfade_samples(design),
               parallel ? 1 : 0, parallel ? "RN_BANDS" : "1", parallel ? "(RN_BANDS + 1)" : "1");
}

std::string arithmetic_text(const Arithmetic& arithmetic) {
    if (!is_fixed(arithmetic.precision))
        return fmt::format("\ntypedef {} rn_real;\n{}",
                           arithmetic.precision == Precision::float32 ? "float" : "double",
                           runtime_text::floating);
    return fmt::format(
        "#define RN_FULL_SCALE_NM {} /* the torque of a word one larger than the largest */\n"
        "#define RN_HEADROOM {} /* bits of a signal above a word, for what is larger inside of a filter */\n"
        "#define RN_FRACTION (16 - RN_HEADROOM)\n\n#include <stdint.h>\n{}",
        shortest(arithmetic.full_scale_nm), arithmetic.headroom_bits, runtime_text::fixed);
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const CodeStyle style = style_of(settings);
    const Arithmetic arithmetic = arithmetic_of(filters, settings);
    const bool fixed = is_fixed(arithmetic.precision);
    const CodeSpeed speed = speed_of(filters, settings);
    const std::string speed_words = (fixed ? "thousandths of " : "") + speed.unit;
    const FilterSet scaled = in_unit(filters, speed.per_deg_s);
    const auto regions = switching_regions(scaled);
    const double hysteresis = scaled.switching.hysteresis.value();
    LoadedFilters held;
    const std::string bands = "static const rn_section rn_bands[RN_BANDS][RN_SECTIONS] = {\n" +
                              bands_text(filters, style, arithmetic, held) + "};\n";
    const GoldenVector golden = golden_vector(scaled, held);

    std::string text = fmt::format("#ifndef RN_H\n#define RN_H\n\n#define RN_SAMPLE_RATE_HZ {}\n",
                                   style.number(filters.sample_rate.value()));
    text += definitions(filters, speed_words, regions.size(),
                        fixed ? fixed_speed(hysteresis) : style.number(hysteresis)) +
            arithmetic_text(arithmetic);
    text += arithmetic.form == Form::svf   ? runtime_text::svf
            : arithmetic.form == Form::df1 ? runtime_text::df1
                                           : runtime_text::df2t;
    text += runtime_text::cascade;
    std::string self_test(runtime_text::self_test);
    if (filters.by_speed()) {
        const std::string rows = regions_text(regions, speed, fixed ? fixed_speed : style.literal());
        text +=
            with_tables(runtime_text::switching,
                        fmt::format("\n{}\n/* slowest first; the {} speed in {} */\nstatic const rn_region "
                                    "rn_regions[RN_REGIONS] = {{\n{}}};\n",
                                    bands, speed.side, speed_words, rows));
        text = filled(text, {{"speed_deg_s", (fixed ? "milli_" : "") + speed.name}});
    } else {
        text += "\n" + bands + std::string(runtime_text::single);
        self_test = filled(self_test, {{", (rn_speed)rn_golden[k][1]", ""}});
    }
    text += fmt::format(
        "\n#ifdef RN_SELF_TEST\n#define RN_GOLDEN {}\n#define RN_GOLDEN_TOLERANCE{} {}\n\n"
        "/* torque, {} speed in {}, filtered torque */\nstatic const rn_signal rn_golden[RN_GOLDEN][3] = {{\n"
        "{}}};\n{}\n#endif\n",
        golden.torque_nm.size(), fixed ? "" : "_NM",
        fixed            ? "0"
        : style.is_float ? "1e-4f"
                         : "1e-9",
        speed.side, speed_words, golden_text(golden, style, arithmetic), self_test);
    return {"/*\n" + comment_lines(heading, " * ") + about(filters, arithmetic, golden) + style.filled(text),
            {}};
}

constexpr std::string_view svf_fields = "a1, a2, a3, m0, m1, m2;", df1_memory = "x1, x2, y1, y2;";

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
    .source = "A. Simper, Linear Trapezoidal Integrated State Variable Filter, 2013",
    .endings = ".h .hpp",
    .switches = true,
    .runs_supervisor = true,
    .keys = keys,
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
