// SPDX-License-Identifier: MIT
#pragma once
// Reads back what text targets wrote: walks from marker to marker and takes the numbers between brackets. It
// knows no values, only text.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/export/arithmetic.hpp"

namespace ripplenotch {

enum class Comments { none, c, percent, hash };

class TextReader {
  public:
    /// Comments are blanked, so that numbers in them are not taken for values. `precision` is that of the
    /// target: its own compiler would round decimals to it, once.
    TextReader(std::string_view text, std::string source, Comments comments, Precision precision);

    /// Moves past the next `marker`. False, and nothing moved, when there is none.
    [[nodiscard]] bool find(std::string_view marker);
    /// The same; throws DataError naming source, line and marker when there is none.
    void expect(std::string_view marker);
    /// The next number, after blanks and '=' or ':' or ','.
    [[nodiscard]] double number();
    /// The numbers between the next `open` and its `close`; exactly `count` of them.
    [[nodiscard]] std::vector<double> numbers(char open, char close, std::size_t count);
    /// The next name or number, as text; empty at the end.
    [[nodiscard]] std::string word();
    [[nodiscard]] bool at_end();
    [[noreturn]] void fail(std::string_view read, std::string_view expected) const;

  private:
    void blank_comments(Comments comments);
    [[nodiscard]] std::string_view token();

    std::string text_, source_;
    Precision precision_;
    std::size_t at_ = 0;
};

}  // namespace ripplenotch
