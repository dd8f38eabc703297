// SPDX-License-Identifier: MIT
#pragma once
// A filter method as the user wrote it, checked, with its table loaded.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// What the command line says about the gear outside --method; fills keys of the method that it leaves out.
struct GearOptions {
    std::optional<double> gear_ratio;
    std::vector<double> orders;
    std::optional<std::string> joint_file;
};

struct ChosenMethod {
    const Method* method = nullptr;
    std::string text;  ///< as it would be typed again; what joint=... stood for is spelled out
    std::optional<Settings> settings;  ///< always there after choose_method
    std::string table_path;            ///< empty when the method needs no table
    std::shared_ptr<const CandidateTable> table;
    std::string joint_path;  ///< of joint=...; empty when not given

    [[nodiscard]] std::unique_ptr<CausalFilter> start(Hertz sample_rate) const {
        return method->start(*settings, sample_rate, table.get());
    }
    /// Null for methods that need no first pass.
    [[nodiscard]] std::unique_ptr<Learner> learner(Hertz sample_rate) const {
        return method->learner == nullptr ? nullptr : method->learner(*settings, sample_rate);
    }
    [[nodiscard]] FrozenFilter frozen(Hertz sample_rate, DegPerSec speed) const {
        return method->frozen(*settings, sample_rate, table.get(), speed);
    }
    /// The same for the measurements of the evaluate room.
    [[nodiscard]] Contender contender() const { return {text, method, *settings, table}; }
};

/// `spec_text` as --method takes it; `table` is a table.json for methods that need one and name none. Throws
/// UsageError on a bad specification, and what load_table and load_identification throw.
[[nodiscard]] ChosenMethod choose_method(const std::string& spec_text,
                                         const std::optional<std::string>& table,
                                         const GearOptions& gear = {});

}  // namespace ripplenotch
