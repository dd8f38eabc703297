// SPDX-License-Identifier: MIT
#pragma once
// The data elements of a MAT file of version 5, 6 or 7 (MathWorks, "MAT-File Format"): which arrays of
// numbers are in it and where their bytes are.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_writer.hpp"
#include "log/table_writer.hpp"

namespace ripplenotch::mat_type {

// Numbers of data types in MAT files of level 5.

enum : std::uint32_t {
    int8 = 1,
    uint16 = 4,
    int32 = 5,
    uint32 = 6,
    float64 = 9,
    matrix = 14,
    compressed = 15,
    utf16 = 17
};

}  // namespace ripplenotch::mat_type

namespace ripplenotch {

// New MAT files of version 5, which every MATLAB, Octave and SciPy reads: a column vector for each column.

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

/// What was found.
struct MatContents {
    std::vector<StoredArray>
        arrays;  ///< of numbers, by paths as MATLAB writes them: "log.q_dot", "runs(2).tau"
    std::vector<ContentEntry> others;  ///< what is no log: "a function handle", "complex"
};

/// The arrays of a whole file, of which only the heads of its elements are read. Throws DataError, beginning
/// with the file's name, where it is damaged or nested deeper than 16.
[[nodiscard]] MatContents find_mat_arrays(const std::shared_ptr<StoredBytes>& file);

/// Of an object that only MATLAB opens: its class, and the lines of MATLAB that save its numbers.
[[nodiscard]] std::string matlab_object_text(const std::string& name, const std::string& class_name);

}  // namespace ripplenotch
