// SPDX-License-Identifier: MIT
#pragma once
// A filter method as the user wrote it, checked, with its table loaded.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/artifact/metrics.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

struct ChosenMethod {
    const Method* method = nullptr;
    std::string text;                  ///< as it would be typed again
    std::optional<Settings> settings;  ///< always there after choose_method
    std::string table_path;            ///< empty when the method needs no table
    std::shared_ptr<const CandidateTable> table;

    [[nodiscard]] std::unique_ptr<CausalFilter> start(Hertz sample_rate) const {
        return method->start(*settings, sample_rate, table.get());
    }
    [[nodiscard]] FrozenFilter frozen(Hertz sample_rate, DegPerSec speed) const {
        return method->frozen(*settings, sample_rate, table.get(), speed);
    }
    /// Of every band when the method has a table, else of its filter.
    [[nodiscard]] std::vector<FilterDelay> delays(Hertz sample_rate) const;
};

/// `spec_text` as --method takes it; `table` is a table.json for methods that need one and name none. Throws
/// UsageError on a bad specification, and what load_table throws.
[[nodiscard]] ChosenMethod choose_method(const std::string& spec_text,
                                         const std::optional<std::string>& table);

}  // namespace ripplenotch
