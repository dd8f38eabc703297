// SPDX-License-Identifier: MIT
#pragma once
// NumPy array files out: rows of one that was read with other torque values, or new structured ones.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/npy/npy_columns.hpp"
#include "log/numbers/column_reader.hpp"
#include "log/table_writer.hpp"

namespace ripplenotch {

// Internal to the log room: bytes that have to wait until something is known that goes before them.

/// A file without a name in the folder for temporary files (TMPDIR). Throws FileError where there is no room.
class TemporaryBytes {
  public:
    TemporaryBytes();
    void put(std::string_view bytes);
    /// All has been put; read() begins at the start.
    void rewind();
    /// Up to `size` bytes; 0 at the end.
    std::size_t read(char* into, std::size_t size);
    /// Exactly `size` bytes that have been put, anywhere; putting goes on behind the last.
    void read_at(std::uint64_t offset, char* into, std::size_t size);

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
    bool flushed_ = true;
};

/// An array whose length is known only at the end: its header is patched in a file, and the rows are spooled
/// when the target is a pipe.
class CountedArray {
  public:
    /// `after_rows`: of the shape, "," or ", 4".
    CountedArray(ByteSink& sink, std::string descr, std::string after_rows);
    void put(std::string_view bytes, std::size_t rows);
    void end();

  private:
    [[nodiscard]] std::string head() const;

    ByteSink& sink_;
    std::optional<TemporaryBytes> spool_;
    std::string descr_, after_rows_;
    std::size_t rows_ = 0;
};

/// Records of a reader with another torque; every other byte passes as it is.
class NpyWriter : public LogWriter {
  public:
    /// Throws UsageError when the torque is an integer and would be rounded (--append adds a float instead).
    NpyWriter(std::unique_ptr<ByteSink> sink, const ColumnReader& reader, const WriteOptions& options);
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override;
    void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) override;
    void finish() override;

  private:
    void begin(const Layout& layout, const RecordColumns& records, const WriteOptions& options);

    std::unique_ptr<ByteSink> sink_;
    std::vector<NpyField> fields_;  ///< by joint: where the new torque goes, in a record of the output
    std::vector<double> factors_;   ///< by joint
    std::size_t record_in_ = 0, record_out_ = 0;
    bool append_;
    std::optional<CountedArray> counted_;  ///< where a range leaves rows out
};

/// A structured array of float64 columns.
class NpyTableWriter : public TableWriter {
  public:
    /// Arrays hold every digit: of the options none concerns them.
    NpyTableWriter(ByteSink& sink, const WriteOptions& /*options*/) : sink_(sink) {}
    void begin(std::span<const std::string> names) override;
    void rows(std::span<const std::span<const double>> columns) override;
    void end() override { array_->end(); }

  private:
    ByteSink& sink_;
    std::optional<CountedArray> array_;
    std::string bytes_;
};

}  // namespace ripplenotch
