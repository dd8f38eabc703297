// SPDX-License-Identifier: MIT
#pragma once
// New MAT files of version 5, which every MATLAB, Octave and SciPy reads: a column vector for each column.

#include <span>
#include <string>
#include <vector>

#include "log/npy/temporary_bytes.hpp"
#include "log/table_writer.hpp"

namespace ripplenotch {

/// A variable is stored as a whole, so that each column waits in a temporary file until the last row is
/// known.
class MatTableWriter final : public TableWriter {
  public:
    /// Arrays hold every digit: of the options none concerns them.
    MatTableWriter(ByteSink& sink, const WriteOptions& /*options*/) : sink_(sink) {}
    void begin(std::span<const std::string> names) override;
    void rows(std::span<const std::span<const double>> columns) override;
    /// Throws UsageError beyond the 4 GiB that a variable of this version can have.
    void end() override;

  private:
    void write_head(const std::string& name);

    ByteSink& sink_;
    std::vector<std::string> names_;
    std::vector<TemporaryBytes> columns_;
    std::string bytes_;
    std::uint64_t rows_ = 0;
};

}  // namespace ripplenotch
