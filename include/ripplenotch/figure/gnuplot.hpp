// SPDX-License-Identifier: MIT
#pragma once
// Draws figures with gnuplot, a child process that gets its script through a pipe and gives the picture back
// through another; it sees no file name and no text that it could run.

#include <optional>
#include <string>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

enum class PictureKind { svg, png, pdf };

/// The bytes of a picture, the same each time: no clock, no version. Empty when gnuplot is not installed;
/// throws FileError with gnuplot's own message when it fails.
[[nodiscard]] std::optional<std::string> draw_picture(const Figure& figure, PictureKind kind);

/// The figure in characters, lines of at most `columns` (40 to 200), one panel under the other. As above.
[[nodiscard]] std::optional<std::string> draw_text(const Figure& figure, int columns);

}  // namespace ripplenotch
