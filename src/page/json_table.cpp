// SPDX-License-Identifier: MIT
#include "page/json_table.hpp"

#include <algorithm>
#include <unordered_map>

#include "page/json_words.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_rows = 200, most_columns = 100;

// Short enough to be columns of a table.
bool is_short_list(const Json& json) {
    return is_table(json) && json.size() <= 3 && std::all_of(json.begin(), json.end(), [](const Json& row) {
               return row.size() <= 4 &&
                      std::none_of(row.begin(), row.end(), [](const Json& v) { return v.is_structured(); });
           });
}

// Nothing, or more than a cell holds: the JSON has it.
bool says_nothing(const std::string& cell) {
    return cell.empty() || cell == "-" || cell.ends_with(" values");
}

// A row's objects become columns of their own: settle_ms {"0.5": 147} is column "settle 0.5, ms". One more
// cell than there may be columns tells that some are left out.
void cells_of(const Json& row, const std::string& prefix, const std::string& unit,
              std::vector<std::pair<std::string, std::string>>& cells) {
    for (const auto& [name, entry] : row.items()) {
        if (cells.size() > most_columns) return;
        const Spoken said = spoken(name);
        const std::string full = prefix + said.name;
        const std::string in = said.unit.empty() ? unit : said.unit;
        if (name == "parameters" && entry.is_object()) {
            cells.emplace_back("parameters (95 % interval)", parameters_text(entry));
        } else if (name == "where" && entry.is_object()) {
            cells.emplace_back("where", where_text(entry));
        } else if (entry.is_object() && entry.size() <= 6) {
            cells_of(entry, full + " ", in, cells);
        } else if (is_short_list(entry)) {
            for (std::size_t i = 0; i < entry.size(); ++i)
                cells_of(entry[i], fmt::format("{} {} ", full, i + 1), "", cells);
        } else {
            cells.emplace_back(in.empty() ? full : full + ", " + in, field_text(row, name));
        }
    }
}

}  // namespace

bool is_table(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::all_of(json.begin(), json.end(), [](const Json& row) { return row.is_object(); });
}

PageTable table_of(const std::string& name, const Json& rows) {
    PageTable table{spoken(name).name, {}, {}};
    std::vector<std::vector<std::pair<std::string, std::string>>> all;
    std::unordered_map<std::string, std::size_t> places;  // of columns in the header
    bool left_out = false;
    for (const Json& row : rows) {
        if (all.size() == most_rows) break;
        cells_of(row, "", "", all.emplace_back());
        for (const auto& [column, value] : all.back()) {
            if (places.size() < most_columns && places.emplace(column, places.size()).second)
                table.header.push_back(column);
            left_out |= places.size() == most_columns && !places.contains(column);
        }
    }
    for (const auto& cells : all) {
        std::vector<std::string> row(table.header.size(), "-");
        for (const auto& [column, value] : cells) {
            if (const auto at = places.find(column); at != places.end()) row[at->second] = value;
        }
        table.rows.push_back(std::move(row));
    }
    // Columns that no row fills say nothing.
    for (std::size_t c = table.header.size(); c-- > 0;) {
        if (!std::all_of(table.rows.begin(), table.rows.end(),
                         [c](const auto& row) { return says_nothing(row[c]); }))
            continue;
        table.header.erase(table.header.begin() + static_cast<std::ptrdiff_t>(c));
        for (auto& row : table.rows) row.erase(row.begin() + static_cast<std::ptrdiff_t>(c));
    }
    if (left_out) table.title += fmt::format(" (the first {} columns)", most_columns);
    if (rows.size() > most_rows) table.title += fmt::format(" (the first {} of {})", most_rows, rows.size());
    return table;
}

}  // namespace ripplenotch
