// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace ripplenotch {

/// Without gnuplot's version and its empty groups; and "]]>" in a text, which gnuplot leaves as it is, made
/// lawful XML.
[[nodiscard]] std::string same_svg(std::string svg);

/// With the clock and the library's version, which cairo writes into every document, replaced by as many
/// other characters: a PDF counts its bytes.
[[nodiscard]] std::string same_pdf(std::string pdf);

}  // namespace ripplenotch
