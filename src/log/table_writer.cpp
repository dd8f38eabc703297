// SPDX-License-Identifier: MIT
#include "log/table_writer.hpp"

#include <stdexcept>
#include <utility>

#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

namespace {

class Converter : public LogWriter {
  public:
    Converter(std::unique_ptr<ByteSink> sink, const LogReader& reader, const WriteOptions& options,
              MakeTableWriter make)
        : sink_(std::move(sink)), table_(make(*sink_, options)), append_(options.append) {
        const std::vector<JointColumns> joints = reader.layout().all_chosen();
        std::vector<std::string> names = {"time_s"};
        for (const JointColumns& joint : joints) {
            // One joint needs no name.
            const std::string prefix = joints.size() == 1 ? "" : joint.joint + "_";
            names.push_back(prefix + "velocity_deg_s");
            names.push_back(prefix + "torque_nm");
            has_position_.push_back(joint.position.has_value());
            if (joint.position) names.push_back(prefix + "position_deg");
            if (append_) names.push_back(prefix + options.append_name + "_nm");
        }
        table_->begin(names);
    }

    void put(const RowBlock& block, Torques torque_nm, std::string_view /*bytes*/) override {
        std::vector<std::span<const double>> columns = {block.time_s};
        for (std::size_t j = 0; j < block.joints.size(); ++j) {
            const JointRows& joint = block.joints[j];
            columns.emplace_back(joint.velocity_deg_s);
            columns.emplace_back(append_ ? joint.torque_nm : torque_nm[j]);
            if (has_position_[j]) columns.emplace_back(joint.position_deg);
            if (append_) columns.emplace_back(torque_nm[j]);
        }
        table_->rows(columns);
    }

    void finish() override {
        table_->end();
        sink_->finish();
    }

  private:
    std::unique_ptr<ByteSink> sink_;
    std::unique_ptr<TableWriter> table_;
    bool append_;
    std::vector<bool> has_position_;
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
