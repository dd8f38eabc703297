// SPDX-License-Identifier: MIT
#include "log/detect_format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

#include "log/formats.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

// Files that people hand over by mistake, told by their first bytes, and what to do with them. A format that
// is listed comes first, so that a file in this table can become one.
struct Stranger {
    std::string_view magic, what, remedy;
};
constexpr std::array strangers = {
    Stranger{"\x89HDF", "an HDF5 file", "export the joint's columns as CSV or NPY"},
    Stranger{"MATLAB 5.0", "a MATLAB file", "export the joint's columns as CSV or NPY"},
    Stranger{"PK\x03\x04", "a ZIP archive (or .npz, .xlsx)", "unpack it, or export it as CSV"},
    Stranger{"\x1f\x8b", "a gzip file", "unpack it, e.g. with zcat FILE | ripplenotch ... -"},
    Stranger{"\x28\xb5\x2f\xfd", "a zstd file", "unpack it, e.g. with zstdcat FILE | ripplenotch ... -"},
    Stranger{"SQLite format 3", "an SQLite file (a ROS 2 bag?)", "export the joint's topic as CSV"},
    Stranger{"#ROSBAG", "a ROS 1 bag", "export the joint's topic as CSV"},
    Stranger{"\x89MCAP", "an MCAP file", "export the joint's topic as CSV"},
};

}  // namespace

const LogFormat& detect_format(std::string_view first_bytes, const std::string& source,
                               std::span<const LogFormat* const> formats) {
    std::vector<std::string_view> names;
    for (const LogFormat* format : formats) {
        if (format->sniff != nullptr && format->sniff(first_bytes)) return *format;
        names.push_back(format->name);
    }
    for (const Stranger& stranger : strangers) {
        if (!first_bytes.starts_with(stranger.magic)) continue;
        raise<DataError>("{}: read {}, expected a log as {}; {}", source, stranger.what,
                         fmt::join(names, " or "), stranger.remedy);
    }
    return formats::csv;
}

}  // namespace ripplenotch
