// SPDX-License-Identifier: MIT
// ARM's CMSIS-DSP adds a1 y1 and a2 y2, so both are negated here: the usual mistake with it.
#include <fmt/format.h>

#include <array>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> forms = {"df1", "df2t"};

constexpr std::array keys = {
    Key{.name = "form",
        .kind = KeyKind::choice,
        .default_text = "df1",
        .choices = forms,
        .help = "which of arm_biquad_cascade_df1_f32 and arm_biquad_cascade_df2T_f32 will run it"},
    name_key("ripplenotch"),
};

// Where the library loads four floats from the third of the last stage, it reads one past the stage.
constexpr std::size_t padding = 1;

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const std::string name = settings.text("name");
    check_identifier(name, "target cmsis-dsp, name");
    const bool df1 = settings.text("form") == "df1";
    const std::size_t stages = filters.sections_per_band();
    std::string text = "/*\n" + comment_lines(heading, " * ");
    text += fmt::format(
        " * Harmonic-drive ripple filter for CMSIS-DSP, {} Hz. Stages b0, b1, b2, a1, a2 for\n"
        " * arm_biquad_cascade_{}_f32, which ADDS a1 y[n-1] and a2 y[n-2]: a1 and a2 have the opposite sign "
        "of\n"
        " * SciPy's and MATLAB's. One zero stands after the last stage: some builds load one float past it.\n"
        " * State: {} floats, {} a stage.\n */\n",
        shortest(filters.sample_rate.value()), df1 ? "df1" : "df2T", stages * (df1 ? 4 : 2), df1 ? 4 : 2);
    const std::string macro = upper_case(name);
    text += fmt::format("#ifndef {0}_CMSIS_H\n#define {0}_CMSIS_H\n\n#include \"arm_math.h\"\n\n", macro);
    text += fmt::format("#define {0}_BANDS {1}\n#define {0}_STAGES {2}\n#define {0}_STATE_FLOATS {3}\n\n",
                        macro, filters.bands.size(), stages, stages * (df1 ? 4 : 2));
    if (filters.by_speed()) {
        text += "/* A band is active while from < |v| <= to, joint speed in deg/s. */\n";
        text += fmt::format(
            "static const float32_t {0}_from_deg_s[] = {{{1}}};\n"
            "static const float32_t {0}_to_deg_s[] = {{{2}}};\n\n",
            name, joined(edges(filters, &ExportBand::from), ", ", decimal_float),
            joined(edges(filters, &ExportBand::to), ", ", decimal_float));
    }
    text += fmt::format("static const float32_t {0}_coefficients[{1}_BANDS][5 * {1}_STAGES + {2}] = {{\n",
                        name, macro, padding);
    for (const ExportBand& band : filters.bands) {
        text += fmt::format("    {{ /* {} */\n", describe(band));
        for (const ExportSection& section : band.sections) {
            const Biquad& f = section.section;
            text += fmt::format("        {}, /* {} */\n",
                                joined(std::array{f.b0, f.b1, f.b2, -f.a1, -f.a2}, ", ", decimal_float),
                                describe(section));
        }
        text += "        0.0f},\n";
    }
    return {text + "};\n\n#endif\n", {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    TextReader reader(bytes, source, Comments::c, Precision::float32);
    const bool df1 = bytes.find("arm_biquad_cascade_df1_f32") != std::string_view::npos;
    const Arithmetic arithmetic{df1 ? Form::df1 : Form::df2t, Precision::float32};
    reader.expect("_coefficients[");
    reader.expect("= {");
    std::vector<double> values;
    const auto enter = [&](const ExportBand& band) {
        values = reader.numbers('{', '}', 5 * band.sections.size() + padding);
    };
    return read_bands(filters, enter, [&](std::size_t i) {
        const double* const v = values.data() + 5 * i;
        return loaded(Biquad{v[0], v[1], v[2], -v[3], -v[4]}, arithmetic);
    });
}

std::string usage(const FilterSet&, const Settings& settings, const std::string& path) {
    const std::string name = settings.text("name");
    const bool df1 = settings.text("form") == "df1";
    return fmt::format(
        "#include \"{1}\"   float32_t state[{3}_STATE_FLOATS]; arm_biquad_cascade_{2}_init_f32(&filter, "
        "{3}_STAGES, "
        "{0}_coefficients[band], state);",
        name, path, df1 ? "df1" : "df2T", upper_case(name));
}

}  // namespace

const Target targets::cmsis_dsp = {
    .name = "cmsis-dsp",
    .summary = "coefficient arrays for ARM's arm_biquad_cascade_df1_f32 and df2T_f32",
    .source = "ARM CMSIS-DSP, arm_biquad_cascade_df1_f32 and arm_biquad_cascade_df2T_f32",
    .endings = ".h .c",
    .switches = true,
    .keys = keys,
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
