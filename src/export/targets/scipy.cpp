// SPDX-License-Identifier: MIT
// scipy.signal's second-order sections as a NumPy array file.
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>

#include "export/target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

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

Written write(const FilterSet& filters, const Settings&, std::span<const std::string>) {
    std::string bytes = header_of(filters);
    for (const ExportBand& band : filters.bands) {
        for (const ExportSection& section : band.sections) {
            const Biquad& f = section.section;
            for (const double value : {f.b0, f.b1, f.b2, 1.0, f.a1, f.a2}) append_little_endian(bytes, value);
        }
    }
    return {bytes, {}};
}

LoadedFilters read(std::string_view bytes, const std::string& source, const FilterSet& filters,
                   const Settings&) {
    const std::string header = header_of(filters);
    const std::size_t rows = filters.bands.size() * filters.sections_per_band();
    if (bytes.substr(0, header.size()) != header || bytes.size() != header.size() + 8 * row_length * rows) {
        raise<DataError>(
            "{}: read {} bytes, expected a NumPy array of doubles of shape {} in {} bytes; write the "
            "file again with ripplenotch export",
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

std::string usage(const FilterSet& filters, const Settings&, const std::string& path) {
    return fmt::format(
        "sos = numpy.load(\"{}\"){}; y, _ = scipy.signal.sosfilt(sos, x, zi=scipy.signal.sosfilt_zi(sos) "
        "* x[0])",
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
    .write = write,
    .read = read,
    .usage = usage,
};

}  // namespace ripplenotch
