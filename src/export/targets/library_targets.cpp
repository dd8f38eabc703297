// SPDX-License-Identifier: MIT
// Targets that a library, a node or a drive takes: CMSIS-DSP, ROS, servo drives.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

// ARM's CMSIS-DSP adds a1 y1 and a2 y2, so both are negated here: the usual mistake with it.

constexpr std::array cmsis_keys = {
    Key{.name = "form",
        .default_text = "df1",
        .choices = "df1 df2t",
        .help = "which of arm_biquad_cascade_df1_f32 and arm_biquad_cascade_df2T_f32 will run it"},
    name_key("ripplenotch"),
};

// Where the library loads four floats from the third of the last stage, it reads one past the stage.
constexpr std::size_t cmsis_padding = 1;

Written cmsis_write(const FilterSet& filters, const Settings& settings,
                    std::span<const std::string> heading) {
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
                        name, macro, cmsis_padding);
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

LoadedFilters cmsis_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                         const Settings&) {
    TextReader reader(bytes, source, Comments::c, Precision::float32);
    const bool df1 = bytes.find("arm_biquad_cascade_df1_f32") != std::string_view::npos;
    const Arithmetic arithmetic{df1 ? Form::df1 : Form::df2t, Precision::float32};
    reader.expect("_coefficients[");
    reader.expect("= {");
    std::vector<double> values;
    const auto enter = [&](const ExportBand& band) {
        values = reader.numbers('{', '}', 5 * band.sections.size() + cmsis_padding);
    };
    return read_bands(filters, enter, [&](std::size_t i) {
        const double* const v = values.data() + 5 * i;
        return loaded(Biquad{v[0], v[1], v[2], -v[3], -v[4]}, arithmetic);
    });
}

std::string cmsis_usage(const FilterSet&, const Settings& settings, const std::string& path) {
    const std::string name = settings.text("name");
    const bool df1 = settings.text("form") == "df1";
    return fmt::format(
        "#include \"{1}\"   float32_t state[{3}_STATE_FLOATS]; arm_biquad_cascade_{2}_init_f32(&filter, "
        "{3}_STAGES, {0}_coefficients[band], state);",
        name, path, df1 ? "df1" : "df2T", upper_case(name));
}

}  // namespace

const Target targets::cmsis_dsp = {
    .name = "cmsis-dsp",
    .summary = "coefficient arrays for ARM's arm_biquad_cascade_df1_f32 and df2T_f32",
    .source = "ARM CMSIS-DSP, arm_biquad_cascade_df1_f32 and arm_biquad_cascade_df2T_f32",
    .endings = ".h .c",
    .switches = true,
    .keys = cmsis_keys,
    .write = cmsis_write,
    .read = cmsis_read,
    .usage = cmsis_usage,
};

namespace {

// The ROS package `filters`: one transfer function a section, in a filter chain. It does not depend on the
// joint speed.

constexpr std::array ros_keys = {
    Key{.name = "channels",
        .default_text = "multi",
        .choices = "multi single",
        .help = "multi: MultiChannelFilterChain; single: FilterChain, as chained_filter_controller has it"},
    Key{.name = "node",
        .kind = KeyKind::text,
        .default_text = "torque_filter",
        .help = "the node or controller whose parameters these are"},
};

std::string type_of(const Settings& settings) {
    return settings.text("channels") == "multi" ? "filters/MultiChannelTransferFunctionFilterDouble"
                                                : "filters/TransferFunctionFilterDouble";
}

Written ros_write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
    const ExportBand& band = only_band(filters, "ros-filters");
    check_identifier(settings.text("node"), "target ros-filters, node");
    std::string text = comment_lines(heading, "# ");
    text += fmt::format(
        "# {}, designed for {} Hz; runs at every speed.\n"
        "# y[n] = b0 x[n] + b1 x[n-1] + b2 x[n-2] - a1 y[n-1] - a2 y[n-2]; a begins with a0 = 1.\n",
        describe(band), shortest(filters.sample_rate.value()));
    text += settings.text("node") + ":\n  ros__parameters:\n    filter_chain:\n";
    for (std::size_t i = 0; i < band.sections.size(); ++i) {
        const Biquad& f = band.sections[i].section;
        text += fmt::format(
            "      filter{0}:  # {1}\n        name: ripple_{0}\n        type: {2}\n        params:\n", i + 1,
            describe(band.sections[i]), type_of(settings));
        text += fmt::format("          a: [{}]\n          b: [{}]\n",
                            joined(std::array{1.0, f.a1, f.a2}, ", ", decimal),
                            joined(std::array{f.b0, f.b1, f.b2}, ", ", decimal));
    }
    return {text, {}};
}

