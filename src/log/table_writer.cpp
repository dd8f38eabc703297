// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "log/columns/units.hpp"
#include "log/formats.hpp"
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

namespace {

class Converter : public LogWriter {
  public:
    Converter(std::unique_ptr<ByteSink> sink, const LogReader& reader, const WriteOptions& options,
              const LogFormat& format)
        : sink_(std::move(sink)), table_(format.table(*sink_, options)), append_(options.append) {
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

// "torque_filtered [Nm]" next to "tau [Nm]", "torque_filtered_Nm" next to "torque_Nm": a new column's name in
// the style of the torque column's.
std::string appended_name(const std::string& wanted, const std::string& torque_name) {
    const NameAndUnit parts = split_unit(torque_name, Role::torque);
    if (parts.unit.empty()) return wanted;
    // Whatever stands between the name and the unit stays: "_Nm", " [Nm]", "(Nm)".
    const std::size_t at = torque_name.rfind(parts.unit);
    const std::size_t from = torque_name.find(parts.name) + parts.name.size();
    return wanted + torque_name.substr(from, at - from) + torque_name.substr(at);
}

}  // namespace

std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                        const WriteOptions& options, const LogFormat& format) {
    return std::make_unique<Converter>(std::move(sink), reader, options, format);
}

void LogFormat::write_columns(ByteSink& sink, std::span<const NumberColumn> numbers) const {
    constexpr std::size_t rows_at_once = 16384;
    std::vector<std::string> names;
    for (const NumberColumn& column : numbers) {
        names.push_back(column.name);
        if (column.values.size() != numbers[0].values.size()) {
            throw std::invalid_argument("columns of a log differ in length: " + column.name);
        }
    }
    const auto writer = table(sink, {});
    writer->begin(names);
    const std::size_t rows = numbers.empty() ? 0 : numbers[0].values.size();
    Progress::current().begin("writing", "rows", rows);
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        std::vector<std::span<const double>> parts;
        for (const NumberColumn& column : numbers) {
            parts.push_back(std::span(column.values).subspan(first, std::min(rows_at_once, rows - first)));
        }
        writer->rows(parts);
        Progress::current().add(parts.front().size());
    }
    writer->end();
}

std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options) {
    std::vector<std::string> names;
    const auto taken = [&](const std::string& name) {
        return std::ranges::any_of(layout.columns, [&](const Column& column) { return column.name == name; });
    };
    for (const JointColumns& joint : layout.all_chosen()) {
        const std::string wanted =
            (layout.joints.size() < 2 ? "" : joint.joint + "_") + std::string(options.append_name);
        const std::string& torque = layout.columns[*joint.torque].name;
        names.push_back(appended_name(wanted, torque));
        for (int count = 2; taken(names.back()); ++count)
            names.back() = appended_name(fmt::format("{}_{}", wanted, count), torque);
    }
    return names;
}

}  // namespace ripplenotch
