// SPDX-License-Identifier: MIT
#include "log/table_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {
namespace {

class Converter : public LogWriter {
  public:
    Converter(std::unique_ptr<ByteSink> sink, const LogReader& reader, const WriteOptions& options,
              MakeTableWriter make)
        : sink_(std::move(sink)),
          table_(make(*sink_, options)),
          append_(options.append),
          has_position_(reader.layout().chosen.position.has_value()) {
        std::vector<std::string> names = {"time_s", "velocity_deg_s", "torque_nm"};
        if (has_position_) names.emplace_back("position_deg");
        if (append_) names.push_back(options.append_name + "_nm");
        table_->begin(names);
    }

    void write(const RowBlock& block, std::span<const double> torque_nm) override {
        std::vector<std::span<const double>> columns = {
            block.time_s, block.velocity_deg_s,
            append_ ? std::span<const double>(block.torque_nm) : torque_nm};
        if (has_position_) columns.emplace_back(block.position_deg);
        if (append_) columns.push_back(torque_nm);
        table_->rows(columns);
    }

    void finish() override {
        table_->end();
        sink_->finish();
    }

  private:
    std::unique_ptr<ByteSink> sink_;
    std::unique_ptr<TableWriter> table_;
    bool append_, has_position_;
};

}  // namespace

std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                        const WriteOptions& options, MakeTableWriter make) {
    return std::make_unique<Converter>(std::move(sink), reader, options, make);
}

void write_table(ByteSink& sink, std::span<const NumberColumn> columns, MakeTableWriter make) {
    constexpr std::size_t rows_at_once = 16384;
    std::vector<std::string> names;
    for (const NumberColumn& column : columns) {
        names.push_back(column.name);
        if (column.values.size() != columns[0].values.size()) {
            throw std::invalid_argument("columns of a log differ in length: " + column.name);
        }
    }
    const auto table = make(sink, {});
    table->begin(names);
    const std::size_t rows = columns.empty() ? 0 : columns[0].values.size();
    Progress::current().begin("writing", "rows", rows);
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        std::vector<std::span<const double>> parts;
        for (const NumberColumn& column : columns) {
            parts.push_back(std::span(column.values).subspan(first, std::min(rows_at_once, rows - first)));
        }
        table->rows(parts);
        Progress::current().add(parts.front().size());
    }
    table->end();
}

}  // namespace ripplenotch
