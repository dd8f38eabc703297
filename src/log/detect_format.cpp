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
    Stranger{"MDF     ", "an MDF file",
             "convert it: python3 -c \"import asammdf; asammdf.MDF('{}').export('csv', 'run.csv', "
             "single_time_base=True)\""},
    Stranger{"TDSm", "a TDMS file",
             "convert it: python3 -c \"import nptdms; "
             "nptdms.TdmsFile.read('{}').as_dataframe().to_csv('run.csv')\""},
    Stranger{"PAR1", "a Parquet file",
             "convert it: duckdb -c \"copy (from '{}') to 'run.csv' (format csv)\""},
    Stranger{"#ROSBAG", "a ROS 1 bag", "convert it: rosbags-convert --src {} --dst run"},
    Stranger{"BZh", "a bzip2 file", "unpack it: bzcat {} | ripplenotch ... -"},
    Stranger{"PK\x03\x04", "a ZIP archive (or .xlsx)",
             "unpack it, or convert a workbook: libreoffice --headless --convert-to csv {}"},
};

bool is_plain_name(const std::string& name) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/+-";
    return !name.starts_with('-') && name.find_first_not_of(plain) == std::string::npos;
}

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
        std::string remedy(stranger.remedy);
        // The line is there to be pasted: a name that a shell or Python would read otherwise does not go in.
        remedy.replace(remedy.find("{}"), 2, is_plain_name(source) ? source : "FILE");
        raise<DataError>("{}: read {}, expected a log as {}; {}", source, stranger.what,
                         fmt::join(names, " or "), remedy);
    }
    return formats::csv;
}

}  // namespace ripplenotch
