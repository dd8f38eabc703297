// SPDX-License-Identifier: MIT
#include "log/containers/stored_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "log/columns/column_name.hpp"
#include "log/records/strided_copy.hpp"

namespace ripplenotch {
namespace {

constexpr std::uint64_t most_columns = 64;
constexpr std::size_t gathered_at_once = std::size_t{1} << 18;

class StridedCursor final : public ColumnCursor {
  public:
    StridedCursor(std::shared_ptr<StoredBytes> bytes, std::uint64_t start, std::uint64_t stride,
                  std::size_t size)
        : bytes_(std::move(bytes)), at_(start), stride_(stride), size_(size) {}
    void read(std::size_t rows, char* into) override {
        if (stride_ == size_) {
            bytes_->read_at(at_, into, rows * size_);
            at_ += rows * size_;
            return;
        }
        const std::size_t at_once = std::max<std::size_t>(1, gathered_at_once / stride_);
        for (std::size_t done = 0; done < rows;) {
            const std::size_t count = std::min(at_once, rows - done);
            span_.resize((count - 1) * stride_ + size_);
            bytes_->read_at(at_, span_.data(), span_.size());
            copy_numbers({span_.data(), stride_}, {into, size_}, size_, count);
            into += count * size_;
            at_ += count * stride_;
            done += count;
        }
    }

  private:
    std::shared_ptr<StoredBytes> bytes_;
    std::uint64_t at_;
    std::size_t stride_, size_;
    std::string span_;
};

}  // namespace

std::unique_ptr<ColumnCursor> strided_cursor(std::shared_ptr<StoredBytes> bytes, std::uint64_t start,
                                             std::uint64_t stride, std::size_t size) {
    return std::make_unique<StridedCursor>(std::move(bytes), start, stride, size);
}

std::optional<ArrayShape> shape_over_time(const std::vector<std::uint64_t>& dimensions) {
    std::vector<std::uint64_t> sides;
    for (const std::uint64_t side : dimensions) {
        if (side == 0) return std::nullopt;
        if (side > 1) sides.push_back(side);
    }
    if (sides.empty() || sides.size() > 2) return std::nullopt;
    if (sides.size() == 1) return ArrayShape{sides[0], 1, true, dimensions.front() == sides[0]};
    const bool first = sides[0] >= sides[1];
    const std::uint64_t rows = first ? sides[0] : sides[1], columns = first ? sides[1] : sides[0];
    if (columns > most_columns || dimensions.size() > 2) return std::nullopt;
    return ArrayShape{rows, columns, false, first};
}

int names_tell(const std::vector<std::string>& names) {
    std::set<Role> roles;
    for (const std::string& name : names) {
        const ColumnName column = read_column_name(name);
        if (!column.reference) roles.insert(column.role);
    }
    roles.erase(Role::other);
    return static_cast<int>(roles.size()) + (roles.count(Role::torque) > 0 ? 2 : 0);
}

std::string type_name(const NpyField& type) {
    const std::string_view kind = type.kind == 'f' ? "float" : type.kind == 'i' ? "int" : "uint";
    return fmt::format("{}{}{}", kind, 8 * type.size, type.big_endian ? ", big-endian" : "");
}

}  // namespace ripplenotch
