// SPDX-License-Identifier: MIT
#include "cli/recommend/pasted.hpp"

#include <filesystem>
#include <set>

#include "cli/options/shell_word.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

void add(std::string& line, std::string_view option, const std::optional<std::string>& value) {
    if (value) line += " " + std::string(option) + " " + shell_quoted(*value);
}

std::optional<std::string> count_of(int value) {
    return value > 0 ? std::optional(std::to_string(value)) : std::nullopt;
}

}  // namespace

std::string log_words(const LogOptions& log) {
    std::string line;
    add(line, "--from", log.from);
    add(line, "--to", log.to);
    add(line, "--format", log.format);
    add(line, "--joint", log.joint);
    add(line, "--columns", log.columns);
    for (const std::string& unit : log.units) add(line, "--unit", unit);
    if (log.sample_rate) add(line, "--sample-rate", shortest(log.sample_rate->value()) + "Hz");
    if (log.constant_speed) line += " --constant-speed " + shortest(log.constant_speed->value()) + "deg/s";
    add(line, "--side", log.side);
    add(line, "--delimiter", log.delimiter);
    add(line, "--decimal", log.decimal);
    if (log.no_header) line += " --no-header";
    add(line, "--skip-lines", count_of(log.skip_lines));
    add(line, "--layout", log.records);
    add(line, "--skip-bytes", count_of(log.skip_bytes));
    add(line, "--clock", log.clock);
    add(line, "--join", log.join);
    add(line, "--kt", log.kt);
    if (log.hold_bad_values) line += " --hold-bad-values";
    return line;
}

std::string gear_words(const GearAccount& gear) {
    std::string orders;
    for (const Order order : gear.orders) orders += (orders.empty() ? "" : ",") + shortest(order.value());
    return " --gear-ratio " + shortest(gear.ratio.value()) + " --orders " + orders;
}

std::string filtered_name(const std::string& log) {
    // A name that the filtered log can keep; others hold what is not written or is packed.
    static const std::set<std::string> written = {".csv", ".txt", ".npy", ".mat", ".h5"};
    const std::string ending = std::filesystem::path(log).extension().string();
    return "filtered" + (written.contains(ending) ? ending : ".csv");
}

}  // namespace ripplenotch
