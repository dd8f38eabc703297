// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "log/npy/npy_reader.hpp"
#include "log/npy/temporary_bytes.hpp"
#include "log/row_cut.hpp"

namespace ripplenotch {

/// The records of a log that --from and --to keep, as bytes, with what is needed to say where each stood.
class KeptRows {
  public:
    /// Reads the whole log. Throws DataError where no row stays.
    KeptRows(NpyReader& whole, const ReadOptions& options);

    /// The next bytes of the kept records; 0 at their end.
    [[nodiscard]] std::size_t read(char* into, std::size_t size) { return bytes_.read(into, size); }
    /// The row of the file in which a kept row stood.
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const { return numbers_.in_file(number); }
    [[nodiscard]] const RowCut& cut() const { return cut_; }

  private:
    RowCut cut_;
    KeptNumbers numbers_;
    TemporaryBytes bytes_;
};

}  // namespace ripplenotch
