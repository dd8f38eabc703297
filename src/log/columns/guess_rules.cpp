// SPDX-License-Identifier: MIT
#include "log/columns/guess_rules.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// How well lines read with these rules: rows of equal width, nearly all numbers.
struct Score {
    CellRules rules;
    std::size_t columns = 0;
    double consistent = 0.0;  // share of lines with the commonest number of cells
    double numeric = 0.0;     // share of the cells in them that are numbers or empty
    std::size_t numbers = 0;  // numeric cells in a line, on average, rounded
    [[nodiscard]] double value() const {
        if (columns == 0 || numbers == 0) return 0.0;
        return consistent * numeric * (columns > 1 ? 1.0 : 0.5);
    }
};

// The commonest number of cells, and how many lines have it. Between widths that are equally common, the one
// that the first line has too.
std::pair<std::size_t, std::size_t> commonest(std::vector<std::size_t> widths, std::size_t first) {
    std::sort(widths.begin(), widths.end());
    std::size_t width = 0, best = 0;
    for (std::size_t i = 0; i < widths.size();) {
        const auto end = std::upper_bound(widths.begin(), widths.end(), widths[i]);
        const auto count = static_cast<std::size_t>(end - widths.begin()) - i;
        if (count > best || (count == best && widths[i] == first)) best = count, width = widths[i];
        i += count;
    }
    return {width, best};
}

Score score(std::string_view bytes, const TextLine& first, const std::vector<TextLine>& rows,
            CellRules rules) {
    Score result{rules};
    std::vector<std::size_t> widths;
    CellSplit split;
    for (const TextLine& line : rows) {
        split_cells(line.of(bytes), rules.delimiter, split);
        widths.push_back(split.cells.size());
    }
    split_cells(first.of(bytes), rules.delimiter, split);
    const auto [columns, best] = commonest(widths, split.cells.size());
    result.columns = columns;
    std::size_t cells = 0, good = 0, numbers = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (widths[k] != result.columns) continue;
        const std::string_view line = rows[k].of(bytes);
        split_cells(line, rules.delimiter, split);
        for (const Cell& cell : split.cells) {
            const bool number = parse_number(cell.of(line), rules.decimal_mark).has_value();
            ++cells;
            good += number || cell.begin == cell.end;
            numbers += number;
        }
    }
    if (cells == 0) return result;
    result.consistent = static_cast<double>(best) / static_cast<double>(rows.size());
    result.numeric = static_cast<double>(good) / static_cast<double>(cells);
    result.numbers = (numbers + best - 1) / best;
    return result;
}

}  // namespace

GuessedRules guess_rules(std::string_view bytes, const TextLine& first, const std::vector<TextLine>& rows,
                         const ReadOptions& options) {
    // In order of preference between equals. A comma that separates can mark decimals only inside quotes.
    constexpr std::array candidates = {CellRules{'\t', '.'}, CellRules{';', '.'},  CellRules{',', '.'},
                                       CellRules{' ', '.'},  CellRules{'\t', ','}, CellRules{';', ','},
                                       CellRules{' ', ','},  CellRules{',', ','}};
    const bool quotes = bytes.find('"') != std::string_view::npos;
    Score best;
    const auto consider = [&](CellRules rules) {
        const Score now = score(bytes, first, rows, rules);
        // More columns win between readings that are equally good: "1,5;2,5" is two numbers, not one.
        const double margin = now.value() - best.value();
        if (margin > 1e-9 ||
            (margin > -1e-9 && now.columns > best.columns && now.columns > 1 && best.columns <= 1))
            best = now;
    };
    for (CellRules rules : candidates) {
        if (rules.delimiter == ',' && rules.decimal_mark == ',' && !quotes) continue;
        if (options.delimiter && rules.delimiter != *options.delimiter) continue;
        if (options.decimal_mark && rules.decimal_mark != *options.decimal_mark) continue;
        consider(rules);
    }
    if (best.columns == 0 && options.delimiter)
        consider({*options.delimiter, options.decimal_mark.value_or('.')});
    return {best.rules, best.columns, best.numbers};
}

}  // namespace ripplenotch
