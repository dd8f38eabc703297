// SPDX-License-Identifier: MIT
#include "log/text/quick_rows.hpp"

#include <cstring>
#include <utility>

#include "core/vectors/dispatch.hpp"
#include "log/row_sink.hpp"
#include "log/text/vector_rows.hpp"

namespace ripplenotch {

namespace {
bool all_careful = false;
}  // namespace

CarefulRows::CarefulRows() noexcept : before_(all_careful) { all_careful = true; }
CarefulRows::~CarefulRows() { all_careful = before_; }

QuickRows::QuickRows(RowPlan plan)
    : plan_(std::move(plan)),
      parser_(plan_.rules, plan_.columns, plan_.wanted, plan_.stamp),
      careful_(all_careful),
      vectorised_(wide_vectors() && !plan_.stamp.careful && plan_.rules.delimiter != ' ' &&
                  plan_.columns > 0) {}

std::size_t QuickRows::read(RowBlock& block, std::size_t begin, double time_before) const {
    if (careful_) return begin;
    return vectorised_ ? read_rows_by_vectors(block, begin, time_before, plan_, parser_)
                       : read_by_parser(block, begin, time_before);
}

std::size_t QuickRows::read_by_parser(RowBlock& block, std::size_t begin, double time_before) const {
    const char* const text = block.bytes.data();
    const std::size_t size = block.bytes.size();
    constexpr std::size_t rows_at_once = 128;
    std::size_t rows = 0;
    RowSink sink(block, begin, plan_);
    sink.make_room(rows_at_once);
    ParsedRow row(plan_.joints());
    const bool timed = plan_.column_of(time_slot).has_value();
    while (begin < size) {
        const auto* const found =
            static_cast<const char*>(std::memchr(text + begin, plan_.line_end, size - begin));
        if (found == nullptr) break;
        const char* end = found;
        if (end > text + begin && end[-1] == '\r') --end;
        if (!parser_.parse(text + begin, end, row)) break;
        if (timed && row.values[time_slot] < time_before) break;
        time_before = row.values[time_slot];
        sink.set(rows++, row, begin, text);
        if (rows == rows_at_once) {
            sink.commit(rows);
            rows = 0;
        }
        begin = static_cast<std::size_t>(found - text) + 1;
    }
    sink.commit(rows);
    return begin;
}

}  // namespace ripplenotch
