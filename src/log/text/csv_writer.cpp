// SPDX-License-Identifier: MIT
#include "log/text/csv_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "log/columns/unit_text.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
std::string appended_name(const std::string& wanted, const std::string& torque_name) {
    const NameAndUnit parts = split_unit(torque_name);
    if (parts.unit.empty()) return wanted;
    // Whatever stands between the name and the unit stays: "_Nm", " [Nm]", "(Nm)".
    const std::size_t at = torque_name.rfind(parts.unit);
    const std::size_t from = torque_name.find(parts.name) + parts.name.size();
    return wanted + torque_name.substr(from, at - from) + torque_name.substr(at);
}

std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options) {
    std::vector<std::string> names;
    const auto taken = [&](const std::string& name) {
        return std::any_of(layout.columns.begin(), layout.columns.end(),
                           [&](const Column& column) { return column.name == name; });
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

CsvWriter::CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options)
    : sink_(std::move(sink)), options_(options) {
    plan_.rules = reader.dialect().rules;
    plan_.decimals = options.fixed_decimals;
    std::vector<std::size_t> columns;
    for (const JointColumns& joint : reader.layout().all_chosen()) {
        if (!joint.torque)
            raise<UsageError>("{}: there is no torque column to write", reader.layout().source);
        plan_.joints.push_back(columns.size());
        columns.push_back(*joint.torque);
        plan_.factors.push_back(reader.layout().columns[*joint.torque].factor);
    }
    // Appended columns stand in the order of the joints.
    if (!options.append)
        std::sort(plan_.joints.begin(), plan_.joints.end(),
                  [&](std::size_t a, std::size_t b) { return columns[a] < columns[b]; });
    sink_->expect(reader.source_bytes());
    write_head(reader);
}

std::string CsvWriter::names_appended(const CsvReader& reader) const {
    std::string text;
    for (std::string& name : appended_names(reader.layout(), options_)) {
        if (reader.dialect().quoted_names || name.find(plan_.rules.delimiter) != std::string::npos)
            name = '"' + name + '"';
        text += plan_.rules.delimiter + name;
    }
    return text;
}

std::string CsvWriter::units_appended(const CsvReader& reader) const {
    const TextDialect& dialect = reader.dialect();
    const std::string_view head = reader.head();
    std::string text;
    for (const JointColumns& joint : reader.layout().all_chosen()) {
        std::string unit = dialect.units[*joint.torque];
        // The unit row's own brackets are copied from the torque's cell.
        const std::size_t at = head.find(unit, dialect.header_end);
        if (at != std::string::npos && at > 0 && (head[at - 1] == '[' || head[at - 1] == '('))
            unit = head[at - 1] + unit + (head[at - 1] == '[' ? ']' : ')');
        text += plan_.rules.delimiter + unit;
    }
    return text;
}

void CsvWriter::write_head(const CsvReader& reader) {
    const std::string_view head = reader.head();
    const TextDialect& dialect = reader.dialect();
    if (!options_.append || !dialect.has_header) {
        sink_->write(head);
        return;
    }
    std::string changed(head.substr(0, dialect.header_end));
    changed += names_appended(reader);
    std::size_t done = dialect.header_end;
    if (dialect.unit_row_end > 0) {
        changed.append(head, done, dialect.unit_row_end - done);
        changed += units_appended(reader);
        done = dialect.unit_row_end;
    }
    changed.append(head, done);
    sink_->write(changed);
}

std::string_view CsvWriter::prepare(RowBlock& block, Torques torque_nm, std::string& room) const {
    TextRoom text(room, block.bytes.size() + 16 * block.size() * plan_.joints.size());
    const auto rewrite = [&](auto&& rows) {
        if (options_.append)
            rows.append();
        else
            rows.replace();
    };
    switch (options_.decimals) {
        case WriteOptions::Decimals::shortest:
            rewrite(RowRewriter<ShortestCells>(plan_, block, torque_nm, text));
            break;
        case WriteOptions::Decimals::fixed:
            rewrite(RowRewriter<FixedCells>(plan_, block, torque_nm, text));
            break;
    }
    return text.text();
}

void CsvWriter::put(const RowBlock& /*block*/, Torques /*torque_nm*/, std::string_view bytes) {
    sink_->write(bytes);
}

void CsvWriter::finish() { sink_->finish(); }

}  // namespace ripplenotch
