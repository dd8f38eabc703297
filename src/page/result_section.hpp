// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

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
