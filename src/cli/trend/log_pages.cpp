// SPDX-License-Identifier: MIT
#include "cli/trend/log_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <utility>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

namespace fs = std::filesystem;

constexpr std::array telling = {"{log}", "{stem}", "{name}", "{date}"};  // a page of each log

// What may stand in an address as it is; a name may hold anything else.
std::string as_address(const std::string& name) {
    std::string address;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte < 128 && (std::isalnum(byte) != 0 ||
                                          std::string_view("/._-~").find(c) != std::string_view::npos);
        address += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return address;
}

std::string filled(std::string pattern, const JointTrend& joint, const std::string& log,
                   const std::string& date) {
    const fs::path path(log);
    const std::array<std::pair<std::string, std::string>, 6> values = {
        {{"{log}", log},
         {"{stem}", fs::path(path).replace_extension().string()},
         {"{name}", path.stem().string()},
         {"{robot}", joint.robot},
         {"{joint}", joint.joint},
         {"{date}", date.substr(0, 10)}}};
    std::string address;
    for (std::size_t at = 0; at < pattern.size();) {
        const auto* found = std::find_if(values.begin(), values.end(), [&](const auto& value) {
            return pattern.compare(at, value.first.size(), value.first) == 0;
        });
        address += found == values.end() ? std::string(1, pattern[at]) : as_address(found->second);
        at += found == values.end() ? 1 : found->first.size();
    }
    return address;
}

std::string page_beside(const std::string& log) {
    std::error_code failed;
    for (const fs::path& page : {fs::path(log).replace_extension(".html"), fs::path(log + ".html")})
        if (page != fs::path(log) && fs::is_regular_file(page, failed)) return as_address(page.string());
    return {};
}

}  // namespace

void check_page_pattern(const std::optional<std::string>& pattern) {
    if (!pattern) return;
    for (const char* word : telling)
        if (pattern->find(word) != std::string::npos) return;
    raise<UsageError>("--log-page '{}' is the same for all logs; one of {} tells them apart", *pattern,
                      "{log}, {stem}, {name}, {date}");
}

void add_log_pages(Trend& trend, const std::optional<std::string>& pattern) {
    std::map<std::string, std::string> known;  // a look at the disk a log
    for (JointTrend& joint : trend.joints) {
        const auto page_of = [&](const std::string& log, const std::string& date) {
            if (pattern) return filled(*pattern, joint, log, date);
            const auto [at, is_new] = known.try_emplace(log);
            if (is_new) at->second = page_beside(log);
            return at->second;
        };
        for (JointChange& change : joint.changes) {
            change.first_page = page_of(change.first_log, change.first_date);
            change.last_page = page_of(change.last_log, change.last_date);
            for (AdjustedValue& value : change.course) value.page = page_of(value.log, value.date);
        }
    }
}

}  // namespace ripplenotch
