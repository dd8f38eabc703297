// SPDX-License-Identifier: MIT
#include "ripplenotch/log/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "log/formats.hpp"
#include "log/unpack/unpacker.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/output_name.hpp"

namespace ripplenotch {
namespace {

constexpr const LogFormat* const all_formats[] = {
#define FORMAT(name) &formats::name,
#include "log/formats/formats.def"
#undef FORMAT
};

}  // namespace

std::span<const LogFormat* const> log_formats() { return all_formats; }

std::vector<std::string> formats_not_built() {
    std::vector<std::string> missing;
    for (const LogFormat* format : log_formats())
        if (!format->lacks.empty()) missing.push_back(fmt::format("{} ({})", format->name, format->lacks));
    for (const Packing* packing : all_packings())
        if (!packing->lacks.empty()) missing.push_back(fmt::format("{} ({})", packing->name, packing->lacks));
    return missing;
}

const LogFormat& find_log_format(std::string_view name) {
    std::vector<std::string_view> names;
    for (const LogFormat* format : log_formats()) {
        if (format->name == name) return *format;
        names.push_back(format->name);
    }
    raise<UsageError>("there is no log format '{}'; formats: {}", name, fmt::join(names, ", "));
}

std::string written_log_formats() {
    std::string names;
    for (const LogFormat* format : log_formats()) {
        if (format->is_written()) names += fmt::format("{}{}", names.empty() ? "" : ", ", format->name);
    }
    return names;
}

void require_written(const LogFormat& format, const std::string& output) {
    if (format.is_written()) return;
    if (!format.lacks.empty()) {
        raise<UsageError>("{}: this build was made without {}, which writes {}; install it and build again",
                          output == "-" ? "standard output" : output, format.lacks, format.name);
    }
    raise<UsageError>("{}: format {} is read and not written; formats that are written: {}",
                      output == "-" ? "standard output" : output, format.name, written_log_formats());
}

namespace {

/// ".csv .npy": one for each format that is written.
std::string written_extensions() {
    std::string extensions;
    for (const LogFormat* format : log_formats()) {
        if (!format->is_written()) continue;
        extensions += (extensions.empty() ? "" : " ") + std::string(format->extensions.front());
    }
    return extensions;
}

/// As `asked`, or by the extension; null where neither says it.
const LogFormat* told_format(const std::string& path, std::optional<std::string_view> asked) {
    if (asked) return &find_log_format(*asked);
    const std::size_t dot = path.rfind('.');
    std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const LogFormat* format : log_formats()) {
        const auto& known = format->extensions;
        if (std::find(known.begin(), known.end(), extension) != known.end()) return format;
    }
    check_output_name(path, "a log", written_extensions());
    return nullptr;
}

}  // namespace

const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked) {
    return output_format(path, asked, formats::csv);
}

const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked,
                               const LogFormat& log) {
    const LogFormat* told = told_format(path, asked);
    require_written(told != nullptr ? *told : log, path);
    return told != nullptr ? *told : formats::csv;
}

}  // namespace ripplenotch
