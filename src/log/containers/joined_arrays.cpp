// SPDX-License-Identifier: MIT
#include "log/containers/joined_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <deque>

#include "log/columns/unit_text.hpp"
#include "log/records/joined_records.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr double ns_per_s = 1e9, largest_ns = 9.2e18;
constexpr std::size_t rows_looked_at = 4096;  // rows, of which the usual step is told

// A clock's numbers as whole nanoseconds.
class NanosecondCursor final : public ColumnCursor {
  public:
    NanosecondCursor(std::string label, std::unique_ptr<ColumnCursor> own, NpyField type, double ns_per_unit)
        : label_(std::move(label)), own_(std::move(own)), type_(std::move(type)), ns_per_unit_(ns_per_unit) {}
    void read(std::size_t rows, char* into) override {
        raw_.resize(rows * type_.size);
        own_->read(rows, raw_.data());
        for (std::size_t row = 0; row < rows; ++row) {
            const char* const number = raw_.data() + row * type_.size;
            const double ns = load_field(number, type_) * ns_per_unit_;
            if (!(std::abs(ns) < largest_ns))  // nan, too
                raise<DataError>("{}: read a time of {} that is no number of seconds; save it again", label_,
                                 load_field(number, type_));
            const bool whole = type_.kind != 'f' && ns_per_unit_ == 1.0;
            const std::int64_t clock = whole ? load_count(number, type_) : std::llround(ns);
            std::memcpy(into + row * sizeof(clock), &clock, sizeof(clock));
        }
    }

  private:
    std::string label_;
    std::unique_ptr<ColumnCursor> own_;
    NpyField type_;
    double ns_per_unit_;
    std::string raw_;
};

double ns_per_unit(const std::string& source, const StoredArray& clock) {
    const std::string written = clock.unit.empty() ? split_unit(last_word(clock.path)).unit : clock.unit;
    const auto unit = written.empty() ? std::nullopt : usual_unit(written, Role::time);
    if (unit) return ns_per_s * role_factor(Role::time, *unit, 1.0).value_or(1.0);
    if (clock.type.kind != 'f')
        raise<DataError>(
            "{}: read whole numbers without a unit in {}, expected seconds, or a name or attribute with the "
            "unit; read arrays of one clock, or save them with it",
            source, clock.path);
    return ns_per_s;
}

StoredArray in_nanoseconds(const std::string& source, const StoredArray& clock) {
    StoredArray ns = clock;
    ns.type = {};
    ns.type.kind = 'i';
    ns.type.big_endian = std::endian::native == std::endian::big;
    ns.unit = "ns";
    ns.open = [label = fmt::format("{}: {}", source, clock.path), own = clock.open, type = clock.type,
               unit = ns_per_unit(source, clock)](std::size_t) {
        return std::make_unique<NanosecondCursor>(label, own(0), type, unit);
    };
    return ns;
}

double period_ns(const StoredArray& clock_ns) {
    const std::size_t rows = std::min(rows_looked_at, clock_ns.shape.rows);
    std::vector<std::int64_t> times(rows);
    clock_ns.open(0)->read(rows, reinterpret_cast<char*>(times.data()));
    return (static_cast<double>(times.back()) - static_cast<double>(times.front())) /
           static_cast<double>(rows - 1);
}

}  // namespace

std::unique_ptr<RecordSource> joined_arrays(const std::shared_ptr<StoredBytes>& file, const ArrayGroup& base,
                                            const std::vector<const ArrayGroup*>& others, PathStyle style,
                                            const std::function<bool(const std::string& path)>& asked,
                                            const std::string& how, RecordTable& table) {
    std::deque<StoredArray> clocks;  // columns point into it
    const auto add_clock = [&](const ArrayGroup& group) {
        return &clocks.emplace_back(in_nanoseconds(file->name(), *group.clock));
    };
    std::vector<ArrayColumn> columns = columns_of(base, style);
    const auto clock_column = std::find_if(columns.begin(), columns.end(), [&](const ArrayColumn& column) {
        return column.array == base.clock;
    });
    clock_column->array = add_clock(base);
    std::rotate(columns.begin(), clock_column, clock_column + 1);
    add_fields(columns, table);
    table.units.resize(table.fields.size());
    std::vector<SideSignal> sides;
    for (const ArrayGroup* other : others) {
        const StoredArray* const clock = add_clock(*other);
        for (const ArrayColumn& column : columns_of(*other, style)) {
            if (!asked(column.path)) continue;
            if (column.array == other->clock)
                raise<UsageError>(
                    "--columns: {} is not the clock of the torque, whose rows are taken; leave it out: each "
                    "array is joined by its own",
                    column.path);
            const std::vector<ArrayColumn> pair = {{clock->path, "", clock, 0}, column};
            sides.push_back({column.path, column.read_as, array_records(file, pair), column.array->type,
                             join_limit_ns(period_ns(*clock)), column.array->unit, "value"});
        }
    }
    std::vector<std::size_t> sizes;
    for (const NpyField& field : table.fields) sizes.push_back(field.size);
    add_sides(sides, how, table);
    return join_records(array_records(file, columns), std::move(sizes), std::move(sides), join_named(how));
}

}  // namespace ripplenotch
