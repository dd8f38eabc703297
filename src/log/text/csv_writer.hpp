// SPDX-License-Identifier: MIT
#pragma once
// The rows of a text log with other torque values: everything else passes byte for byte.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "log/text/csv_reader.hpp"
#include "log/text/quick_rows.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// Internal to the log room: numbers as the cells of a text log have them.

/// How numbers are written: with fixed decimals, or the fewest digits that read back.
struct CellText {
    WriteOptions::Decimals rule = WriteOptions::Decimals::shortest;
    int decimals = 6;  ///< where they are fixed
    char decimal_mark = '.';

    /// Numbers printed between two looks at the room for them, which each may need number_room bytes of.
    static constexpr std::size_t at_once = 256;

    /// There is room for number_room bytes at `into`. Returns the text's end.
    char* put(char* into, double value) const {
        char* const end = rule == WriteOptions::Decimals::fixed ? put_fixed(into, value, decimals)
                                                                : put_shortest(into, value);
        if (decimal_mark != '.') std::replace(into, end, '.', decimal_mark);
        return end;
    }
};

// Internal to the log room: text put together piece by piece in a string that is used again and again.

/// Text is written at end(), where ensure() has seen to it that there is room.
class TextRoom {
  public:
    /// Keeps what `room` holds of size: making a string longer fills it, which takes as long as the text.
    TextRoom(std::string& room, std::size_t expected) : room_(room) {
        if (room_.size() < expected) room_.resize(expected);
    }

    /// Room for so many bytes at what it returns, the end of what has been written.
    [[nodiscard]] char* ensure(std::size_t size) {
        if (used_ + size > room_.size()) room_.resize(2 * (used_ + size));
        return room_.data() + used_;
    }
    /// What has been written ends here.
    void written_until(const char* end) { used_ = static_cast<std::size_t>(end - room_.data()); }
    [[nodiscard]] std::string_view text() const { return {room_.data(), used_}; }

  private:
    std::string& room_;
    std::size_t used_ = 0;
};

// Internal to the log room: a block's bytes with other numbers in the places of its torques, or behind its
// rows.

/// How the rows of a log are written anew.
struct RewritePlan {
    CellRules rules;
    CellText cells;
    std::vector<std::size_t> joints;  ///< in the order in which their numbers stand in a row
    std::vector<double> factors;      ///< by joint: newton-metres in one unit of its torque column
};

class CsvWriter : public LogWriter {
  public:
    CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options);
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override;
    void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) override;
    void finish() override;

  private:
    void write_head(const CsvReader& reader);
    [[nodiscard]] std::string names_appended(const CsvReader& reader) const;
    [[nodiscard]] std::string units_appended(const CsvReader& reader) const;

    std::unique_ptr<ByteSink> sink_;
    WriteOptions options_;
    RewritePlan plan_;
};

/// One for each joint that is read; with its joint's name before it where there are several.
[[nodiscard]] std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options);

}  // namespace ripplenotch
