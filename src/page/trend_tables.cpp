// SPDX-License-Identifier: MIT
#include "page/trend_tables.hpp"

#include <fmt/format.h>

namespace ripplenotch {
namespace {

std::string text_in(const Json& row, const char* name) {
    const auto found = row.find(name);
    return found != row.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string joint_in(const Json& row) {
    const std::string robot = text_in(row, "robot"), joint = text_in(row, "joint");
    return robot.empty() ? joint : robot + " " + joint;
}

std::string day_in(const Json& row, const char* name) { return text_in(row, name).substr(0, 10); }

std::string number_in(const Json& row, const char* name, const char* format) {
    const auto found = row.find(name);
    return found != row.end() && found->is_number() ? fmt::format(fmt::runtime(format), found->get<double>())
                                                    : "-";
}

// One day, or the days between which it lies.
std::string since(const Json& row) {
    const std::string day = day_in(row, "date"), early = day_in(row, "earliest"),
                      late = day_in(row, "latest");
    if (text_in(row, "kind") == "drift") return "all the time";
    return early == late ? day : fmt::format("{} ({} to {})", day, early, late);
}

void add_log(PageTable& table, std::vector<std::string>& cells, const Json& row, const char* log,
             const char* page) {
    const std::string address = text_in(row, page);
    if (!address.empty()) table.links.push_back({table.rows.size(), cells.size(), address});
    cells.push_back(text_in(row, log));
}

}  // namespace

PageTable alert_table(const Json& alerts) {
    PageTable table{"Alerts",
                    {"joint", "alert", "since", "surest sign", "change", "%", "p", "of its kind",
                     "last log before", "first log after"},
                    {}};
    for (const Json& row : alerts) {
        const std::string drift = text_in(row, "kind") == "drift" ? "drift: " : "";
        std::vector<std::string> cells = {joint_in(row),
                                          drift + text_in(row, "cause"),
                                          since(row),
                                          text_in(row, "descriptor"),
                                          number_in(row, "size", "{:+.3g}"),
                                          number_in(row, "percent", "{:+.1f}"),
                                          number_in(row, "p", "{:.1g}"),
                                          number_in(row, "kin", "{:g}")};
        add_log(table, cells, row, "last_log_before", "last_page_before");
        add_log(table, cells, row, "first_log_after", "first_page_after");
        table.rows.push_back(std::move(cells));
    }
    return table;
}

PageTable course_table(const Json& courses) {
    PageTable table{"Logs of the joints that are drawn", {"joint", "descriptor", "date", "value", "log"}, {}};
    for (const Json& row : courses) {
        std::vector<std::string> cells = {joint_in(row), text_in(row, "descriptor"), day_in(row, "date"),
                                          number_in(row, "value", "{:.4g}")};
        add_log(table, cells, row, "log", "page");
        table.rows.push_back(std::move(cells));
    }
    table.folded = true;
    return table;
}

}  // namespace ripplenotch
