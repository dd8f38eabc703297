// SPDX-License-Identifier: MIT
#pragma once
// Arrays that have clocks of their own, joined by time.

#include <functional>

#include "log/containers/array_columns.hpp"

namespace ripplenotch {

/// The rows of `base` with its clock in nanoseconds, and behind them what `asked` takes of the columns of
/// `others`, by `how` ("linear"). All groups have a clock. Fills the fields of the table.
[[nodiscard]] std::unique_ptr<RecordSource> joined_arrays(
    const std::shared_ptr<StoredBytes>& file, const ArrayGroup& base,
    const std::vector<const ArrayGroup*>& others, PathStyle style,
    const std::function<bool(const std::string& path)>& asked, const std::string& how, RecordTable& table);

}  // namespace ripplenotch
