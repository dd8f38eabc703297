// SPDX-License-Identifier: MIT
// Targets that programs of one's own read: JSON, NumPy arrays, MATLAB.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

namespace {

// The filters as plain JSON, for programs of one's own: everything the other targets round, unrounded.

std::string list_of(const Biquad& f) {
    return "[" + joined(std::array{f.b0, f.b1, f.b2, 1.0, f.a1, f.a2}, ", ", decimal) + "]";
}

std::string list_of(const SvfSection& s) {
    return "[" + joined(std::array{s.a1, s.a2, s.a3, s.m0, s.m1, s.m2}, ", ", decimal) + "]";
}

std::string json_section_text(const ExportSection& section, Hertz sample_rate) {
    const auto or_null = [](bool known, double value) {
        return known ? decimal(value) : std::string("null");
    };
    const NotchSpec notch = section.notch.value_or(NotchSpec{});
    const bool is_notch = section.notch.has_value();
    return fmt::format(
        "        {{\"kind\": \"{}\", \"order\": {}, \"center_hz\": {}, \"q\": {}, \"depth_db\": {},\n"
        "         \"sos\": {},\n         \"svf\": {}}}",
        is_notch ? "notch" : "low-pass", section.order ? decimal(section.order->value()) : "null",
        decimal(section.center.value()), or_null(is_notch, notch.q),
        or_null(is_notch && notch.depth_db < infinite_depth_db, notch.depth_db), list_of(section.section),
        list_of(svf_of(section, sample_rate)));
}

std::string json_band_text(const ExportBand& band, const FilterSet& filters) {
    std::string text = "    {";
    if (filters.by_speed()) {
        text += fmt::format("\"number\": {}, \"speed_from_deg_s\": {}, \"speed_to_deg_s\": {}, ", band.number,
                            decimal(band.from.value()), decimal(band.to.value()));
    }
    text += "\"sections\": [\n";
    text += joined(band.sections, ",\n",
                   [&](const ExportSection& one) { return json_section_text(one, filters.sample_rate); });
    return text + "\n    ]}";
}

Written json_write(const FilterSet& filters, const Settings&, std::span<const std::string> heading) {
    std::string text = fmt::format(
        "{{\n  \"schema\": \"ripplenotch/filters/1\",\n  \"tool\": \"{}\",\n  \"version\": \"{}\",\n  "
        "\"made\": [",
        tool_name, version());
    text += joined(heading, ", ", in_quotes);
    text += fmt::format("],\n  \"sample_rate_hz\": {},\n", decimal(filters.sample_rate.value()));
    if (filters.by_speed()) {
        text += fmt::format(
            "  \"gear_ratio\": {},\n  \"below_first_band\": \"{}\",\n  \"above_last_band\": \"{}\",\n"
            "  \"transition\": \"{}\",\n  \"hysteresis_deg_s\": {},\n  \"dwell_samples\": {},\n  "
            "\"crossfade_samples\": {},\n",
            *filters.gear_ratio == no_ratio ? "null" : decimal(filters.gear_ratio->value()),
            outside_rule_name(filters.switching.below), outside_rule_name(filters.switching.above),
            filters.switching.transition, decimal(filters.switching.hysteresis.value()),
            filters.switching.dwell_samples, filters.switching.crossfade_samples);
    }
    text +=
        "  \"sos_layout\": \"b0 b1 b2 1 a1 a2: y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2\",\n"
        "  \"svf_layout\": \"a1 a2 a3 m0 m1 m2: v3 = x - s2, v1 = a1 s1 + a2 v3, v2 = s2 + a2 s1 + a3 v3, s1 "
        "= 2 v1 - s1, s2 = 2 v2 - s2, y = m0 x + m1 v1 + m2 v2\",\n"
        "  \"bands\": [\n";
    text +=
        joined(filters.bands, ",\n", [&](const ExportBand& band) { return json_band_text(band, filters); });
    return {text + "\n  ]\n}\n", {}};
}

LoadedFilters json_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                        const Settings&) {
    TextReader reader(bytes, source, Comments::none, Precision::float64);
    reader.expect("\"bands\": [");
    const auto enter = [&](const ExportBand&) { reader.expect("\"sections\":"); };
    return read_bands(filters, enter, [&](std::size_t) {
        reader.expect("\"sos\":");
        const auto v = reader.numbers('[', ']', 6);
        if (v[3] != 1.0) reader.fail(shortest(v[3]), "a0 of 1");
        return loaded_row(v.data());
    });
}

}  // namespace

