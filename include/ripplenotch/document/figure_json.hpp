// SPDX-License-Identifier: MIT
#pragma once
// What a figure shows, as JSON: the data behind a picture, for any other program that draws.

#include <string>
#include <string_view>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Schema ripplenotch/figure/1; numbers with eight significant digits, null where a line breaks or a cell is
/// empty. Same figure, same bytes.
[[nodiscard]] std::string figure_text(const Figure& figure, const Provenance& provenance);

/// Reads it back. Throws DataError that names `source`, the field, and what was expected.
[[nodiscard]] Figure figure_from_json(std::string_view text, const std::string& source);

}  // namespace ripplenotch
