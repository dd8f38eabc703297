// SPDX-License-Identifier: MIT
#pragma once
// Results as sections of a page: their fields as people read them, tables, and the answer on top.

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

// Fields of a result as a page shows them to people: names without underscores, units apart, numbers with the
// digits that their uncertainty allows. The JSON on the page has them all.

/// "dc_delay_ms" is "dc delay" in "ms".
struct Spoken {
    std::string name, unit;
};

[[nodiscard]] Spoken spoken(std::string name);

/// "-" for null; numbers with six significant digits, or four below 1, spans as "0.5 to 2.25; 4 to 5".
[[nodiscard]] std::string value_text(const Json& json);

/// Three significant digits, whole numbers from 1000 on; 0 for a rounding error of zero (below 1e-9).
[[nodiscard]] std::string coarse_text(double value);

/// A field of `owner`: digits as far as its standard error (NAME_stderr, or stderr and ci95 next to a value)
/// reaches, else four for torques, levels, shares and milliseconds, else as value_text.
[[nodiscard]] std::string field_text(const Json& owner, const std::string& name);

/// The fitted parameters as text: {"level_nm": {"value": 1, "ci95": [0.9, 1.1]}} is "level 1.00 (0.90 to
/// 1.10) Nm".
[[nodiscard]] std::string parameters_text(const Json& parameters);

/// A diagnosis' where {} in one sentence: "speed -112 to 0 deg/s; direction negative".
[[nodiscard]] std::string where_text(const Json& where);

/// A list of objects, not empty.
[[nodiscard]] bool is_table(const Json& json);

/// The cells of a row, each under the name of its column.
using NamedCells = std::vector<std::pair<std::string, std::string>>;

/// A column for each name, in the order in which they come; columns that no row fills are left out, but for
/// the first `always`.
[[nodiscard]] PageTable table_of_cells(const std::string& title, std::span<const NamedCells> rows,
                                       std::size_t always);

/// One row an object, one column a field, units apart; objects and short lists within a row are columns of
/// their own, and columns that no row fills are left out. At most 200 rows; the title states the total
/// number.
[[nodiscard]] PageTable table_of(const std::string& name, const Json& rows);

// Tables of results that people read across: columns chosen and named, three digits.

/// The methods of a comparison under the labels A, B, C in the order given (a control keeps its name), with
/// the meaning of each label below, and the reason why a method does not fit where that was requested;
/// columns that no method fills are left out.
[[nodiscard]] PageTable comparison_table(const Json& methods);

/// The design itself: one row a band, with centre frequency and Q of the notch for each order.
[[nodiscard]] PageTable notch_table(const Json& bands);

/// How many switches have a jump of which size; none for fewer than 20, for which a table is clearer.
[[nodiscard]] std::optional<Figure> switch_figure(const Json& switches);

/// The ten switches with the largest jumps; all of them where there are no more.
[[nodiscard]] PageTable largest_switches(const Json& switches);

// The top of a page for a result: the question, an answer in a sentence, and its numbers.

/// The user's question behind this kind of result; the kind itself where none is known.
[[nodiscard]] std::string heading_of(const std::string& kind);

/// Whether the data decide, and whether a filter amplifies an order.
[[nodiscard]] PageState state_of(const Json& result);

/// The answer for a kind that has no verdict of its own, made from its numbers; empty where there are none.
[[nodiscard]] std::string sentence_of(const std::string& kind, const Json& result);

/// At most three numbers, with units, that answer the question.
[[nodiscard]] std::vector<PageFact> key_numbers(const std::string& kind, const Json& result);

}  // namespace ripplenotch
