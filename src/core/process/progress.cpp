// SPDX-License-Identifier: MIT
#include "ripplenotch/core/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ripplenotch {

namespace {

// Three digits and a prefix: "12.3 MB/s", "950 rows/s".
std::string rate_text(double per_second, std::string_view unit) {
    constexpr std::array<std::string_view, 5> prefixes = {"", "k", "M", "G", "T"};
    std::size_t prefix = 0;
    while (per_second >= 999.5 && prefix + 1 < prefixes.size()) {
        per_second /= 1000.0;
        ++prefix;
    }
    const int decimals = per_second >= 99.95 ? 0 : per_second >= 9.995 ? 1 : 2;
    // A prefix belongs to a unit, not to a thing that is counted.
    const bool counted = unit != "B";
    return fmt::format("{:.{}f} {}{}{}/s", per_second, decimals, prefixes[prefix],
                       counted && prefix > 0 ? " " : "", unit);
}

std::string time_text(double seconds) {
    const auto whole = static_cast<long long>(std::ceil(std::min(seconds, 3.6e8)));
    if (whole < 100) return fmt::format("{} s", whole);
    if (whole < 100 * 60) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress& Progress::current() {
    static Progress progress;
    return progress;
}

void Progress::begin(const char* what, const char* unit, std::uint64_t total) noexcept {
    what_ = what;
    unit_ = unit;
    total_ = total;
    done_ = 0;
    ++stage_;
}

Progress::State Progress::state() const noexcept { return {what_, unit_, done_, total_, stage_}; }

void Progress::step_aside() noexcept {
    if (void (*const hide)() = hide_.load()) hide();
}

std::string progress_line(std::string_view command, const Progress::State& state,
                          std::chrono::duration<double> stage_time, int columns) {
    const std::size_t room = static_cast<std::size_t>(std::max(columns, 1));
    const std::string head = fmt::format("{}: {}", command, state.what);
    const double seconds = stage_time.count();
    const double rate = seconds > 0.0 ? static_cast<double>(state.done) / seconds : 0.0;
    const std::string speed = state.done > 0 ? "  " + rate_text(rate, state.unit) : "";
    if (state.total == 0) return fmt::format("{}{}  {}", head, speed, time_text(seconds)).substr(0, room);

    const double share = std::min(1.0, static_cast<double>(state.done) / static_cast<double>(state.total));
    const std::string left =
        state.done > 0 ? "  " + time_text((1.0 - share) / share * seconds) + " left" : "";
    const std::string tail = fmt::format("  {:3.0f} %{}{}", std::floor(100.0 * share), speed, left);
    constexpr std::size_t widest = 30, narrowest = 5;
    const std::size_t text = head.size() + tail.size() + 3;
    if (text + narrowest > room) return (head + tail).substr(0, room);
    const std::size_t width = std::min(widest, room - text);
    const auto filled = static_cast<std::size_t>(std::floor(share * static_cast<double>(width)));
    std::string bar(filled, '=');
    if (filled < width) bar += '>';
    bar.resize(width, ' ');
    return fmt::format("{} [{}]{}", head, bar, tail);
}

std::string_view version() { return RIPPLENOTCH_VERSION; }

}  // namespace ripplenotch
