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

CsvWriter::CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options)
    : sink_(std::move(sink)), options_(options), rules_(reader.dialect().rules) {
    const auto torque = reader.layout().chosen.torque;
    if (!torque) raise<UsageError>("{}: there is no torque column to write", reader.layout().source);
    factor_ = reader.layout().columns[*torque].factor;
    write_head(reader);
}

void CsvWriter::write_head(const CsvReader& reader) {
    const std::string_view head = reader.head();
    const TextDialect& dialect = reader.dialect();
    if (!options_.append || !dialect.has_header) {
        sink_->write(head);
        return;
    }
    const Column& torque = reader.layout().columns[*reader.layout().chosen.torque];
    std::string name = appended_name(options_.append_name, torque.name);
    if (dialect.quoted_names || name.find(rules_.delimiter) != std::string::npos) name = '"' + name + '"';
    std::string unit;
    if (dialect.unit_row_end > 0) {
        unit = dialect.units[*reader.layout().chosen.torque];
        // The unit row's own brackets are copied from the torque's cell.
        const std::size_t at = head.find(unit, dialect.header_end);
        if (at != std::string::npos && at > 0 && (head[at - 1] == '[' || head[at - 1] == '(')) {
            unit = head[at - 1] + unit + (head[at - 1] == '[' ? ']' : ')');
        }
    }
    std::string changed(head.substr(0, dialect.header_end));
    changed += rules_.delimiter + name;
    if (dialect.unit_row_end > 0) {
        changed.append(head, dialect.header_end, dialect.unit_row_end - dialect.header_end);
        changed += rules_.delimiter + unit;
        changed.append(head, dialect.unit_row_end);
    } else {
        changed.append(head, dialect.header_end);
    }
    sink_->write(changed);
}

void CsvWriter::append_number(std::string& text, double value, std::string_view as_in) const {
    const std::size_t from = text.size();
    switch (options_.decimals) {
        case WriteOptions::Decimals::shortest:
            append_shortest(text, value);
            break;
        case WriteOptions::Decimals::input:
            append_fixed(text, value, decimals_of(as_in, rules_.decimal_mark));
            break;
        case WriteOptions::Decimals::fixed:
            append_fixed(text, value, options_.fixed_decimals);
            break;
    }
    if (rules_.decimal_mark == '.') return;
    const std::size_t mark = text.find('.', from);
    if (mark != std::string::npos) text[mark] = rules_.decimal_mark;
}

void CsvWriter::write(const RowBlock& block, std::span<const double> torque_nm) {
    std::string bytes;
    prepare(block, torque_nm, bytes);
    put(block, torque_nm, bytes);
}

void CsvWriter::prepare(const RowBlock& block, std::span<const double> torque_nm, std::string& text) const {
    text.clear();
    text.reserve(block.bytes.size() + 16 * block.size());
    const std::string_view bytes = block.bytes;
    std::size_t done = 0;
    // Cells whose bad values were replaced do not hold what block.torque_nm says.
    const bool as_written = options_.decimals != WriteOptions::Decimals::fixed && block.held_bad_values == 0;
    for (std::size_t i = 0; i < block.size(); ++i) {
        const std::string_view cell =
            bytes.substr(block.torque_begin[i], block.torque_end[i] - block.torque_begin[i]);
        const double value = torque_nm[i] / factor_;
        if (options_.append) {
            text.append(bytes, done, block.row_end[i] - done);
            text += rules_.delimiter;
            const bool quoted = rules_.delimiter == ',' && rules_.decimal_mark == ',';
            if (quoted) text += '"';
            append_number(text, value, cell);
            if (quoted) text += '"';
            done = block.row_end[i];
        } else if (as_written && torque_nm[i] == block.torque_nm[i]) {
            continue;  // a value that nobody changed keeps its text
        } else {
            text.append(bytes, done, block.torque_begin[i] - done);
            append_number(text, value, cell);
            done = block.torque_end[i];
        }
    }
    text.append(bytes, done);
}

void CsvWriter::put(const RowBlock& /*block*/, std::span<const double> /*torque_nm*/,
                    std::string_view bytes) {
    sink_->write(bytes);
}

void CsvWriter::finish() { sink_->finish(); }

}  // namespace ripplenotch