const Target targets::json = {
    .name = "json",
    .summary = "everything, unrounded: sections in both forms, speeds, rules",
    .source = "RFC 8259",
    .endings = ".json",
    .switches = true,
    .runs_supervisor = true,
    .write = json_write,
    .read = json_read,
};

namespace {

// scipy.signal's second-order sections as a NumPy array file.

// NumPy Enhancement Proposal 1, version 1.0: magic, version, length of the header, a Python dictionary padded
// so that the data begin at a multiple of 64 bytes, then the numbers. Only doubles in C order are written, so
// this needs none of what reading logs needs.
constexpr std::string_view magic("\x93NUMPY\x01\x00", 8);
constexpr std::size_t alignment = 64;
constexpr std::size_t row_length = 6;

std::string shape_of(const FilterSet& filters) {
    const std::string one = fmt::format("{}, {}", filters.sections_per_band(), row_length);
    return filters.by_speed() ? fmt::format("({}, {})", filters.bands.size(), one) : fmt::format("({})", one);
}

std::string header_of(const FilterSet& filters) {
    std::string text =
        fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape_of(filters));
    const std::size_t start = magic.size() + 2;
    const std::size_t total = (start + text.size() + 1 + alignment - 1) / alignment * alignment;
    text.resize(total - start - 1, ' ');
    text += '\n';
    std::string header(magic);
    header += static_cast<char>(text.size() & 0xff);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

void append_little_endian(std::string& bytes, double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i) bytes += static_cast<char>((bits >> (8 * i)) & 0xff);
}

double little_endian_at(std::string_view bytes, std::size_t at) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    }
    return std::bit_cast<double>(bits);
}

Written scipy_write(const FilterSet& filters, const Settings&, std::span<const std::string>) {
    std::string bytes = header_of(filters);
    for (const ExportBand& band : filters.bands) {
        for (const ExportSection& section : band.sections) {
            const Biquad& f = section.section;
            for (const double value : {f.b0, f.b1, f.b2, 1.0, f.a1, f.a2}) append_little_endian(bytes, value);
        }
    }
    return {bytes, {}};
}

LoadedFilters scipy_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                         const Settings&) {
    const std::string header = header_of(filters);
    const std::size_t rows = filters.bands.size() * filters.sections_per_band();
    if (bytes.substr(0, header.size()) != header || bytes.size() != header.size() + 8 * row_length * rows) {
        raise<DataError>(
            "{}: read {} bytes, expected a NumPy array of doubles of shape {} in {} bytes; write the file "
            "again with ripplenotch export",
            source, bytes.size(), shape_of(filters), header.size() + 8 * row_length * rows);
    }
    std::size_t at = header.size();
    const auto enter = [](const ExportBand&) {};
    return read_bands(filters, enter, [&](std::size_t) {
        double v[row_length];
        for (double& value : v) {
            value = little_endian_at(bytes, at);
            at += 8;
        }
        if (v[3] != 1.0) raise<DataError>("{}: read a0 {}, expected 1", source, v[3]);
        return loaded_row(v);
    });
}

std::string scipy_usage(const FilterSet& filters, const Settings&, const std::string& path) {
    return fmt::format(
        "sos = numpy.load(\"{}\"){}; y, _ = scipy.signal.sosfilt(sos, x, zi=scipy.signal.sosfilt_zi(sos) * "
        "x[0])",
        path, filters.by_speed() ? "[band]" : "");
}

}  // namespace

const Target targets::scipy = {
    .name = "scipy",
    .summary = "second-order sections for scipy.signal.sosfilt, as .npy of doubles",
    .source = "SciPy, scipy.signal.sosfilt; NumPy Enhancement Proposal 1",
    .endings = ".npy",
    .binary = true,
    .switches = true,
    .write = scipy_write,
    .read = scipy_read,
    .usage = scipy_usage,
};

namespace {

// MATLAB and Octave: sos and g, as a script that sets them.

constexpr std::array matlab_keys = {
    name_key("ripplenotch", "the structure it sets"),
};

Written matlab_write(const FilterSet& filters, const Settings& settings,
                     std::span<const std::string> heading) {
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

LoadedFilters matlab_read(std::string_view bytes, const std::string& source, const FilterSet& filters,
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

std::string matlab_usage(const FilterSet&, const Settings& settings, const std::string&) {
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
    .keys = matlab_keys,
    .write = matlab_write,
    .read = matlab_read,
    .usage = matlab_usage,
};

}  // namespace ripplenotch
