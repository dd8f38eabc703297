// SPDX-License-Identifier: MIT
#pragma once
// Any result of the tool as a section of a page: its verdict, its numbers, its figures, its tables.

#include <string>
#include <vector>

#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

/// `text` is a JSON document with schema ripplenotch/<kind>/1. joint, map, table and figure are read with all
/// their checks; of diagnosis the rounds become the figure of the gap; whatever else a kind holds becomes
/// facts (single values), and tables (lists of objects), units taken from the names. Throws DataError for
/// what is no such document.
[[nodiscard]] PageSection section_of_result(const std::string& text, const std::string& source);

/// The same for a document that may hold several results: the diagnoses of several joints become a section
/// each.
[[nodiscard]] std::vector<PageSection> sections_of_result(const std::string& text, const std::string& source);

}  // namespace ripplenotch
