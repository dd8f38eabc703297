// SPDX-License-Identifier: MIT
// Servo drives of the Panasonic MINAS and Omron G5 kind: whole hertz, a width code, a depth code.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Whether the ranges of the drive's own parameters are kept.
constexpr std::array<std::string_view, 2> limit_choices = {"firmware", "none"};
constexpr std::array keys = {Key{.name = "limits",
                                 .kind = KeyKind::choice,
                                 .default_text = "firmware",
                                 .choices = limit_choices,
                                 .help = "firmware: refuse what its own parameters cannot hold; none: for "
                                         "other firmware in this style"}};

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
            "{:.1f}; "
            "design with --q 2 or less, or filter outside the drive",
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
                    "target servo-drive makes the analogue prototype's Q, and these notches have the "
                    "digital width rule; design them with width analog");
            }
            if (!first) first = notch;
            if (notch.q != first->q || notch.depth_db != first->depth_db) {
                raise<UsageError>(
                    "target servo-drive has one width and one depth for all notches, and these differ: "
                    "Q {} and {}; export json or c-header instead",
                    shortest(first->q), shortest(notch.q));
            }
        }
    }
    return {first->q,
            first->depth_db >= infinite_depth_db ? 0.0 : portable::pow(10.0, -first->depth_db / 20.0)};
}

Written write(const FilterSet& filters, const Settings& settings, std::span<const std::string> heading) {
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
                    "filter "
                    "this line outside the drive, or use limits=none for other firmware in this style",
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

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
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
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
