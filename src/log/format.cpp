// SPDX-License-Identifier: MIT
#include "ripplenotch/log/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "log/formats.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/output_name.hpp"

namespace ripplenotch {
namespace {

constexpr const LogFormat* const list[] = {
#define FORMAT(name) &formats::name,
#include "log/formats/formats.def"
#undef FORMAT
};

}  // namespace

std::span<const LogFormat* const> log_formats() { return list; }

const LogFormat& find_log_format(std::string_view name) {
    std::vector<std::string_view> names;
    for (const LogFormat* format : log_formats()) {
        if (format->name == name) return *format;
        names.push_back(format->name);
    }
    raise<UsageError>("there is no log format '{}'; formats: {}", name, fmt::join(names, ", "));
}

const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked) {
    if (asked) return find_log_format(*asked);
    const std::size_t dot = path.rfind('.');
    std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const LogFormat* format : log_formats()) {
        const auto& known = format->extensions;
        if (std::find(known.begin(), known.end(), extension) != known.end()) return *format;
    }
    check_output_name(path, "a log", ".csv .npy");
    return formats::csv;
}

}  // namespace ripplenotch
