// SPDX-License-Identifier: MIT
#pragma once
// The rows of a text log with other torque values: everything else passes byte for byte.

#include <memory>
#include <string>

#include "log/csv_reader.hpp"

namespace ripplenotch {

class CsvWriter : public LogWriter {
  public:
    CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options);
    void write(const RowBlock& block, std::span<const double> torque_nm) override;
    void prepare(const RowBlock& block, std::span<const double> torque_nm, std::string& bytes) const override;
    void put(const RowBlock& block, std::span<const double> torque_nm, std::string_view bytes) override;
    void finish() override;

  private:
    void write_head(const CsvReader& reader);
    void append_number(std::string& text, double value, std::string_view as_in) const;

    std::unique_ptr<ByteSink> sink_;
    WriteOptions options_;
    CellRules rules_;
    double factor_;  ///< newton-metres in one unit of the torque column
};

/// "torque_filtered [Nm]" beside "tau [Nm]", "torque_filtered_Nm" beside "torque_Nm": a new column's name in
/// the style of the torque column's.
[[nodiscard]] std::string appended_name(const std::string& wanted, const std::string& torque_name);

}  // namespace ripplenotch
