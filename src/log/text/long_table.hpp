// SPDX-License-Identifier: MIT
#pragma once
// Text logs in which a row holds one number: tables of time, signal and value, and traces with a block of
// rows for each variable. They are made tables of a column for each signal, in memory, and read as such.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// A table that was made from another shape, and what has to be said of it.
class ReshapedText : public ByteSource {
  public:
    ReshapedText(const std::string& name, std::string text, Assumption shape,
                 std::vector<LogWarning> warnings);
    [[nodiscard]] const Assumption& shape() const { return shape_; }
    [[nodiscard]] const std::vector<LogWarning>& warnings() const { return warnings_; }

  private:
    Assumption shape_;
    std::vector<LogWarning> warnings_;
};

/// Whether the first lines may be those of such a log.
[[nodiscard]] bool may_be_long(std::string_view first_bytes);

/// `source`, of which `first_bytes` have been read, as a table with a column for each signal; or its bytes as
/// they are, where a trace has one block only. Signals with other times than the torque's are joined to it by
/// ReadOptions::join. Throws DataError with the line where a cell is no number or time runs backward.
[[nodiscard]] std::unique_ptr<ByteSource> widened(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                                  const ReadOptions& options);

}  // namespace ripplenotch
