// SPDX-License-Identifier: MIT
#pragma once
// Elements common to every gnuplot script. Text goes in as octal numbers of its bytes, so that none of it can
// be a quote, a back quote, a macro or a command; numbers go in as numbers.

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Runs gnuplot without user settings on this script and returns its output; empty when there is no gnuplot.
/// Throws FileError when it ends with another exit code than 0.
[[nodiscard]] std::optional<std::string> run_gnuplot(const std::string& script);

/// visible_text(text) as a string constant of gnuplot, quotes included.
[[nodiscard]] std::string gnuplot_string(std::string_view text);

class GnuplotScript {
  public:
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
    }
    /// A block of rows; returns its name. A row with a nan becomes an empty row, which breaks a line.
    std::string rows(const std::vector<const std::vector<double>*>& columns);
    /// A block of text cells: x, y, one character.
    std::string cells(const HeatMap& map, std::string_view levels);
    /// A block for `matrix`: one row of numbers a row of the map, within the range of its colours.
    std::string matrix(const HeatMap& map);

    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    std::string open_block();
    std::string text_;
    int blocks_ = 0;
};

/// "(0.1, 0.2, 0.5, 1)" for a logarithmic axis of few decades, where powers of ten alone would be one or two
/// numbers; the step of one that counts; empty for others.
[[nodiscard]] std::string gnuplot_ticks(const PlotRange& range, PlotScale scale);

/// A cell within the range of the map's colours; nan stays.
[[nodiscard]] double within_colours(const HeatMap& map, double value);

/// The straight line of `line` through a panel with these ranges; false when it does not pass through it.
struct Segment {
    double x0, y0, x1, y1;
};
[[nodiscard]] bool segment_of(const NamedLine& line, const PlotRange& x, const PlotRange& y,
                              Segment& segment);

}  // namespace ripplenotch
