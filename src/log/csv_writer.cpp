// SPDX-License-Identifier: MIT
#include "log/csv_writer.hpp"

#include <algorithm>

#include "log/unit_text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

int decimals_of(std::string_view number, char decimal_mark) {
    const std::size_t mark = number.find(decimal_mark);
    if (mark == std::string_view::npos) return 0;
    std::size_t at = mark + 1;
    while (at < number.size() && number[at] >= '0' && number[at] <= '9') ++at;
    return static_cast<int>(std::min<std::size_t>(at - mark - 1, 17));
}

}  // namespace

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
    for (const JointColumns& joint : layout.all_chosen()) {
        const std::string prefix = layout.others.empty() ? "" : joint.joint + "_";
        names.push_back(appended_name(prefix + options.append_name, layout.columns[*joint.torque].name));
    }
    return names;
}

CsvWriter::CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options)
    : sink_(std::move(sink)), options_(options), rules_(reader.dialect().rules) {
    std::vector<std::size_t> columns;
    for (const JointColumns& joint : reader.layout().all_chosen()) {
        if (!joint.torque)
            raise<UsageError>("{}: there is no torque column to write", reader.layout().source);
        joints_.push_back(columns.size());
        columns.push_back(*joint.torque);
        factors_.push_back(reader.layout().columns[*joint.torque].factor);
    }
    std::sort(joints_.begin(), joints_.end(),
              [&](std::size_t a, std::size_t b) { return columns[a] < columns[b]; });
    write_head(reader);
}

std::string CsvWriter::names_appended(const CsvReader& reader) const {
    std::string text;
    for (std::string& name : appended_names(reader.layout(), options_)) {
        if (reader.dialect().quoted_names || name.find(rules_.delimiter) != std::string::npos)
            name = '"' + name + '"';
        text += rules_.delimiter + name;
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
        text += rules_.delimiter + unit;
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

// `write` takes where to write to, the number and the cell that it replaces; it is known when this is
// compiled, for there is one call a row.
std::string_view CsvWriter::prepare(RowBlock& block, Torques torque_nm, std::string& room) const {
    TextRoom text(room, block.bytes.size() + 16 * block.size() * joints_.size());
    switch (options_.decimals) {
        case WriteOptions::Decimals::shortest:
            write_rows(block, torque_nm, text,
                       [](char* into, double value, std::string_view) { return put_shortest(into, value); });
            break;
        case WriteOptions::Decimals::input:
            write_rows(block, torque_nm, text, [this](char* into, double value, std::string_view cell) {
                return put_fixed(into, value, decimals_of(cell, rules_.decimal_mark));
            });
            break;
        case WriteOptions::Decimals::fixed:
            write_rows(block, torque_nm, text,
                       [decimals = options_.fixed_decimals](char* into, double value, std::string_view) {
                           return put_fixed(into, value, decimals);
                       });
            break;
    }
    return text.text();
}

template <typename Write>
void CsvWriter::write_rows(const RowBlock& block, Torques torque_nm, TextRoom& text,
                           const Write& write) const {
    if (options_.append) {
        append(block, torque_nm, text, write);
    } else if (rules_.decimal_mark == '.') {
        replace(block, torque_nm, text, write);
    } else {
        replace(block, torque_nm, text, [&](char* into, double value, std::string_view cell) {
            char* const end = write(into, value, cell);
            std::replace(into, end, '.', rules_.decimal_mark);
            return end;
        });
    }
}

template <typename Write>
void CsvWriter::replace(const RowBlock& block, Torques torque_nm, TextRoom& text, const Write& write) const {
    const std::string_view bytes = block.bytes;
    // Cells whose bad values were replaced do not hold what the block's torque says.
    const bool as_written = options_.decimals != WriteOptions::Decimals::fixed && block.held_bad_values == 0;
    std::size_t done = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
        for (const std::size_t j : joints_) {
            const JointRows& joint = block.joints[j];
            const double torque = torque_nm[j][i];
            if (as_written && torque == joint.torque_nm[i]) continue;  // unchanged, it keeps its text
            const std::size_t begin = joint.torque_begin[i], end = joint.torque_end[i];
            text.copy(bytes, done, begin);
            text.number([&](char* into) {
                return write(into, torque / factors_[j], bytes.substr(begin, end - begin));
            });
            done = end;
        }
    }
    text.copy(bytes, done, bytes.size());
}

template <typename Write>
void CsvWriter::append(const RowBlock& block, Torques torque_nm, TextRoom& text, const Write& write) const {
    const std::string_view bytes = block.bytes;
    const bool quoted = rules_.delimiter == ',' && rules_.decimal_mark == ',';
    std::size_t done = 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
        text.copy(bytes, done, block.row_end[i]);
        done = block.row_end[i];
        for (std::size_t j = 0; j < block.joints.size(); ++j) {
            const JointRows& joint = block.joints[j];
            const std::string_view cell =
                bytes.substr(joint.torque_begin[i], joint.torque_end[i] - joint.torque_begin[i]);
            text.put(rules_.delimiter);
            if (quoted) text.put('"');
            text.number([&](char* into) {
                char* const end = write(into, torque_nm[j][i] / factors_[j], cell);
                if (rules_.decimal_mark != '.') std::replace(into, end, '.', rules_.decimal_mark);
                return end;
            });
            if (quoted) text.put('"');
        }
    }
    text.copy(bytes, done, bytes.size());
}

void CsvWriter::put(const RowBlock& /*block*/, Torques /*torque_nm*/, std::string_view bytes) {
    sink_->write(bytes);
}

void CsvWriter::finish() { sink_->finish(); }

}  // namespace ripplenotch
