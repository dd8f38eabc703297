// SPDX-License-Identifier: MIT
#pragma once
// The rows of a text log with other torque values: everything else passes byte for byte.

#include <memory>
#include <string>
#include <vector>

#include "log/text/csv_reader.hpp"
#include "log/text/row_rewriter.hpp"

namespace ripplenotch {

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

/// "torque_filtered [Nm]" beside "tau [Nm]", "torque_filtered_Nm" beside "torque_Nm": a new column's name in
/// the style of the torque column's.
[[nodiscard]] std::string appended_name(const std::string& wanted, const std::string& torque_name);
/// One for each joint that is read; with its joint's name before it where there are several.
[[nodiscard]] std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options);

}  // namespace ripplenotch