LoadedFilters ros_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                       const Settings&) {
    TextReader reader(bytes, source, Comments::hash, Precision::float64);
    return read_bands(
        filters, [](const ExportBand&) {},
        [&](std::size_t) {
            reader.expect("TransferFunctionFilterDouble");
            reader.expect("a:");
            const auto a = reader.numbers('[', ']', 3);
            if (a[0] != 1.0) reader.fail(shortest(a[0]), "a0 of 1");
            reader.expect("b:");
            const auto b = reader.numbers('[', ']', 3);
            return loaded(Biquad{b[0], b[1], b[2], a[1], a[2]}, {Form::df1, Precision::float64});
        });
}

}  // namespace

const Target targets::ros_filters = {
    .name = "ros-filters",
    .summary = "YAML for the ROS package filters; one band, for it does not follow the speed",
    .source = "ros/filters, transfer_function.hpp; ros2_controllers, chained_filter_controller",
    .endings = ".yaml .yml",
    .keys = ros_keys,
    .write = ros_write,
    .read = ros_read,
};

namespace {

// Servo drives of the Panasonic MINAS and Omron G5 kind: whole hertz, a width code, a depth code.

// Whether the ranges of the drive's own parameters are kept.
constexpr std::array drive_keys = {Key{
    .name = "limits",
    .default_text = "firmware",
    .choices = "firmware none",
    .help = "firmware: refuse what its own parameters cannot hold; none: for other firmware in this style"}};

// Width over centre is 0.5 * 2^(code / 4), code 0 to 20: from Q 2 down to Q 1/16. Depth code d is a gain of d
// per cent at the centre; 0 is a complete null.
constexpr double sharpest_q = 2.0;
constexpr double widest_q = 1.0 / 16.0;
constexpr double lowest_hz = 50.0, highest_hz = 4999.0;  // 5000 turns the notch off

double q_of_width(double code) { return sharpest_q / portable::exp2(code / 4.0); }
double gain_of_depth(double code) { return code / 100.0; }

int width_code(double q) {
    // A tenth of a code step is as good as exact.
    const double code = 4.0 * portable::log2(sharpest_q / q);
    if (code < -0.1) {
        raise<UsageError>(
            "the drive cannot hold Q {}: its narrowest width code is 0, half the centre, and the sharpest Q "
            "{:.1f}; design with --q 2 or less, or filter outside the drive",
            shortest(q), sharpest_q);
    }
    if (code > 20.1) {
        raise<UsageError>(
            "the drive cannot hold Q {}: its widest width code is 20, Q {}; design with a higher --q",
            shortest(q), widest_q);
    }
    return static_cast<int>(std::round(code));
}

// The common shape of all notches: the drive has one width and one depth for all.
struct SharedShape {
    double q = 1.0;
    double gain = 0.0;  ///< at the centre; 0 for a full null
};

// Throws UsageError for low-passes, for Q or depth that differ, and for the digital width rule, whose notches
// are no analogue prototypes.
SharedShape shared_shape(const FilterSet& filters) {
    std::optional<NotchSpec> first;
    for (const ExportBand& band : filters.bands) {
        for (const ExportSection& section : band.sections) {
            if (!section.notch) {
                const auto both = targets_that(&Target::notches_only, false);
                const auto last = both.end() - 1;
                raise<UsageError>(
                    "target servo-drive holds notches only, not a low-pass; {} and {} hold both",
                    fmt::join(both.begin(), last, ", "), *last);
            }
            const NotchSpec& notch = *section.notch;
            if (notch.width == WidthRule::digital) {
                raise<UsageError>(
                    "target servo-drive makes the analogue prototype's Q, and these notches have the digital "
                    "width rule; design them with width analog");
            }
            if (!first) first = notch;
            if (notch.q != first->q || notch.depth_db != first->depth_db) {
                raise<UsageError>(
                    "target servo-drive has one width and one depth for all notches, and these differ: Q {} "
                    "and {}; export json or c-header instead",
                    shortest(first->q), shortest(notch.q));
            }
        }
    }
    return {first->q,
            first->depth_db >= infinite_depth_db ? 0.0 : portable::pow(10.0, -first->depth_db / 20.0)};
}

Written drive_write(const FilterSet& filters, const Settings& settings,
                    std::span<const std::string> heading) {
    const SharedShape shape = shared_shape(filters);
    const int width = width_code(shape.q);
    const int depth = static_cast<int>(std::round(100.0 * shape.gain));
    Written written;
    written.bytes = comment_lines(heading, "# ");
    written.bytes +=
        "# Width code w: -3 dB width over centre is 0.5 * 2^(w/4). Depth code d: d per cent is left at the "
        "centre.\n";
    if (filters.by_speed()) {
        written.bytes +=
            "# The drive does not follow the speed: the application has to write these at run time.\n";
    }
    written.bytes += "band,speed_from_deg_s,speed_to_deg_s,notch,frequency_hz,width_code,depth_code\n";
    for (const ExportBand& band : filters.bands) {
        for (std::size_t i = 0; i < band.sections.size(); ++i) {
            const double center = band.sections[i].center.value();
            if (settings.text("limits") != "none" && !(center >= lowest_hz && center <= highest_hz)) {
                raise<UsageError>(
                    "the drive's notch frequency of {} would be {:.4g}, and the firmware takes {} to {}; "
                    "filter this line outside the drive, or use limits=none for other firmware in this style",
                    describe(band.sections[i]), center, shortest(lowest_hz), shortest(highest_hz));
            }
            const double whole = std::max(1.0, std::round(center));
            if (whole != center) {
                written.warnings.push_back(fmt::format("{}: {} Hz is {} Hz in the drive", describe(band),
                                                       shortest(center), shortest(whole)));
            }
            written.bytes += fmt::format("{},{},{},{},{},{},{}\n", band.number, shortest(band.from.value()),
                                         shortest(band.to.value()), i + 1, shortest(whole), width, depth);
        }
    }
    const double held_q = q_of_width(width);
    if (std::abs(held_q / shape.q - 1.0) > 0.005) {
        written.warnings.push_back(
            fmt::format("Q {} is Q {:.3g} in the drive (width code {})", shortest(shape.q), held_q, width));
    }
    if (std::abs(gain_of_depth(depth) - shape.gain) > 1e-12) {
        written.warnings.push_back(fmt::format("a depth of {:.3g} dB is depth code {} in the drive",
                                               -20.0 * portable::log10(shape.gain), depth));
    }
    return written;
}

LoadedFilters drive_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                         const Settings&) {
    TextReader reader(bytes, source, Comments::hash, Precision::float64);
    reader.expect("depth_code\n");
    const ExportBand* in = nullptr;
    const auto enter = [&](const ExportBand& band) { in = &band; };
    return read_bands(filters, enter, [&](std::size_t i) {
        for (const double expected : {static_cast<double>(in->number), in->from.value(), in->to.value(),
                                      static_cast<double>(i + 1)}) {
            const double value = reader.number();
            if (value != expected) reader.fail(shortest(value), shortest(expected));
        }
        const Hertz center(reader.number());
        const double q = q_of_width(reader.number());
        const double gain = gain_of_depth(reader.number());
        const NotchSpec notch{center, q, gain > 0.0 ? -20.0 * portable::log10(gain) : infinite_depth_db};
        // How a drive computes is not published; its filter is taken as exact.
        return loaded(design_notch(notch, filters.sample_rate), {Form::df2t, Precision::float64});
    });
}

}  // namespace

const Target targets::servo_drive = {
    .name = "servo-drive",
    .summary = "frequency, width code and depth code of Panasonic MINAS and Omron G5 drives",
    .source =
        "Omron G5 user's manual, 6, Notch Filter Width and Depth; Panasonic MINAS A5, notch width and depth",
    .endings = ".csv .txt",
    .notches_only = true,
    .keys = drive_keys,
    .write = drive_write,
    .read = drive_read,
};

}  // namespace ripplenotch
