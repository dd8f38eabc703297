// SPDX-License-Identifier: MIT
#include "log/quick_rows.hpp"

#include <cstring>
#include <utility>

#include "log/row_sink.hpp"
#include "log/vector_rows.hpp"

namespace ripplenotch {

namespace {

const VectorKernels* kernels_of(RowWay way) {
    switch (way) {
        case RowWay::parser:
            return nullptr;
        case RowWay::avx2:
            return avx2_kernels();
        case RowWay::avx512:
            return avx512_kernels();
    }
    return nullptr;
}

}  // namespace

bool QuickRows::has(RowWay way) { return way == RowWay::parser || kernels_of(way) != nullptr; }

QuickRows::QuickRows(RowPlan plan)
    : plan_(std::move(plan)), parser_(plan_.rules, plan_.columns, plan_.wanted) {
    const bool by_one_character = plan_.rules.delimiter != ' ' && plan_.columns > 0;
    if (by_one_character) use(has(RowWay::avx512) ? RowWay::avx512 : RowWay::avx2);
}

void QuickRows::use(RowWay way) { kernels_ = kernels_of(way); }

std::size_t QuickRows::take(RowBlock& block, std::size_t begin, double time_before) const {
    return kernels_ != nullptr ? take_rows_by_vectors(block, begin, time_before, plan_, parser_, *kernels_)
                               : take_by_parser(block, begin, time_before);
}

std::size_t QuickRows::take_by_parser(RowBlock& block, std::size_t begin, double time_before) const {
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
